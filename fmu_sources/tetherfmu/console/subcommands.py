"""The subcommands of `tetherfmu`: where they are, what they do, and an example of each."""

from typing import NamedTuple


class Subcommand(NamedTuple):
    """One of `SUBCOMMANDS`."""

    about: str
    example: str  # that can be typed
    module: str = ""  # whose function `main` does it; "" for that of its name in `commands`


SUBCOMMANDS = {
    "build": Subcommand("build FMUs: all, or those that are named", "tetherfmu build dynamic --segments 20 --native"),
    "fly": Subcommand(
        "fly a circle, a scene, or the flight of a CSV file, with tether FMUs",
        "tetherfmu fly eight_on_a_winch --set winch.force='5 kN' --html",
    ),
    "check": Subcommand("check FMUs on this machine", "tetherfmu check dist/TetherDynamic.fmu", "tetherfmu.check.__main__"),
    "replay": Subcommand(
        "fly a measured flight with the tethers, and compare them with its log",
        "tetherfmu replay examples/flights/kitepower_20191008_0012.csv --as kitepower_2019",
    ),
    "advise": Subcommand(
        "say which FMU, segments, tolerance and communication step a scene or a system needs",
        "tetherfmu advise examples/scenes/circle.toml --fast",
    ),
    "tradeoff": Subcommand(
        "measure error and cost of every configuration in a scene",
        "tetherfmu tradeoff examples/scenes/circle.toml",
    ),
    "sweep": Subcommand(
        "fly a scene with many values, on a grid or at random, and write statistics",
        "tetherfmu sweep circle --vary 'tether.diameter=3 mm..6 mm:4' --vary wind.speed=6,9,12",
    ),
    "import": Subcommand(
        "make a scene of settings of KiteUtils.jl, or a system of a file of MoorDyn or CableDyn",
        "tetherfmu import examples/systems/moored.txt --out moored.toml",
        "tetherfmu.commands.importing",
    ),
    "tutorial": Subcommand(
        "list, run and copy the lessons of the tutorial",
        "tetherfmu tutorial 06 --out plots",
    ),
    "web": Subcommand(
        "write a page in which one flies a tether in the browser",
        "tetherfmu web --serve",
    ),
}
