"""The command `python -m tetherfmu.study stability`: it judges random points, and writes stability.md and its heat maps."""

import sys
from pathlib import Path

from tetherfmu.console.options import file, folder, new_file, number
from tetherfmu.study.scenes.standard import MODELS

from .points import point
from .pool import judge_all, read
from .report import write
from .verdict import judge

QUICK = 60
FORBIDDEN = ("wrong", "crashed", "hanging")


def add_arguments(parser):
    """Declare the options of the command."""
    parser.add_argument(
        "--points", type=number(1, whole=True), default=20_000, help="number of random points (default 20000)"
    )
    parser.add_argument("--seed", type=number(0, whole=True), default=1, help="of the points (default 1)")
    parser.add_argument(
        "--out", type=folder, default=Path("docs"), metavar="DIR", help="folder for stability.md and figures/ (default docs)"
    )
    parser.add_argument(
        "--results",
        type=new_file(".jsonl"),
        metavar="FILE",
        help="of finished points (default: stability_<seed>.jsonl in the folder of --out)",
    )
    parser.add_argument(
        "--before",
        type=file,
        metavar="FILE",
        help="file of results of another version, to compare with on the points of both",
    )
    parser.add_argument("--processes", type=number(1, whole=True), help="how many at a time (default: one per core)")
    parser.add_argument("--quick", action="store_true", help=f"{QUICK} points and no figures: shows that it runs")
    parser.add_argument("--point", type=number(0, whole=True), help="judge this point alone and print it")


def run(options):
    """Run the command; returns the exit status: 1 if a point is wrong, crashed or hanging."""
    if options.point is not None:
        chosen = point(options.seed, options.point)
        for name, value in (chosen._asdict() | judge(chosen)._asdict()).items():
            print(f"{name:20} {value}")
        return 0
    points = [point(options.seed, number) for number in range(QUICK if options.quick else options.points)]
    for model in MODELS.values():
        model()  # compiles, so that not each process has to
    results = judge_all(points, options.results or options.out / f"stability_{options.seed}.jsonl", options.processes)
    before = read(options.before) if options.before else results[:0]
    print(write(results, before, options.out, with_figures=not options.quick))
    bad = results[results.verdict.isin(FORBIDDEN)]
    for chosen, verdict in zip(bad.number[:20], bad.verdict, strict=False):
        print(f"point {chosen}: {verdict}", file=sys.stderr)
    return 1 if len(bad) else 0
