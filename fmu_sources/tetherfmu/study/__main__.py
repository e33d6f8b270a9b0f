"""All studies of the tethers, one command: `python -m tetherfmu.study COMMAND`; see `--help`."""

import argparse
import sys
import tomllib
from importlib import import_module
from pathlib import Path

from tetherfmu.console.ending import WorkersLost, WrongUse, command
from tetherfmu.console.options import Parser, address, file, folder, new_file, number
from tetherfmu.runtime.layout import MAX_SEGMENTS
from tetherfmu.runtime.parameters import Tether
from tetherfmu.runtime.variants import VARIANTS

DOCS, STUDY, BENCHMARK = Path("docs"), Path("study"), Path("benchmark")
STORING = ("tradeoff", "page", "stability")  # commands that keep finished points
KEPT = "the finished points are kept, and the same command continues from them"


def add_workers(option):
    """Declare who does the work of a command."""
    option("--processes", type=number(1, whole=True), metavar="N", help="number of processes (default: one per core)")
    option("--dask", type=address, metavar="ADDRESS", help="use the cluster of this Dask scheduler (extra: cluster)")


def add_advice(added):
    """Declare the commands on scenes and what the advisor reads; `added` adds one, and returns what adds options to it."""
    option = added("advise", "advice.advise", "say which FMU, segments, tolerance and communication step to use")
    option("scene", metavar="SCENE", help="scene file (TOML)")
    option("--fast", action="store_true", help="take a second or two, and say if that is not enough")

    option = added("tradeoff", "advice.scene_report", "measure error and cost of every configuration in a scene")
    option("scene", metavar="SCENE", help="scene file (TOML)")
    option("--out", type=folder, metavar="DIR", help="folder of results; continues a stopped run (default: study/NAME)")
    add_workers(option)
    option("--fmus", type=folder, metavar="DIR", help="folder of the FMUs (default: build them)")
    option("--no-fmpy", action="store_true", help="leave out the cost through FMPy")

    added("costs", "measuring.unit_costs", "measure the unit costs anew (costs.csv of this package)")
    added("thresholds", "advice.thresholds", "measure the thresholds anew (thresholds.csv of this package)")

    option = added("page", "advice.page", "measure and write docs/use/how_much_tether.md and its figures")
    option("scenes", metavar="SCENE", nargs="+", help="scene files (TOML)")
    about = "folder for use/, data/ and figures/ (default: docs)"
    option("--out", type=folder, metavar="DIR", default=DOCS, help=about)
    option("--store", type=folder, metavar="DIR", default=STUDY, help="folder of finished points (default: study)")


def add_limits_and_costs(added):
    """Declare the commands that measure what the tethers stand and cost; see `add_advice`."""
    option = added("stability", "stability.report", "find where the tethers are stable and where they refuse")
    option(
        "--points", type=number(1, whole=True), default=20_000, metavar="N", help="number of random points (default: 20000)"
    )
    option("--seed", type=number(0, whole=True), default=1, metavar="SEED", help="seed of the random points (default: 1)")
    about = "control of the winch: speed, force or length (default: speed)"
    option("--control", choices=("speed", "force", "length"), default="speed", metavar="CONTROL", help=about)
    option(
        "--ground",
        action="store_true",
        help="with a ground, and free kites instead of the straight tethers, which ignore it",
    )
    about = "folder for measurements/, data/ and figures/ (default: docs)"
    option("--out", type=folder, default=DOCS, metavar="DIR", help=about)
    about = "file of finished points (default: stability_SEED.jsonl, _CONTROL and _ground added, in the folder of --out)"
    option("--results", type=new_file(".jsonl"), metavar="FILE", help=about)
    about = "file of finished points of another version, to compare with"
    option("--before", type=file, metavar="FILE", help=about)
    option("--also", type=file, metavar="FILE", help="file of finished points of another seed, for a table of its own")
    about = "files of finished points with another --control or --ground, for tables of all of them"
    option("--others", type=file, nargs="+", default=(), metavar="FILE", help=about)
    add_workers(option)
    option("--quick", action="store_true", help="smoke test: a few points and no figures")
    option("--point", type=number(0, whole=True), metavar="NUMBER", help="judge this point only and print it")

    option = added("benchmark", "benchmark.report", "measure what the tethers cost, including comparisons")
    option("--quick", action="store_true", help="smoke test of a few seconds, timings unreliable")
    option("--flights", action="store_true", help="compare the two flights only, without compiled C")
    option("--no-peers", action="store_true", help="leave out CasADi and MoorDyn")
    option("--fmus", type=folder, metavar="DIR", help="folder of the FMUs (default: build them)")
    about = "folder for measurements/ and data/ (default: benchmark)"
    option("--out", type=folder, metavar="DIR", default=BENCHMARK, help=about)
    option("--figure", type=new_file(".png"), metavar="FILE", help="draw the work-precision diagram to this PNG file")


