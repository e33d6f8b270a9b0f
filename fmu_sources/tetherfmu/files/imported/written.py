"""Result of an import: the text of a scene or a system, and the unused parts of the file."""

import json
from math import isfinite, nan
from typing import NamedTuple

from tetherfmu.runtime.naming import prefixed


class Imported(NamedTuple):
    """A file of another program, as a file of this one."""

    kind: str  # "scene" or "system"
    tables: dict  # TOML tables: dict of table names, "" for the top level, to dicts
    left_out: list  # omitted parts of the file, in words
    defaults: list  # values missing in the file, with their defaults
    notes: tuple = ()  # other notes for the user, in words
    spare: tuple = ()  # pairs (name, table): written as comments, as they need more data than the file has


def row(number):
    """ValueError names the row of a file that the block is about."""
    return prefixed(f"row {number}: ")


def number(name, text):
    """A number of a file; ValueError names a text that is not one."""
    try:
        found = float(text)
    except ValueError:
        found = nan
    if not isfinite(found):
        raise ValueError(f"{name} is {text!r}; it must be a finite number")
    return found


def said(made):
    """Sentences for the user about it."""
    yield from (f"left out: {each}" for each in made.left_out)
    yield from made.notes
    if made.defaults:
        yield f"not in the file, default used: {', '.join(made.defaults)}"


def toml(made, origin):
    """Text of the file; origin : name of the file that it was made from."""
    lines = [f"# Made from {origin}.", *(f"# {each}." for each in said(made))]
    for name, table in made.tables.items():
        lines += ["", f"[{name}]"] if name else []
        lines += [f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in table.items()]
    for name, table in made.spare:
        lines += ["", f"# [{name}]", *(f"# {key} = {json.dumps(value, ensure_ascii=False)}" for key, value in table.items())]
    return "\n".join([*lines, ""])
