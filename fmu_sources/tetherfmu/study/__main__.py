"""All studies of the tethers, one command: `python -m tetherfmu.study COMMAND`; see `--help`."""

import sys
import tempfile
from importlib import import_module
from pathlib import Path

from tetherfmu.console.ending import WrongUse, command
from tetherfmu.console.options import Parser, address, folder, number
from tetherfmu.console.progress import now

GOING_ON = ("tradeoff", "page", "stability")  # commands that keep finished points
WITH_OWN_OPTIONS = {
    "stability": "find where the tethers hold and where they refuse",
    "benchmark": "measure what the tethers cost, in races too",
}


def parse(arguments, prog):
    """Command line options."""
    parser = Parser(prog=prog, description="Studies of the tethers: advice, costs, limits.")
    commands = parser.add_subparsers(dest="command", required=True)

    def added(run, name, about):
        sub = commands.add_parser(name, help=about, description=about)
        sub.set_defaults(run=run)
        return sub

    advice = added(run_advise, "advise", "say which FMU, segments, tolerance and communication step to use")
    advice.add_argument("scene", metavar="SCENE", help="scene file (TOML)")
    advice.add_argument("--fast", action="store_true", help="in a second or two; says so if that does not suffice")
    trade = added(run_tradeoff, "tradeoff", "measure error and cost of every configuration in a scene")
    trade.add_argument("scene", metavar="SCENE", help="scene file (TOML)")
    trade.add_argument(
        "--out", type=folder, metavar="DIR", help="folder of results (default: study/NAME); goes on where it was stopped"
    )
    trade.add_argument("--processes", type=number(1, whole=True), metavar="N", help="default: one per core")
    trade.add_argument(
        "--dask", type=address, metavar="ADDRESS", help="use the cluster of this Dask scheduler (extra: cluster)"
    )
    trade.add_argument("--fmus", type=folder, metavar="DIR", help="folder of the FMUs (default: build them)")
    trade.add_argument("--no-fmpy", action="store_true", help="leave out the cost through FMPy")
    added(run_costs, "costs", "measure the unit costs anew (costs.csv of this package)")
    added(run_thresholds, "thresholds", "measure the thresholds anew (thresholds.csv of this package)")
    page = added(run_page, "page", "measure and write docs/how_much_tether.md and its figures")
    page.add_argument("scenes", metavar="SCENE", nargs="+", help="scene files (TOML)")
    page.add_argument("--out", type=folder, metavar="DIR", default="docs", help="folder of the page (default: docs)")
    page.add_argument(
        "--store", type=folder, metavar="DIR", default="study", help="folder of finished points (default: study)"
    )
    for name, about in WITH_OWN_OPTIONS.items():
        if name in arguments:
            module = import_module(f"{__package__}.{name}.command")
            module.add_arguments(added(module.run, name, about))
        else:
            added(None, name, about)  # for the list of commands; what it needs takes a second to import
    return parser.parse_args(arguments)


def run_advise(options):
    """Print the advice for a scene; returns 1 if nothing meets what it asks for."""
    from tetherfmu.study.advice.advise import advise, explain, fast_advice
    from tetherfmu.study.scenes.files import load

    scene = load(options.scene)
    if not options.fast:
        now(f"flying {scene.name} with what may do, and with a finer model")
    advice = fast_advice(scene) if options.fast else advise(scene)
    print(explain(scene, advice))
    return 0 if advice.met else 1


def fmpy_times(scene, points, folder):
    """Measured time per simulated second through FMPy of the configurations that the report names; builds missing FMUs."""
    from tetherfmu.study.advice.tradeoff import LEVELS, cheapest
    from tetherfmu.study.measuring.through_fmpy import flown, fmus_in

    now("measuring through FMPy")
    best = [cheapest(points, level) for level in {*LEVELS, scene.wanted.allowed_error}]
    with tempfile.TemporaryDirectory() as temporary:
        fmus_in(folder or temporary)
        return {each.config: flown(folder or temporary, scene, each.config)[0] for each in best if each is not None}


def run_tradeoff(options):
    """Study a scene, write and print the report."""
    from tetherfmu.study.advice import scene_report
    from tetherfmu.study.advice.tradeoff import study
    from tetherfmu.study.measuring.executors import executor_of, progress_bar
    from tetherfmu.study.measuring.store import POINTS, Store
    from tetherfmu.study.scenes.files import load

    scene = load(options.scene)
    store = Store(Path(options.out or Path("study") / scene.name) / POINTS)
    with executor_of(options.dask, options.processes) as executor:
        reference, points = study(scene, store, executor, progress_bar(scene.name))
    through_fmpy = {} if options.no_fmpy else fmpy_times(scene, points, options.fmus)
    print(scene_report.write(scene, reference, points, through_fmpy, store.folder))


def run_costs(_):
    """Measure and store the unit costs."""
    now("measuring the unit costs")
    import_module("tetherfmu.study.measuring.unit_costs").measure_costs()


def run_thresholds(_):
    """Measure and store the thresholds."""
    from tetherfmu.study.advice.thresholds import thresholds, write
    from tetherfmu.study.measuring.executors import executor_of, progress_bar

    with executor_of() as executor:
        write(*thresholds(executor, progress_bar("thresholds")))


def run_page(options):
    """Write the page of the manual."""
    from tetherfmu.study.advice.page import make
    from tetherfmu.study.measuring.executors import executor_of, progress_bar

    with executor_of() as executor:
        make(options.scenes, options.out, options.store, executor, progress_bar)


@command
def main(arguments=None, prog="python -m tetherfmu.study"):
    """Do what the command line says; returns the exit status."""
    options = parse(sys.argv[1:] if arguments is None else arguments, prog)
    from tetherfmu.results import StepRefused

    try:
        return options.run(options)
    except StepRefused as refusal:
        raise WrongUse(f"{getattr(options, 'scene', options.command)}: this scene cannot be flown: {refusal}") from None
    except KeyboardInterrupt:
        if options.command in GOING_ON:
            raise KeyboardInterrupt("the finished points are kept, the same command goes on") from None
        raise


if __name__ == "__main__":
    sys.exit(main())
