"""Measure what the tethers cost, and write docs/measurements/benchmarks.md, docs/data/benchmarks.csv and a diagram.

python docs/make/make_benchmarks.py --fmus dist --out docs --figure docs/figures/work_precision.svg
"""

import sys
from importlib import import_module
from pathlib import Path

from new_file import new_file
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, folder


def parse(arguments):
    """Command line options."""
    parser = Parser(prog="make_benchmarks.py", description="measure what the tethers cost, including comparisons")
    option = parser.add_argument
    option("--quick", action="store_true", help="smoke test of a few seconds, timings unreliable")
    option("--flights", action="store_true", help="compare the two flights only, without compiled C")
    option("--no-peers", action="store_true", help="leave out CasADi and MoorDyn")
    option("--fmus", type=folder, metavar="DIR", help="folder of the FMUs (default: build them)")
    about = "folder for measurements/ and data/ (default: benchmark)"
    option("--out", type=folder, metavar="DIR", default=Path("benchmark"), help=about)
    option("--figure", type=new_file(".svg"), metavar="FILE", help="draw the work-precision diagram to this SVG file")
    return parser.parse_args(arguments)


@command
def main(arguments=None):
    """Measure, print and store; returns the exit status."""
    options = parse(arguments)
    return import_module("benchmark.report").run(options)  # not above: each process that it starts imports this file


if __name__ == "__main__":
    sys.exit(main())
