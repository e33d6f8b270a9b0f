"""Fly a kite with tether FMUs: on the circle of `examples/first_flight/circular_flight.py`, or along a log.

The examples are those of a checkout, or those that a wheel carries.
"""

from tetherfmu.libraries.examples import example


def main(arguments=None, prog="tetherfmu fly"):
    """Fly the log that the command line names, or else the circle; returns the exit status of the example."""
    logged = example("first_flight.logged_flight")
    parser = logged.parser_of(prog, circle=True)
    given = parser.parse_args(arguments)
    if given.log is None:
        if given.settings:
            parser.error(f"--set goes with {logged.LOG}")
        return example("first_flight.circular_flight").main(arguments, prog)
    if given.rate is not None:
        parser.error(f"--rate is of the circle; it goes without {logged.LOG}")
    return logged.main(arguments, prog)
