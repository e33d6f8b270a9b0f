"""The replay of a measured flight: the tethers along it, compared with its log."""

from importlib import import_module

from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, folder, number, setting
from tetherfmu.runtime.layout import MAX_SEGMENTS
from tetherfmu.runtime.parameters import Tether
from tetherfmu.runtime.variants import VARIANTS


def parse(arguments, prog):
    """Command line options."""
    parser = Parser(prog=prog)
    option = parser.add_argument
    option("log", metavar="LOG", help="the log (CSV)")
    about = "map of its columns: a map of this package, or a file (TOML) (default: kitepower)"
    option("--as", dest="map", metavar="MAP", help=about)
    about = "change a constant of the map, such as tether.diameter=0.014"
    option("--set", dest="settings", type=setting, action="append", metavar="NAME=VALUE", help=about)
    about = "signal that the winch follows: tension, length or speed (default: the first of them in the log)"
    parser.add_choice("--lead", ("tension", "length", "speed"), help=about)
    tethers = tuple(reversed(VARIANTS))
    about = f"tethers: {', '.join(tethers)} (default: all)"
    parser.add_choice("--tether", tethers, nargs="+", metavar="NAME", help=about)
    whole, about = number(1, MAX_SEGMENTS, whole=True), f"segments of tethers with nodes (default: {Tether.segments})"
    option("--segments", type=whole, default=Tether.segments, metavar="N", help=about)
    time, about = number(unit="s"), "start of the flight, in s of the log (default: its first time)"
    option("--from", dest="start", type=time, metavar="T", help=about)
    option("--to", dest="end", type=time, metavar="T", help="end of the flight (default: the end of the log)")
    fits = ("offset", "origin", "delay", "nothing")
    about = (
        "corrections that reconcile length and positions: offset, origin, delay, or nothing (default: offset, if possible)"
    )
    parser.add_choice("--fit", fits, nargs="+", metavar="WHAT", help=about)
    about = (
        "start of the part used for the fit (default: the part before the flight; its first half if that is less than 20 s)"
    )
    option("--fit-from", type=time, metavar="T", help=about)
    option("--fit-to", type=time, metavar="T", help="end of the part used for the fit")
    option("--out", type=folder, metavar="DIR", help="folder of the results (default: flights/NAME)")
    option("--html", action="store_true", help="also write a page with the tether in space (needs plotly)")
    about = "also build the FMU recommended for this flight, with its values as start values"
    option("--fmu", action="store_true", help=about)
    return parser.parse_args(arguments)


@command
def main(arguments=None, prog="tetherfmu replay"):
    """Replay and compare, write the results; returns the exit status, 1 if no FMU meets the requirements of its scene."""
    options = parse(arguments, prog)
    return import_module("tetherfmu.study.replay.replay").run(options)
