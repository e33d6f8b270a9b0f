"""Measure and write docs/use/how_much_tether.md and quality_of_advice.md, with tables and figures.

python docs/make/make_how_much_tether.py examples/scenes/*.toml
"""

import sys
from pathlib import Path

from advice.page import run
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, folder


def parse(arguments):
    """Command line options."""
    parser = Parser(
        prog="make_how_much_tether.py", description="measure and write the pages on how much tether a scene needs"
    )
    option = parser.add_argument
    option("scenes", metavar="SCENE", nargs="+", help="scene files (TOML)")
    about = "folder for use/, data/ and figures/ (default: docs)"
    option("--out", type=folder, metavar="DIR", default=Path("docs"), help=about)
    about = "folder of finished points (default: study)"
    option("--store", type=folder, metavar="DIR", default=Path("study"), help=about)
    return parser.parse_args(arguments)


@command
def main(arguments=None):
    """Measure all and write; returns the exit status."""
    run(parse(arguments))


if __name__ == "__main__":
    sys.exit(main())
