"""Measure thresholds.csv, which the advisor reads, and advice/sweeps.csv; `python docs/make/make_thresholds.py`."""

import sys

from advice.thresholds import thresholds, write
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser
from tetherfmu.study.measuring.executors import executor_of


@command
def main(arguments=None):
    """Measure and store; returns the exit status."""
    Parser(prog="make_thresholds.py", description="measure the thresholds that the advisor reads").parse_args(arguments)
    with executor_of() as executor:
        write(*thresholds(executor))


if __name__ == "__main__":
    sys.exit(main())
