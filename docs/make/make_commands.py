"""Write docs/reference/commands.md from the parsers of the commands: `python docs/make/make_commands.py`."""

import re
from importlib import import_module
from pathlib import Path
from unittest.mock import patch

from tetherfmu.console.options import Parser
from tetherfmu.console.subcommands import SUBCOMMANDS

PAGE = Path(__file__).resolve().parents[1] / "reference" / "commands.md"
SEE = {  # command: page with more
    "build": "../use/importing.md",
    "fly": "../use/sweeps.md",
    "check": "fmi.md#check-an-fmu",
    "replay": "../use/your_log.md",
    "advise": "../use/how_much_tether.md#ask-the-advisor",
    "tradeoff": "../use/how_much_tether.md#ask-the-advisor",
    "sweep": "../use/sweeps.md#sweep-a-scene",
    "import": "../use/from_tethers_jl.md#settings-and-line-files",
    "tutorial": "../use/tutorial.md",
    "web": "../use/in_the_browser.md",
}
OF_THIS_MACHINE = re.compile(r"\(default: \S+, this one\)")
TEXT = """# Commands

<!-- Written by docs/make/make_commands.py from the sources: edit those, and run it again. -->

For everyone who works in a terminal. `tetherfmu COMMAND --help` prints the same; `python -m tetherfmu` is the same program.
The exit status is 0 for success, 1 for a failure or a problem found, 2 for wrong usage, 130 for Ctrl-C. In `NAME=VALUE` a
value may have a unit: `"5 mm"`.

{sections}
"""


class Parsed(Exception):
    """A command has made its parser, which is the argument."""


def parser_of(name):
    """The parser of a subcommand, which is stopped where it would read its options."""

    def stop(parser, *_):
        raise Parsed(parser)

    main = import_module(SUBCOMMANDS[name].module or f"tetherfmu.commands.{name}").main
    with patch.object(Parser, "parse_args", stop):
        try:
            main([], prog=f"tetherfmu {name}")
        except Parsed as parsed:
            return parsed.args[0]
    raise RuntimeError(f"{name} has no parser")


def escaped(text):
    """A text for a cell of a table."""
    return re.sub(r"\s+", " ", text).replace("|", "\\|")


def row(action, formatter):
    """Row of an option: how it is written, and what it does."""
    value = formatter._format_args(action, action.dest.upper()) if action.nargs != 0 else ""
    written = " ".join(filter(None, [", ".join(action.option_strings), value]))
    about = OF_THIS_MACHINE.sub("(default: this one)", formatter._expand_help(action))
    return f"|`{escaped(written)}`|{escaped(about)}|"


def section(name):
    """What a command does, an example, and its options."""
    parser, known = parser_of(name), SUBCOMMANDS[name]
    formatter = parser._get_formatter()
    rows = [row(action, formatter) for action in parser._actions if "--help" not in action.option_strings]
    head = f"## {name}\n\n{known.about[0].upper()}{known.about[1:]}. [More]({SEE[name]}).\n\n```text\n{known.example}\n```"
    return "\n".join([head, "", "|option|meaning|", "|---|---|", *rows])


def page():
    """Text of docs/reference/commands.md."""
    return TEXT.format(sections="\n\n".join(map(section, SUBCOMMANDS)))


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
