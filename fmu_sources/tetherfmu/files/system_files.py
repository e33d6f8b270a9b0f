"""Systems as files: points, lines and what surrounds them, in TOML with numbers and units as in scene files."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from tetherfmu.records.materials import tether_of
from tetherfmu.records.systems import checked
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import INPUT_TABLE
from tetherfmu.runtime.naming import prefixed
from tetherfmu.runtime.outputs import OUTPUT_TABLE
from tetherfmu.runtime.parameters import Environment, FreeKite, Ground, Solver, Tether, Winch
from tetherfmu.runtime.quantities import quantities, quantity
from tetherfmu.wiring.lines import Line, Point, checked_name
from tetherfmu.wiring.system import System
from tetherfmu.wiring.winches import OF_A_DRUM, SharedWinch

from . import lean
from .lean import Lean
from .toml_files import TABLE_OF_GROUND, ground_of, in_si, keys_of, record, require, tables_of, value_of, vector_in

TABLES = ("points", "lines", "winches", "environment", "ground", "solver", "build")
OF_THE_FLIGHT = ("duration", "wind", "loads", "series", "wanted")  # keys that say how it is flown; its FMU has none of that
# names of variables and of the terminal that the whole system has, which no point and no line can have
TAKEN = {"time", "wind", *(each.name for each in (*INPUT_TABLE, *OUTPUT_TABLE))} | {
    name for kind in (Environment, Solver, Ground) for name, _ in quantities(kind)
}


@dataclass(frozen=True)
class TableOfPoint:
    """What a file says of a point."""

    position: tuple | None = field(default=None, metadata={"read": vector_in("m", at.LARGEST_INPUT)})
    velocity: tuple = field(default=(0.0, 0.0, 0.0), metadata={"read": vector_in("m/s", at.LARGEST_INPUT)})
    mass: float | None = field(default=None, metadata={"quantity": dict(quantities(FreeKite))["kite_mass"]})


@dataclass(frozen=True)
class TableOfLine(Winch, Tether):
    """What a file says of a line, beside its points and its material."""

    reel_out_speed: float = quantity(0.0, "m/s", "at the start; positive pays out", -at.LARGEST_INPUT, at.LARGEST_INPUT)


def names_in(value):
    """Names of points from a list in a file."""
    if not isinstance(value, list) or not value or not all(isinstance(each, str) for each in value):
        raise ValueError('it must be a list of names of points, as ["block"]')
    return tuple(value)


def numbers_of(unit):
    """Function that reads a number of this unit, or a text with a unit, or a list of them, from a value of a file."""

    def read_numbers(value):
        if isinstance(value, list):
            return tuple(in_si(each, unit) for each in value)
        return in_si(value, unit)

    return read_numbers


def list_of(unit):
    """The same for a list only."""

    def read_list(value):
        if not isinstance(value, list):
            raise ValueError(f"it must be a list of numbers in {unit}")
        return numbers_of(unit)(value)

    return read_list


@dataclass(frozen=True)
class TableOfSheaves:
    """What a file says of a line that runs over sheaves, beside what it says of any line; `Line` has the defaults."""

    through: tuple = field(default=(), metadata={"read": names_in})
    initial_portions: tuple | None = field(default=None, metadata={"read": list_of("m")})
    sheave_mass: tuple | float = field(default=0.0, metadata={"read": numbers_of("kg")})
    sheave_friction: tuple | float = field(default=0.0, metadata={"read": numbers_of("")})
    sheave_efficiency: tuple | float = field(default=1.0, metadata={"read": numbers_of("")})


@dataclass(frozen=True)
class TableOfWinch(Winch):
    """What a file says of a winch that holds several lines, beside these and its control."""

    reel_out_speed: float = quantity(0.0, "m/s", "at the start; positive pays out", -at.LARGEST_INPUT, at.LARGEST_INPUT)
    winch_force: float = quantity(0.0, "N", "at the start; positive reels in", -at.LARGEST_INPUT, at.LARGEST_INPUT)


NUMBERS_OF_A_WINCH = ("reel_out_speed", "winch_force", *OF_A_DRUM)
OF_A_LINE = ("from", "to", "material", *keys_of(TableOfLine), *keys_of(TableOfSheaves))


@dataclass(frozen=True)
class SystemFile(System):
    """What a file says of a system: a `System`, and what its FMU is built with."""

    build: Lean = field(default_factory=Lean)


def load(path: str | Path) -> SystemFile:
    """`SystemFile` of a file; ValueError says in one line what is wrong: file, key, value and what is allowed."""
    path = Path(path)
    with prefixed(f"{path}: "):
        return read(tables_of(path), path.stem)


def read(table, name):
    """`SystemFile` from the table of a file; ValueError names the key. name : of the system, if the table has none."""
    if "flight" in table:
        raise ValueError("describes a scene, no system of tethers; tetherfmu fly, advise, sweep and build --scene take it")
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
    return checked(SystemFile(name, points, lines, environment, solver, ground, winches, build=build))


def named(tables, section):
    """Pairs (name, table) of points, lines or winches; ValueError for a name that is taken."""
    if not isinstance(tables, dict):
        raise ValueError(f"{section} is {tables!r}; it must have tables [{section}.NAME]")
    for name in tables:
        if name in TAKEN:
            raise ValueError(f"{section}.{name}: the whole system has something called {name}; choose another name")
    return tables.items()


def point_of(name, table):
    """`Point` of a table of a file; ValueError names the key."""
    section = f"points.{name}"
    given = vars(record(TableOfPoint, table, section))
    if "position" not in table and "mass" not in table:
        raise ValueError(f"the key {section}.position is missing; only a free point, which has a mass, goes without")
    return Point(name, **given)


def line_of(name, table):
    """`Line` of a table of a file; ValueError names the key."""
    section = f"lines.{name}"
    require(table, section, OF_A_LINE, ("from", "to", "initial_length"))
    for end in ("from", "to"):
        if not isinstance(table[end], str):
            raise ValueError(f"{section}.{end} is {table[end]!r}; it must be the name of a point")
    of_sheaves = {
        key: value_of(TableOfSheaves, key, table[key], f"{section}.") for key in keys_of(TableOfSheaves) if key in table
    }
    others = {key: value for key, value in table.items() if key not in ("from", "to", "material", *of_sheaves)}
    given = {key: value_of(TableOfLine, key, value, f"{section}.") for key, value in others.items()}
    speed = given.pop("reel_out_speed", 0.0)
    of_winch = {key: given.pop(key) for key, _ in quantities(Winch) if key in given}
    with prefixed(f"{section}."):
        winch, tether = Winch(**of_winch), tether_in(table, given)
    return Line(name, table["from"], table["to"], tether, speed, winch, **of_sheaves)


def winch_of(name, table):
    """`SharedWinch` of a table of a file; ValueError names the key."""
    section = f"winches.{name}"
    checked_name("winch", name)
    require(table, section, ("lines", "control", *NUMBERS_OF_A_WINCH), ("lines",))
    given = {key: table[key] for key in ("lines", "control") if key in table}
    given |= {key: value_of(TableOfWinch, key, table[key], f"{section}.") for key in NUMBERS_OF_A_WINCH if key in table}
    with prefixed("winches."):
        return SharedWinch(name, **given)


def tether_in(table, given):
    """`Tether` with the quantities that are given, of the material in a table of a file; ValueError names the key."""
    if "material" not in table:
        return Tether(**given)
    if "diameter" not in given:
        raise ValueError("material is given without a diameter, on which its stiffness, damping and mass depend")
    return tether_of(table["material"], given.pop("diameter"), **given)
