"""Find where the tethers converge and where they refuse, and write docs/measurements/stability.md, its tables and figure.

    python docs/make/make_stability.py --points 20000

docs/contributors/developing.md has the commands of the whole page, and of a Dask cluster.
"""

import sys
from importlib import import_module
from pathlib import Path

from new_file import new_file
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, file, folder, number
from tetherfmu.runtime.parameters import Tether


def parse(arguments):
    """Command line options."""
    parser = Parser(prog="make_stability.py", description="find where the tethers converge and where they refuse")
    option = parser.add_argument
    about = "number of random points (default: 20000)"
    option("--points", type=number(1, whole=True), default=20_000, metavar="N", help=about)
    option("--seed", type=number(0, whole=True), default=1, metavar="SEED", help="seed of the random points (default: 1)")
    about = "control of the winch: speed, force or length (default: speed)"
    parser.add_choice("--control", ("speed", "force", "length"), default="speed", metavar="CONTROL", help=about)
    about = "with a ground, and free kites instead of the straight tethers, which ignore it"
    option("--ground", action="store_true", help=about)
    about = "slack_stiffness_ratio of all tethers (default: that of a tether, 0.01)"
    option("--slack-ratio", type=number(0.0, 1.0), default=Tether().slack_stiffness_ratio, metavar="RATIO", help=about)
    about = "folder for measurements/, data/ and figures/ (default: docs)"
    option("--out", type=folder, default=Path("docs"), metavar="DIR", help=about)
    about = "file of finished points (default: stability_SEED.jsonl, with _CONTROL, _ground, _RATIO, in the folder of --out)"
    option("--results", type=new_file(".jsonl"), metavar="FILE", help=about)
    about = "file of finished points of another version, to print a comparison with"
    option("--before", type=file, metavar="FILE", help=about)
    about = "files of finished points with another --control, --ground or --slack-ratio, for tables of all of them"
    option("--others", type=file, nargs="+", default=(), metavar="FILE", help=about)
    parser.add_workers()
    option("--quick", action="store_true", help="smoke test: a few points and no figure")
    option("--redraw", action="store_true", help="only draw the figure, from stability_by_region.csv in the folder of --out")
    option("--point", type=number(0, whole=True), metavar="NUMBER", help="judge this point only and print it")
    return parser.parse_args(arguments)


@command
def main(arguments=None):
    """Judge all points and write their page, or one and print it; returns the exit status, 1 if one is what none may be."""
    options = parse(arguments)
    return import_module("stability.report").run(options)  # not above: each process that it starts imports this file


if __name__ == "__main__":
    sys.exit(main())
