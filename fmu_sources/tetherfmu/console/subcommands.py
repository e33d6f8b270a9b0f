"""The subcommands of `tetherfmu`: their modules, their purposes, and an example of each."""

from typing import NamedTuple


class Subcommand(NamedTuple):
    """One of `SUBCOMMANDS`."""

    about: str
    example: str  # that can be typed
    module: str = ""  # with the function `main`; "" for the module of its name in `commands`


SUBCOMMANDS = {
    "build": Subcommand("build all FMUs, or the named ones", "tetherfmu build dynamic --segments 20 --native"),
    "fly": Subcommand(
        "run a circle, a scene, a system or a logged path (CSV) with tether FMUs",
        "tetherfmu fly eight_on_a_winch --set winch.force='5 kN' --html",
    ),
    "check": Subcommand("check FMUs on this machine", "tetherfmu check dist/TetherDynamic.fmu", "tetherfmu.check.__main__"),
    "replay": Subcommand(
        "replay a measured flight with the tethers, and compare them with its log",
        "tetherfmu replay examples/flights/kitepower_20191008_0012.csv --as kitepower_2019",
    ),
    "advise": Subcommand(
        "recommend FMU, segments, tolerance and communication step for a scene or a system",
        "tetherfmu advise examples/scenes/circle.toml --fast",
    ),
    "tradeoff": Subcommand(
        "measure error and cost of every configuration in a scene", "tetherfmu tradeoff examples/scenes/circle.toml"
    ),
    "sweep": Subcommand(
        "run a scene with many values, on a grid or at random, and write statistics",
        "tetherfmu sweep circle --vary 'tether.diameter=3 mm..6 mm:4' --vary wind.speed=6,9,12",
    ),
    "import": Subcommand(
        "convert KiteUtils.jl settings to a scene, MoorDyn or CableDyn decks to a system",
        "tetherfmu import examples/systems/moored.txt --out moored.toml",
        "tetherfmu.commands.importing",
    ),
    "tutorial": Subcommand("list, run and copy the tutorial lessons", "tetherfmu tutorial 06 --out plots"),
    "web": Subcommand("write a page that flies a tether in the browser", "tetherfmu web --serve"),
}
