"""The tutorial: its command is implemented beside its lessons, in the examples of a checkout or a wheel."""

from tetherfmu.libraries.examples import example


def main(arguments=None, prog="tetherfmu tutorial"):
    """List, run or copy lessons, according to the command line; returns the exit status."""
    return example("tutorial.command").main(arguments, prog)
