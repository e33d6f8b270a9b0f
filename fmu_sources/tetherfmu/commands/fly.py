"""Fly the kite of `examples/circular_flight.py`, from a checkout or from the examples that a wheel carries."""

import sys
from importlib import import_module

from tetherfmu.libraries.sources import EXAMPLES


def main(arguments=None, prog="tetherfmu fly"):
    """Run the example with these options; returns its exit status."""
    sys.path.insert(0, str(EXAMPLES))
    return import_module("circular_flight").main(arguments, prog)
