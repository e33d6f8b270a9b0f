"""Stability map: where the tethers hold at the extremes, and where they refuse.

    python -m tetherfmu.study.stability [--points 20000] [--seed 1] [--out docs] [--results FILE] [--before FILE]
                                        [--processes N] [--quick]
    python -m tetherfmu.study.stability --point NUMBER [--seed 1]

The first form judges random points (`stability_points`), writes the page stability.md with its heat maps, and exits with
1 if a point is wrong, crashed or hanging. It may be stopped at any time and goes on where it was: finished points are kept
in the file of results. `--before` compares with the file of results of another version, on the points that are in both. The
second form judges one point and prints all that is known about it.
"""

import argparse
import sys
from functools import partial
from pathlib import Path

from .flight import MODELS
from .points import point
from .pool import judge_all, read
from .verdict import judge

QUICK = 60
FORBIDDEN = ("wrong", "crashed", "hanging")


def _parse(arguments):
    parser = argparse.ArgumentParser(
        prog="python -m tetherfmu.study.stability", description="Stability map of all tethers at the extremes."
    )
    parser.add_argument("--points", type=int, default=20_000, help="number of random points (default 20000)")
    parser.add_argument("--seed", type=int, default=1, help="of the points (default 1)")
    parser.add_argument("--out", default="docs", help="folder for stability.md and figures/ (default docs)")
    parser.add_argument("--results", help="file of finished points (default: stability_<seed>.jsonl in the folder of --out)")
    parser.add_argument("--before", help="file of results of another version, to compare with")
    parser.add_argument("--processes", type=int, help="how many at a time (default: one per core)")
    parser.add_argument("--quick", action="store_true", help=f"{QUICK} points and no figures: shows that it runs")
    parser.add_argument("--point", type=int, help="judge this point alone and print it")
    return parser.parse_args(arguments)


def _progress(total):
    """Progress bar for so many points, or nothing where tqdm is not installed."""
    try:
        from tqdm import tqdm
    except ImportError:
        return iter
    return partial(tqdm, total=total, unit="point", smoothing=0.05)


def main(arguments=None):
    """Run the command; returns the exit status."""
    options = _parse(arguments)
    if options.point is not None:
        chosen = point(options.seed, options.point)
        for name, value in (*chosen._asdict().items(), *judge(chosen)._asdict().items()):
            print(f"{name:20} {value}")
        return 0
    count = QUICK if options.quick else options.points
    points = [point(options.seed, number) for number in range(count)]
    path = Path(options.results or Path(options.out) / f"stability_{options.seed}.jsonl")
    for name in MODELS:
        MODELS[name]()  # compiles, so that not each process has to
    results = judge_all(points, path, options.processes, progress=_progress(count))
    from .report import write

    before = list(read(options.before).values()) if options.before else []
    print(write(results, before, Path(options.out), figures=not options.quick))
    bad = [(p.number, v.verdict) for p, v in results if v.verdict in FORBIDDEN]
    for number, verdict in bad[:20]:
        print(f"point {number}: {verdict}", file=sys.stderr)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
