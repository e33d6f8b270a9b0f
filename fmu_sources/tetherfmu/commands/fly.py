"""Fly the kite of `examples/first_flight/circular_flight.py`, from a checkout or from the examples that a wheel carries."""

from tetherfmu.libraries.examples import example


def main(arguments=None, prog="tetherfmu fly"):
    """Run the example with these options; returns its exit status."""
    return example("first_flight.circular_flight").main(arguments, prog)
