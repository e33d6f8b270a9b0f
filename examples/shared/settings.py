"""The option --set of the examples: parameters of an FMU by name, checked as its declaration says."""

import argparse
from contextlib import suppress

from tetherfmu.files.toml_files import value_of
from tetherfmu.runtime.naming import meant_or_all
from tetherfmu.runtime.quantities import quantities
from tetherfmu.wiring.variables import RECORDS

RECORD_OF = {name: record for record in RECORDS for name, _ in quantities(record)}  # of each parameter


def setting_but(decided):
    """Type of an option NAME=VALUE: a pair (name, value) of a parameter, of an enumeration by its name or number.

    decided : dict name -> what the parameters that cannot be set follow from.
    """

    def setting(text):
        """The pair."""
        name, _, value = text.partition("=")
        if name in decided:
            raise argparse.ArgumentTypeError(f"{name} follows from {decided[name]}")
        if name not in RECORD_OF:
            allowed = [each for each in RECORD_OF if each not in decided]
            hint = meant_or_all(name, allowed, "it must be NAME=VALUE with one of the names {}")
            raise argparse.ArgumentTypeError(f"{text!r} is not possible{hint}")
        try:
            return name, checked_value(name, value)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from None

    return setting


def checked_value(name, value):
    """Value of a parameter, an integer where the parameter is one; ValueError if it is out of range.

    value : a number, a text of one, perhaps with a unit, or the name of a choice.
    """
    with suppress(ValueError):  # perhaps the name of a choice, or with a unit
        value = float(value)
    record = RECORD_OF[name]
    found = getattr(record(**{name: value_of(record, name, value, "")}), name)
    return int(found) if isinstance(record.__dataclass_fields__[name].default, int) else found


def add_settings(parser, decided, about):
    """Add the option --set; decided : as of `setting_but`, None where another parser checks the texts."""
    kind = str if decided is None else setting_but(decided)
    options = {"dest": "settings", "action": "append", "default": [], "metavar": "NAME=VALUE", "help": about}
    parser.add_argument("--set", type=kind, **options)
