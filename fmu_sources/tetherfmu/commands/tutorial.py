"""The tutorial: what its command does is beside its lessons, in the examples of a checkout or those that a wheel carries."""

from tetherfmu.libraries.examples import example


def main(arguments=None, prog="tetherfmu tutorial"):
    """List, run or copy lessons, as the command line says; returns the exit status."""
    return example("tutorial.command").main(arguments, prog)