def constant(text):
    """Type of an option NAME=VALUE: the name, and the value as in a TOML file, a text if it is none."""
    name, equals, value = text.partition("=")
    if not (name and equals and value):
        raise argparse.ArgumentTypeError(
            f"{text!r} is not possible; it must be SECTION.NAME=VALUE, as in tether.diameter='14 mm'"
        )
    try:
        return name, tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return name, value


def add_replay(added):
    """Declare the command on measured flights; see `add_advice`."""
    option = added("replay", "replay.replay", "fly a measured flight with the tethers, and compare them with its log")
    option("log", metavar="LOG", help="the log (CSV)")
    about = "what its columns are: a map of this package, or a file (TOML) (default: kitepower)"
    option("--as", dest="map", metavar="MAP", help=about)
    option(
        "--set",
        type=constant,
        action="append",
        metavar="NAME=VALUE",
        help="change a constant of the map, such as tether.diameter=0.014",
    )
    leads = ("tension", "length", "speed")
    option(
        "--lead",
        choices=leads,
        help="what the winch follows: tension, length or speed (default: the first of them in the log)",
    )
    tethers = tuple(reversed(VARIANTS))
    option("--tether", choices=tethers, nargs="+", metavar="NAME", help=f"tethers: {', '.join(tethers)} (default: all)")
    whole, about = number(1, MAX_SEGMENTS, whole=True), f"segments of tethers with nodes (default: {Tether.segments})"
    option("--segments", type=whole, default=Tether.segments, metavar="N", help=about)
    option(
        "--from",
        dest="start",
        type=number(unit="s"),
        metavar="T",
        help="start of the flight, in s of the log (default: its first)",
    )
    option("--to", dest="end", type=number(unit="s"), metavar="T", help="end of the flight (default: that of the log)")
    fits = ("offset", "origin", "delay", "nothing")
    about = (
        "what is fitted so that length and positions agree: offset, origin, delay, or nothing (default: offset, if possible)"
    )
    option("--fit", choices=fits, nargs="+", metavar="WHAT", help=about)
    about = (
        "start of the part used for the fit (default: what is before the flight; its first half if that is less than 20 s)"
    )
    option("--fit-from", type=number(unit="s"), metavar="T", help=about)
    option("--fit-to", type=number(unit="s"), metavar="T", help="end of that part")
    option("--out", type=folder, metavar="DIR", help="folder of the results (default: flights/NAME)")
    option("--html", action="store_true", help="also write a page with the tether in space (needs plotly)")
    about = "also build the FMU that is advised for this flight, with its values as start values"
    option("--fmu", action="store_true", help=about)


def parse(arguments, prog):
    """Command line options; among them `module`, the one whose function `run` does the command."""
    parser = Parser(prog=prog, description="studies of the tethers: advice, costs, limits")
    commands = parser.add_subparsers(dest="command", required=True)

    def added(name, module, about):
        sub = commands.add_parser(name, help=about, description=about)
        sub.set_defaults(module=module)
        return sub.add_argument

    add_advice(added)
    add_limits_and_costs(added)
    add_replay(added)
    return parser.parse_args(arguments)


@command
def main(arguments=None, prog="python -m tetherfmu.study"):
    """Do what the command line says; returns the exit status."""
    options = parse(sys.argv[1:] if arguments is None else arguments, prog)
    from tetherfmu.results import StepRefused

    try:
        return import_module(f"{__package__}.{options.module}").run(options)
    except StepRefused as refusal:
        raise WrongUse(f"{getattr(options, 'scene', options.command)}: this scene cannot be flown: {refusal}") from None
    except (KeyboardInterrupt, WorkersLost) as end:
        if options.command in STORING:
            end.args = ("; ".join([*end.args, KEPT]),)
        raise


if __name__ == "__main__":
    sys.exit(main())
