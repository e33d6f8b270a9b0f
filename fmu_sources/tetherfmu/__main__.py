"""The command `tetherfmu`, also `python -m tetherfmu`: imports a subcommand and gives it the rest of the line."""

import sys
from importlib import import_module

STUDY = "tetherfmu.study.__main__"
EXTRAS = {STUDY: "study", "tetherfmu.commands.release": "release"}  # what a module needs more than the package itself
COMMANDS = {  # name: (module, what it does)
    "build": ("tetherfmu.commands.build", "build FMUs"),
    "fly": ("tetherfmu.commands.fly", "fly a kite on a circle with tether FMUs"),
    "check": ("tetherfmu.check.__main__", "check FMUs on this machine"),
    "release": ("tetherfmu.commands.release", "make a folder with all that users download"),
    "advise": (STUDY, "say which FMU, segments, tolerance and communication step a scene needs"),
    "tradeoff": (STUDY, "measure error and cost of every configuration in a scene"),
    "stability": (STUDY, "find where the tethers hold and where they refuse"),
    "benchmark": (STUDY, "measure what the tethers cost, in races too"),
}
WRONG_USE, STOPPED = 2, 130  # exit status


def usage():
    """All commands, a line each."""
    lines = [f"  {name:<10} {about}" for name, (_, about) in COMMANDS.items()]
    return "\n".join(["usage: tetherfmu COMMAND [OPTIONS]; tetherfmu COMMAND --help tells the options", "", *lines])


def main(arguments=None):
    """Do what the command line says; returns the exit status."""
    name, *rest = (sys.argv[1:] if arguments is None else arguments) or ["--help"]
    if name in ("-h", "--help"):
        print(usage())
        return 0
    if name not in COMMANDS:
        print(f"tetherfmu has no command {name}; choose from {', '.join(COMMANDS)}", file=sys.stderr)
        return WRONG_USE
    module, _ = COMMANDS[name]
    try:
        run = import_module(module).main
        return (run([name, *rest], prog="tetherfmu") if module == STUDY else run(rest)) or 0
    except ModuleNotFoundError as missing:
        if (missing.name or "tetherfmu").startswith("tetherfmu"):
            raise
        extra = EXTRAS.get(module, "examples")
        print(f'{name} needs {missing.name}, which is not installed: pip install "tetherfmu[{extra}]"', file=sys.stderr)
        return WRONG_USE
    except KeyboardInterrupt:
        print("stopped", file=sys.stderr)
        return STOPPED


if __name__ == "__main__":
    sys.exit(main())
