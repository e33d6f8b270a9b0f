"""The sweep of a scene or a system: many flights with values on grids, in lists and at random, and their statistics."""

from importlib import import_module

from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, folder, names, number
from tetherfmu.runtime.limits import MAX_SEGMENTS
from tetherfmu.runtime.parameters import Tether
from tetherfmu.runtime.variants import VARIANTS


def numbers(text):
    """Type of a list of percentiles, separated by commas."""
    return tuple(map(number(0.0, 100.0), text.split(",")))


@command
def main(arguments=None, prog="tetherfmu sweep"):
    """Fly all flights, write tables, figures and a page, print where they are; returns the exit status."""
    parser = Parser(prog=prog)
    option = parser.add_argument
    option("scene", metavar="SCENE", help="file of a scene or a system (TOML), or a name of tetherfmu fly --list")
    about = (
        "varied quantity; may be repeated: NAME=FROM..TO:COUNT (grid), NAME=A,B,C (list), NAME=1..20 (integers), "
        "or NAME~DISTRIBUTION(...), one of uniform, normal, lognormal, weibull and triangular"
    )
    option("--vary", action="append", required=True, metavar="TEXT", help=about)
    about = "samples of the distributions at each grid point (default: 100)"
    option("--samples", type=number(1, 1e7, whole=True), default=100, metavar="N", help=about)
    about = "sampling method (default: latin_hypercube)"
    parser.add_choice("--method", ("latin_hypercube", "sobol"), default="latin_hypercube", help=about)
    option("--seed", type=number(0, 2**31, whole=True), default=1, metavar="N", help="seed of the samples (default: 1)")
    parser.add_settings()
    about = (
        "outputs with statistics, or power and payout of the winch, separated by commas; of a system such as "
        "hoist.tension_from, or of all lines tension_from (default: tensions at both ends, power, payout)"
    )
    option("--outputs", type=names, metavar="NAME,...", help=about)
    about = "percentiles of each output (default: 5,50,95)"
    option("--percentiles", type=numbers, default=(5.0, 50.0, 95.0), metavar="P,...", help=about)
    about = "output whose cycles are counted by rainflow (default: ground_tension; of a system that of the first line)"
    option("--cycles-of", metavar="NAME", help=about)
    about = "start time of the statistics [s] (default: 0)"
    option("--from", dest="start", type=number(0.0, unit="s"), default=0.0, metavar="T", help=about)
    parser.add_choice("--tether", tuple(reversed(VARIANTS)), default="dynamic", help="tether (default: dynamic)")
    whole, about = number(1, MAX_SEGMENTS, whole=True), f"segments (default: {Tether.segments}; a system has its own)"
    option("--segments", type=whole, metavar="N", help=about)
    about = "communication step [s] (default: from the scene, or 0.02)"
    option("--step", type=number(1e-6, 1e3, "s"), metavar="H", help=about)
    about = "folder of results; continues a stopped sweep (default: study/NAME_sweep)"
    option("--out", type=folder, metavar="DIR", help=about)
    parser.add_workers()
    options = parser.parse_args(arguments)
    return import_module("tetherfmu.study.sweeps.report").run(options)
