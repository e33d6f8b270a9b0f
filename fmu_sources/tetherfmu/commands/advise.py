"""The advisor: which FMU, segments, tolerance and communication step a scene, or a system, needs."""

from importlib import import_module

from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser


@command
def main(arguments=None, prog="tetherfmu advise"):
    """Print the advice for a scene or a system; returns the exit status, 1 if nothing meets its requirements."""
    parser = Parser(prog=prog)
    parser.add_argument(
        "scene", metavar="SCENE", help="file of a scene or a system (TOML), or a name of tetherfmu fly --list"
    )
    parser.add_argument(
        "--fast", action="store_true", help="limit the search to a second or two, and report if that is not enough"
    )
    parser.add_settings()
    options = parser.parse_args(arguments)
    return import_module("tetherfmu.study.advice.system_advice").run_command(options)
