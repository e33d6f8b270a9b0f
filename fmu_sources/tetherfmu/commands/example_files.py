"""The examples: those of a checkout, or those that a wheel carries."""

import sys
from importlib import import_module

from tetherfmu.libraries.sources import EXAMPLES


def example(name, room="."):
    """Module of an example; room : its folder in that of the examples."""
    sys.path.insert(0, str(EXAMPLES / room))
    return import_module(name)
