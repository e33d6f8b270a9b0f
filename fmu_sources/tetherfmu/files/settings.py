"""Single values that replace those of a scene file: SECTION.KEY as in the file, or a parameter by its name in an FMU."""

import re
from copy import deepcopy
from math import atan2, cos, hypot, sin

import numpy as np

from tetherfmu.runtime.naming import meant, meant_or_all, prefixed
from tetherfmu.runtime.parameters import Environment, Ground, Tether, Winch
from tetherfmu.wind.frozen_turbulence import PERIODIC

from .courses import CHANGES
from .toml_files import check_once, in_si, keys_of, value_of
from .winds import Box, Wind

NOT_OF_A_SCENE = ("segments", "winch_control")
PREFIX = {"tether": "", "environment": "", "ground": "ground_", "winch": "winch_"}  # of the names in an FMU, by section
OF_THE_WIND = {"wind.speed": "m/s", "wind.direction": "rad"}  # components of `wind.velocity`: horizontal, from x to y
SEED, FARTHEST = "wind.seed", 1e5  # name, and how far a seed moves a box along and across [m]
MADE_OF = {**dict.fromkeys(OF_THE_WIND, "wind.velocity"), SEED: "wind.box.origin"}  # vectors that these change
ELEMENT = re.compile(r"(.+)\[([123])\]")


def keys_of_parameters():
    """Key of a scene file (SECTION.KEY) of each parameter that a scene has, by its name in an FMU."""
    kinds = dict(zip(PREFIX, (Tether, Environment, Ground, Winch), strict=True))
    named = ((section, name) for section, kind in kinds.items() for name in keys_of(kind) if name not in NOT_OF_A_SCENE)
    return {name: f"{section}.{name.removeprefix(PREFIX[section])}" for section, name in named}


def key_meant(name):
    """Key of a scene file (SECTION.KEY, or one without a section) for a name; ValueError if there is none."""
    section, _, last = name.partition(".")
    if section == "wind" and last not in (*keys_of(Wind), "file") and (hint := meant(name, (*OF_THE_WIND, SEED))):
        raise ValueError(f"a scene has no {name}{hint}")
    if last or name == "duration":
        return name
    keys = keys_of_parameters()
    if name not in keys:
        hint = meant_or_all(name, keys, "a key of the file is SECTION.KEY, and parameters are {}")
        raise ValueError(f"a scene has no {name}{hint}")
    return keys[name]


def with_settings(table, settings):
    """Table of a scene file, dict, with replaced values, which are checked when the scene is read.

    settings : pairs (name, value). A name is a key, such as ``tether.diameter`` or ``wind.velocity[1]``; or
    ``wind.speed`` or ``wind.direction``, the horizontal wind; or ``wind.seed``, a number for each piece of a periodic box;
    or a parameter, such as ``diameter``.  ValueError names one that cannot be set, or two that are the same value.
    """
    if not settings:
        return table
    check_settings(name for name, _ in settings)
    changed = deepcopy(table)
    for name, value in settings:
        if name == SEED:
            move_box(changed, value)
        elif name in OF_THE_WIND:
            set_wind(changed, name, value)
        else:
            put(changed, key_meant(name), value)
    return changed


def check_settings(names):
    """ValueError if two names of settings, in whatever spelling, are the same value of a scene."""
    check_once(names, lambda name: name if name in MADE_OF else key_meant(name), MADE_OF)


def put(table, key, value):
    """Set the value of a key, with its sections, in a table (modified); ValueError if it cannot be."""
    element = ELEMENT.fullmatch(key)
    *sections, last = (element[1] if element else key).split(".")
    if sections[:1] == ["series"] and last in CHANGES:
        table, sections = with_rows(table, sections), []
    for section in sections:
        table = table.setdefault(section, {})
        if not isinstance(table, dict):
            raise ValueError(f"{key} cannot be set: {section} is {table!r}, no table")
    if not element:
        table[last] = value
        return
    vector = table.setdefault(last, [0.0, 0.0, 0.0])
    if not isinstance(vector, list) or len(vector) != 3:
        raise ValueError(f"{key} cannot be set: {element[1]} is {vector!r}, no three numbers")
    vector[int(element[2]) - 1] = value


def with_rows(table, sections):
    """Table of a course in a table (modified): rows alone become one with `rows`; ValueError if there is none."""
    *outer, name = sections
    for section in outer:
        table = table.get(section, {}) if isinstance(table, dict) else {}
    if not isinstance(table, dict) or name not in table:
        raise ValueError(f"there is no {'.'.join(sections)} to change")
    if not isinstance(table[name], dict):
        table[name] = {"rows": table[name]}
    return table[name]


def set_wind(table, name, value):
    """Set speed [m/s] or direction [rad] of the wind in a table (modified); ValueError for other values.

    Without wind in the file it blows along x.
    """
    with prefixed(f"{name} is {value!r}; "):
        given = float(in_si(value, OF_THE_WIND[name]))
    wind = table.setdefault("wind", {})
    if not isinstance(wind, dict):
        raise ValueError(f"wind is {wind!r}; it must be a table [wind]")
    x, y, z = value_of(Wind, "velocity", wind.get("velocity", [0.0, 0.0, 0.0]), "wind.")
    speed, direction = (given, atan2(y, x)) if name == "wind.speed" else (hypot(x, y), given)
    wind["velocity"] = [speed * cos(direction), speed * sin(direction), z]


def move_box(table, seed):
    """Move the box of turbulence of a table (modified) by a random displacement along and across, determined by a seed.

    So each seed is another piece of a periodic box.  ValueError without such a box, or for an invalid seed.
    """
    if not isinstance(seed, int) or isinstance(seed, bool) or seed < 0:
        raise ValueError(f"{SEED} is {seed!r}; it must be a whole number of at least 0")
    wind = table.get("wind", {})
    box = wind.setdefault("box", {}) if isinstance(wind, dict) and "file" in wind else None
    if not isinstance(box, dict) or value_of(Box, "outside", box.get("outside", PERIODIC), "wind.box.") != PERIODIC:
        raise ValueError(f"{SEED} is {seed!r}; it needs a periodic box of turbulence, wind.file")
    origin = value_of(Box, "origin", box.get("origin", [0.0, 0.0, 0.0]), "wind.box.")
    moved = (*np.random.default_rng(seed).uniform(0.0, FARTHEST, 2).tolist(), 0.0)
    box["origin"] = [place + way for place, way in zip(origin, moved, strict=True)]
