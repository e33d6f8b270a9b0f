"""The trade-off study of a scene: error and cost of every configuration."""

from importlib import import_module

from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, folder


@command
def main(arguments=None, prog="tetherfmu tradeoff"):
    """Study a scene, write and print the report; returns the exit status."""
    parser = Parser(prog=prog)
    option = parser.add_argument
    option("scene", metavar="SCENE", help="scene file (TOML), or a name of tetherfmu fly --list")
    option("--out", type=folder, metavar="DIR", help="folder of results; continues a stopped run (default: study/NAME)")
    parser.add_workers()
    parser.add_settings()
    options = parser.parse_args(arguments)
    return import_module("tetherfmu.study.advice.scene_report").run(options)
