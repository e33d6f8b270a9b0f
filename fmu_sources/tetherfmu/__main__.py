"""The command `tetherfmu`, also `python -m tetherfmu`: imports a subcommand and gives it the rest of the line."""

import sys
from importlib import import_module

from .console.ending import WrongUse, command
from .runtime import __version__

STUDY = "tetherfmu.study.__main__"
COMMANDS = {  # name: (module, what it does)
    "build": ("tetherfmu.commands.build", "build FMUs"),
    "fly": ("tetherfmu.commands.fly", "fly a kite on a circle, or the flight of a CSV file, with tether FMUs"),
    "check": ("tetherfmu.check.__main__", "check FMUs on this machine"),
    "tutorial": ("tetherfmu.commands.tutorial", "list, run and copy the lessons of the tutorial"),
    "web": ("tetherfmu.commands.web", "write a page in which one flies a tether in the browser"),
    "release": ("tetherfmu.commands.release", "make a folder with all that users download"),
    "replay": (STUDY, "fly a measured flight, and compare the tethers with its log"),
    "advise": (STUDY, "say which FMU, segments, tolerance and communication step a scene needs"),
    "tradeoff": (STUDY, "measure error and cost of every configuration in a scene"),
    "stability": (STUDY, "find where the tethers are stable and where they refuse"),
    "benchmark": (STUDY, "measure what the tethers cost, including comparisons"),
}


def usage():
    """All commands, a line each."""
    lines = [f"  {name:<10} {about}" for name, (_, about) in COMMANDS.items()]
    head = "usage: tetherfmu COMMAND [OPTIONS]; tetherfmu COMMAND --help has the options, --version the version"
    return "\n".join([head, "", *lines])


@command
def main(arguments=None):
    """Do what the command line says; returns the exit status."""
    name, *rest = (sys.argv[1:] if arguments is None else arguments) or ["--help"]
    if name in ("-h", "--help"):
        print(usage())
        return 0
    if name == "--version":
        print(f"tetherfmu {__version__}")
        return 0
    if name not in COMMANDS:
        raise WrongUse(f"tetherfmu: there is no command {name!r}; choose from {', '.join(COMMANDS)}")
    module, _ = COMMANDS[name]
    run = import_module(module).main
    return run([name, *rest], prog="tetherfmu") if module == STUDY else run(rest, prog=f"tetherfmu {name}")


if __name__ == "__main__":
    sys.exit(main())
