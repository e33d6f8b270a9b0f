"""Systems as files: points, lines and their surroundings, in TOML with numbers and units as in scene files."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from tetherfmu.records.checked_systems import checked_system
from tetherfmu.records.materials import tether_of
from tetherfmu.runtime.inputs import INPUT_TABLE
from tetherfmu.runtime.naming import prefixed
from tetherfmu.runtime.outputs import OUTPUT_TABLE
from tetherfmu.runtime.parameters import Environment, Ground, Solver, Tether, Winch
from tetherfmu.runtime.quantities import quantities
from tetherfmu.runtime.sheaves import SHEAVE_QUANTITIES
from tetherfmu.wiring.lines import Line, Point, checked_name
from tetherfmu.wiring.system import System
from tetherfmu.wiring.winches import SharedWinch

from . import lean
from .lean import Lean
from .toml_files import TABLE_OF_GROUND, ground_of, keys_of, record, require, tables_of, value_of

TABLES = ("points", "lines", "winches", "environment", "ground", "solver", "build")
OF_THE_FLIGHT = ("duration", "wind", "loads", "series", "wanted")  # keys of the flight, which are not in its FMU
# names of variables and of the terminal that the whole system has, which no point and no line can have
TAKEN = {"time", "wind", *(each.name for each in (*INPUT_TABLE, *OUTPUT_TABLE))} | {
    name for kind in (Environment, Solver, Ground) for name, _ in quantities(kind)
}


KEYS_OF_A_POINT = ("position", "velocity", "mass")  # keys of each record in a table
SHEAVES = ("through", "initial_portions", *SHEAVE_QUANTITIES)
KEYS_OF_A_LINE = dict.fromkeys(keys_of(Tether), Tether) | dict.fromkeys(keys_of(Winch), Winch)
KEYS_OF_A_LINE |= dict.fromkeys(("reel_out_speed", *SHEAVES), Line)
KEYS_OF_A_WINCH = [name for name, _ in quantities(SharedWinch)]


@dataclass(frozen=True)
class SystemFile(System):
    """Contents of a system file: a `System` and the build options of its FMU."""

    build: Lean = field(default_factory=Lean)


def load(path: str | Path) -> SystemFile:
    """`SystemFile` of a file; ValueError describes a problem in one line: file, key, value and permitted values."""
    path = Path(path)
    with prefixed(f"{path}: "):
        return read(tables_of(path), path.stem)


def read(table, name):
    """`SystemFile` from the table of a file; ValueError names the key. name : of the system, if the table has none."""
    if "flight" in table:
        raise ValueError("describes a scene, not a system of tethers; use tetherfmu fly, advise, sweep or build --scene")
    require(table, "", ("name", *TABLES, *OF_THE_FLIGHT), ("points", "lines"))
    name = table.get("name", name)
    if not isinstance(name, str):
        raise ValueError(f"name is {name!r}; it must be a text")
    checked_name("system", name)
    points = tuple(point_of(each, given) for each, given in named(table["points"], "points"))
    lines = tuple(line_of(each, given) for each, given in named(table["lines"], "lines"))
    winches = tuple(winch_of(each, given) for each, given in named(table.get("winches", {}), "winches"))
    environment = record(Environment, table.get("environment", {}), "environment")
    ground = Ground()
    if "ground" in table:
        ground = ground_of(record(TABLE_OF_GROUND, table["ground"], "ground", ("contact",)), environment)
    solver = record(Solver, table.get("solver", {}), "solver")
    build = lean.read(table.get("build", {}))
    return checked_system(SystemFile(name, points, lines, environment, solver, ground, winches, build=build))


def named(tables, section):
    """Pairs (name, table) of points, lines or winches; ValueError for a duplicate name."""
    if not isinstance(tables, dict):
        raise ValueError(f"{section} is {tables!r}; it must have tables [{section}.NAME]")
    for name in tables:
        if name in TAKEN:
            raise ValueError(f"{section}.{name}: {name} is a name of the whole system; choose another one")
    return tables.items()


def point_of(name, table):
    """`Point` of a table of a file; ValueError names the key."""
    section = f"points.{name}"
    require(table, section, KEYS_OF_A_POINT)
    given = {key: value_of(Point, key, value, f"{section}.") for key, value in table.items()}
    if "position" not in table and "mass" not in table:
        raise ValueError(f"the key {section}.position is missing; only a free point, which has a mass, goes without")
    return Point(name, **given)


def line_of(name, table):
    """`Line` of a table of a file; ValueError names the key."""
    section = f"lines.{name}"
    require(table, section, ("from", "to", "material", *KEYS_OF_A_LINE), ("from", "to", "initial_length"))
    for end in ("from", "to"):
        if not isinstance(table[end], str):
            raise ValueError(f"{section}.{end} is {table[end]!r}; it must be the name of a point")
    given = {Tether: {}, Winch: {}, Line: {}}
    for key in (key for key in table if key in KEYS_OF_A_LINE):
        given[KEYS_OF_A_LINE[key]][key] = value_of(KEYS_OF_A_LINE[key], key, table[key], f"{section}.")
    with prefixed(f"{section}."):
        winch, tether = Winch(**given[Winch]), tether_in(table, given[Tether])
    return Line(name, table["from"], table["to"], tether, winch=winch, **given[Line])


def winch_of(name, table):
    """`SharedWinch` of a table of a file; ValueError names the key."""
    section = f"winches.{name}"
    checked_name("winch", name)
    require(table, section, ("lines", "control", *KEYS_OF_A_WINCH), ("lines",))
    given = {key: table[key] for key in ("lines", "control") if key in table}
    given |= {key: value_of(SharedWinch, key, table[key], f"{section}.") for key in KEYS_OF_A_WINCH if key in table}
    with prefixed("winches."):
        return SharedWinch(name, **given)


def tether_in(table, given):
    """`Tether` with the given quantities, of the material in a table of a file; ValueError names the key."""
    if "material" not in table:
        return Tether(**given)
    if "diameter" not in given:
        raise ValueError("material is given without a diameter, on which its stiffness, damping and mass depend")
    return tether_of(table["material"], given.pop("diameter"), **given)
