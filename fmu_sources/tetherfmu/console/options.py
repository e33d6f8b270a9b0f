"""Options of commands: a parser with one-line error messages, and types that name permitted values."""

import argparse
import os
import re
import sys
import tomllib
from pathlib import Path

from tetherfmu.files.toml_files import check_once
from tetherfmu.runtime.naming import meant_or_all
from tetherfmu.runtime.quantities import Quantity

from .ending import WRONG_USE
from .subcommands import SUBCOMMANDS

ADDRESS = re.compile(r"(\w+://)?[^\s:/]+:\d+")


class Parser(argparse.ArgumentParser):
    """Reports a wrong command line in one line; the help of a subcommand ends with an example."""

    def __init__(self, prog=None, **options):
        known = SUBCOMMANDS.get((prog or "").removeprefix("tetherfmu "))
        super().__init__(prog, **({"description": known.about} if known else {}) | options)
        self._end_of_help = f"\nexample: {known.example}\n" if known else ""

    def format_help(self):
        """Description and options; the example is one line, however narrow the terminal is, so that it can be copied."""
        return super().format_help() + self._end_of_help

    def parse_args(self, args=None, namespace=None):
        """The options; one that does not exist is named before anything else, with that which was probably meant."""
        args = sys.argv[1:] if args is None else args
        known = re.findall(r"--[\w-]+", self.format_help())
        for name in (each.partition("=")[0] for each in args if re.match("--[a-z]", each)):
            if not any(each.startswith(name) for each in known):
                self.error(f"there is no option {name}{meant_or_all(name, dict.fromkeys(known))}")
        found = super().parse_args(args, namespace)
        try:
            check_once(names_in(getattr(found, "settings", None) or getattr(found, "starts", None) or ()))
        except ValueError as error:
            self.error(f"--set: {error}")
        return found

    def error(self, message):
        """Exit with status 2; for an option of several values, list them."""
        option = re.match(r"argument (--[\w-]+): expected \d+ arguments$", message)
        if option:
            message += f", {re.search(rf'{option[1]}[^]]*', self.format_usage())[0]}"
        self.exit(WRONG_USE, f"{self.prog}: {message}\n")

    def add_choice(self, option, names, **more):
        """Add an option whose value is one of some names."""
        self.add_argument(option, type=one_of(names), **{"metavar": f"{{{','.join(names)}}}"} | more)

    def add_out(self, what="the figure"):
        """Add the option --out: the output folder of the command."""
        about = f"folder of {what} (default: plots)"
        self.add_argument("--out", type=folder, default=Path("plots"), metavar="DIR", help=about)

    def add_settings(self):
        """Add the option --set of a command that reads a scene."""
        about = "replace a value of the scene, such as tether.diameter='5 mm'; may be repeated"
        option, more = "--set", {"dest": "settings", "metavar": "NAME=VALUE", "help": about}
        self.add_argument(option, type=setting, action="append", default=[], **more)

    def add_workers(self):
        """Add options on who does the work of a study."""
        about = "number of processes (default: one per core)"
        self.add_argument("--processes", type=number(1, whole=True), metavar="N", help=about)
        about = "use the cluster of this Dask scheduler (extra: cluster)"
        self.add_argument("--dask", type=address, metavar="ADDRESS", help=about)


def number(minimum=-float("inf"), maximum=float("inf"), unit="", whole=False):
    """Type of an option that is a finite number, or a whole one, in a range."""
    return amount(Quantity(unit, "", minimum, maximum), whole)


def amount(quantity, whole=False):
    """Type of an option that is a value of a quantity."""

    def converted(text):
        try:
            value = int(text) if whole else float(text)
            possible = quantity.allows(value)
        except (ValueError, OverflowError):
            possible = False
        if not possible:
            kind = "a whole number, " if whole else "a number, " if quantity.range() != "a finite number" else ""
            raise argparse.ArgumentTypeError(f"{text!r} is not possible; it must be {kind}{quantity.range()}")
        return value

    return converted


def one_of(names):
    """Type of an option that is one of some names."""

    def checked(text):
        if text not in names:
            raise argparse.ArgumentTypeError(f"{text!r} is not possible{meant_or_all(text, names, 'choose from {}')}")
        return text

    return checked


def file(text):
    """Type of an option that is a file which is there."""
    if Path(text).is_dir():
        raise argparse.ArgumentTypeError(f"{text!r} is a folder; it must be a file")
    if not Path(text).is_file():
        raise argparse.ArgumentTypeError(f"there is no file {text}")
    return Path(text)


def address(text):
    """Type of an option that is the address of a server."""
    if not ADDRESS.fullmatch(text):
        raise argparse.ArgumentTypeError(f"{text!r} is not an address; it must be like tcp://127.0.0.1:8786")
    return text


def folder(text):
    """Type of an option that is a folder to write to, which is made if it is missing."""
    path = Path(text)
    there = next((each for each in (path, *path.parents) if each.exists()), Path())
    if not text or not there.is_dir():
        raise argparse.ArgumentTypeError(f"{text!r} is not a folder{f': {there} is a file' if text else ''}")
    if not os.access(there, os.W_OK | os.X_OK):
        raise argparse.ArgumentTypeError(f"{text!r} cannot be used: nobody may write to {there} here")
    return path


def new_file(text):
    """Type of an option that is a file to write, in a folder that is there."""
    path = Path(text)
    if path.is_dir() or not text:
        raise argparse.ArgumentTypeError(f"{text!r} is a folder; it must be a file")
    if not path.parent.is_dir():
        raise argparse.ArgumentTypeError(f"{text!r} cannot be written: there is no folder {path.parent}")
    if not os.access(path if path.exists() else path.parent, os.W_OK):
        raise argparse.ArgumentTypeError(f"{text!r} cannot be written: it is write-protected")
    return path


def names(text):
    """Type of a list of names, separated by commas."""
    return tuple(each.strip() for each in text.split(","))


def named_value(text, form="NAME=VALUE"):
    """Type of an option NAME=VALUE: both as texts; form : of such a text, for people."""
    name, equals, value = (each.strip() for each in text.partition("="))
    if not (name and equals and value):
        raise argparse.ArgumentTypeError(f"{text!r} is not possible; it must be {form}")
    return name, value


def names_in(settings):
    """Names of the settings, a list, from texts NAME=VALUE or pairs of names and values."""
    return [(each.partition("=") if isinstance(each, str) else each)[0].strip() for each in settings]


def setting(text):
    """Type of an option NAME=VALUE: the name, and the value as in a TOML file, otherwise a text."""
    name, value = named_value(text, "SECTION.NAME=VALUE, as in tether.diameter='14 mm'")
    try:
        return name, tomllib.loads(f"value = {value}")["value"]
    except tomllib.TOMLDecodeError:
        return name, value
