"""How much tether does my scene need? `python -m tetherfmu.study tradeoff|advise SCENE`; see `--help`."""

import argparse
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path

from tetherfmu.models import StepRefused
from tetherfmu.study.advice.advise import advise
from tetherfmu.study.advice.advise_text import explain, explain_fast
from tetherfmu.study.advice.forecast import fast_advice
from tetherfmu.study.advice.numbers import numbers
from tetherfmu.study.advice.thresholds import thresholds, write
from tetherfmu.study.advice.tradeoff import LEVELS, cheapest, study
from tetherfmu.study.benchmark import command as benchmark
from tetherfmu.study.measuring.costs import TABLE, measure_costs
from tetherfmu.study.measuring.executors import executor_of, progress_bar
from tetherfmu.study.measuring.store import Store
from tetherfmu.study.scenes.files import SceneError, load
from tetherfmu.study.stability import command as stability


def parse(arguments):
    """Command line options."""
    parser = argparse.ArgumentParser(prog="python -m tetherfmu.study", description="How much tether does a scene need?")
    commands = parser.add_subparsers(dest="command", required=True)
    trade = commands.add_parser("tradeoff", help="measure error and cost of every configuration in a scene")
    trade.add_argument("scene", metavar="SCENE", help="scene file (TOML)")
    trade.add_argument(
        "--out", metavar="DIR", help="folder of the results (default: study/NAME); goes on where it was stopped"
    )
    trade.add_argument("--processes", type=int, metavar="N", help="default: one per core")
    trade.add_argument("--dask", metavar="ADDRESS", help="use the cluster of this Dask scheduler (extra: cluster)")
    trade.add_argument("--fmus", metavar="DIR", help="folder of the FMUs (default: build them)")
    trade.add_argument("--no-fmpy", action="store_true", help="leave out the cost through FMPy")
    advice = commands.add_parser("advise", help="say which FMU, segments, tolerance and communication step to use")
    advice.add_argument("scene", metavar="SCENE", help="scene file (TOML)")
    advice.add_argument("--fast", action="store_true", help="from the dimensionless numbers alone, not checked")
    doc = commands.add_parser("page", help="measure and write docs/how_much_tether.md and its figures")
    doc.add_argument("scenes", metavar="SCENE", nargs="+", help="scene files (TOML)")
    doc.add_argument("--out", metavar="DIR", default="docs", help="folder of the page (default: docs)")
    doc.add_argument("--store", metavar="DIR", default="study", help="folder of finished points (default: study)")
    benchmark.add_arguments(commands.add_parser("benchmark", help="what the tethers cost, in races with other solvers too"))
    commands.add_parser("costs", help="measure the unit costs anew (costs.csv of this package)")
    stability.add_arguments(commands.add_parser("stability", help="where the tethers hold and where they refuse"))
    commands.add_parser("thresholds", help="measure the thresholds anew (thresholds.csv of this package)")
    return parser.parse_args(arguments)


@contextmanager
def fmus(folder):
    """A folder with all FMUs; those that are missing are built, without a folder into one that is removed."""
    from tetherfmu.study.measuring.through_fmpy import fmus_in

    with tempfile.TemporaryDirectory() as temporary:
        fmus_in(folder or temporary)
        yield folder or temporary


def fmpy_times(scene, points, folder):
    """Measured time per simulated second through FMPy of the configurations that the report names."""
    from tetherfmu.study.measuring.flown_fmu import flown

    names = scene.wanted.outputs
    best = [cheapest(points, level, names) for level in {*LEVELS, scene.wanted.allowed_error}]
    with fmus(folder) as built:
        return {point.config: flown(built, scene, point.config)[0] for point in best if point}


def tradeoff_command(options):
    """Study a scene, write the report; returns 0."""
    from tetherfmu.study.advice.scene_report import write

    scene = load(options.scene)
    store = Store(options.out or Path("study") / scene.name)
    with executor_of(options.dask, options.processes) as executor:
        reference, points = study(scene, store, executor, progress_bar(scene.name))
    through_fmpy = {} if options.no_fmpy else fmpy_times(scene, points, options.fmus)
    print(write(scene, reference, points, through_fmpy, store.folder))
    return 0


def advise_command(options):
    """Print the advice for a scene; returns 0, or 1 if nothing meets what it asks for."""
    scene = load(options.scene)
    if options.fast:
        advice = fast_advice(scene)
        print(explain_fast(scene, advice))
        return 0 if advice.met else 1
    advice = advise(scene)
    print(explain(scene, advice, numbers(scene)))
    return 0 if advice.met else 1


def costs_command(options):
    """Measure the unit costs; returns 0."""
    measure_costs()
    print(TABLE.read_text(encoding="utf-8"), end="")
    return 0


def thresholds_command(options):
    """Measure the thresholds; returns 0."""
    with executor_of() as executor:
        rows, points = thresholds(executor, progress_bar("thresholds"))
    write(rows, points)
    return 0


def page_command(options):
    """Write the page of the manual; returns 0."""
    from tetherfmu.study.advice.page import make

    with executor_of() as executor:
        make(options.scenes, options.out, options.store, executor, progress_bar)
    return 0


COMMANDS = {
    "benchmark": benchmark.run,
    "stability": stability.run,
    "page": page_command,
    "tradeoff": tradeoff_command,
    "advise": advise_command,
    "costs": costs_command,
    "thresholds": thresholds_command,
}


def main(arguments=None):
    """Do what the command line says; returns the exit status, 2 for a wrong scene file."""
    options = parse(arguments)
    try:
        return COMMANDS[options.command](options)
    except SceneError as error:
        print(error, file=sys.stderr)
        return 2
    except StepRefused as refusal:
        print(f"{options.scene}: this scene cannot be flown: {refusal}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("stopped; the finished points are kept, the same command goes on", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(main())
