"""Fly the kite of `examples/circular_flight.py`, from a checkout or from the examples that a wheel carries."""

from .example_files import example


def main(arguments=None, prog="tetherfmu fly"):
    """Run the example with these options; returns its exit status."""
    return example("circular_flight").main(arguments, prog)
