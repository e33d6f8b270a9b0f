"""The command `tetherfmu`, also `python -m tetherfmu`: imports a subcommand and passes it the rest of the line."""

import sys
from importlib import import_module

from .console.ending import command
from .console.subcommands import SUBCOMMANDS
from .files.toml_files import WrongUse
from .runtime import __version__
from .runtime.naming import meant_or_all

HEAD = "usage: tetherfmu COMMAND [OPTIONS]; tetherfmu COMMAND --help has the options, --version the version"


def usage():
    """All commands: purpose of each, and an example."""
    width = max(map(len, SUBCOMMANDS)) + 2
    lines = (f"  {name:<{width}}{each.about}\n  {'':<{width}}  {each.example}" for name, each in SUBCOMMANDS.items())
    return "\n".join([HEAD, "", *lines])


@command
def main(arguments=None):
    """Run the command line; returns the exit status."""
    name, *rest = (sys.argv[1:] if arguments is None else arguments) or ["--help"]
    if name in ("-h", "--help"):
        print(usage())
        return 0
    if name == "--version":
        print(f"tetherfmu {__version__}")
        return 0
    if name not in SUBCOMMANDS:
        raise WrongUse(f"tetherfmu: there is no command {name!r}{meant_or_all(name, SUBCOMMANDS, 'choose from {}')}")
    return import_module(SUBCOMMANDS[name].module or f"tetherfmu.commands.{name}").main(rest, prog=f"tetherfmu {name}")


if __name__ == "__main__":
    sys.exit(main())
