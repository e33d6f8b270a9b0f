"""Files that users write in TOML: numbers with units, and one line for each mistake.

Scenes (`study.scenes.files`), maps of columns (`study.replay.columns`) and systems (`systems.files`) are read with it.
"""

import csv
import stat
import tomllib
from dataclasses import field, fields, make_dataclass
from pathlib import Path

from tetherfmu.naming import meant
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.parameters import GROUND_WITHOUT_GRAVITY, Ground
from tetherfmu.runtime.quantities import check, quantities

with Path(__file__).with_name("units.csv").open(encoding="utf-8", newline="") as _table:
    # what else a quantity may be given in than in its unit, and the factor to the unit
    UNITS = list(csv.DictReader(_table))
LARGEST_FILE = 1_000_000_000  # [B]


def without(prefix, record):
    """A record like another one, the names of whose quantities all begin with a prefix, without it."""
    copies = [(each, field(default=each.default, metadata=each.metadata)) for each in fields(record)]
    named = [(each.name.removeprefix(prefix), each.type, copy) for each, copy in copies]
    return make_dataclass(record.__name__, named, frozen=True, namespace={"__post_init__": check})


GROUND = "ground_"  # begins the names of the quantities of a `Ground`
TABLE_OF_GROUND = without(GROUND, Ground)


def contents_of(path):
    """Bytes of a regular file; ValueError for others, which may have no end, and for one that cannot be read."""
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            raise ValueError("cannot be read (it is no regular file)")
        if status.st_size > LARGEST_FILE:
            raise ValueError(f"cannot be read (it has more than {LARGEST_FILE / 1e9:g} GB)")
        with path.open("rb") as file:
            return file.read(status.st_size)  # a file without a known size has 0
    except OSError as error:
        raise ValueError(f"cannot be read ({error.strerror})") from None


def tables_of(path):
    """Tables of a TOML file, dict; ValueError without the name of the file says why it is none."""
    try:
        return tomllib.loads(contents_of(path).decode("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"is no TOML file ({error})") from None
    except RecursionError:
        raise ValueError("cannot be used (its tables or lists are nested too deeply)") from None


def vector_in(unit, limit):
    """Function that reads three numbers of this unit, or texts with units, none beyond a limit, from a value of a file."""

    def read_vector(value):
        if not isinstance(value, list) or len(value) != 3:
            raise ValueError(f"it must be three numbers [x, y, z] in {unit}")
        numbers = tuple(float(in_si(each, unit)) for each in value)
        if not all(abs(each) <= limit for each in numbers):  # NaN is not
            raise ValueError(f"each must be a finite number of at most {limit:g} {unit} in magnitude")
        return numbers

    return read_vector


def ground_of(table, environment):
    """The `Ground` of a table of a file; ValueError if it does not go with the environment."""
    ground = Ground(**{GROUND + name: value for name, value in vars(table).items()})
    if ground.ground_contact == at.FLAT and environment.gravity == 0.0:
        raise ValueError(GROUND_WITHOUT_GRAVITY.replace(GROUND, "ground."))
    return ground


def require(table, section, known, needed=()):
    """ValueError unless a table has what it needs and nothing unknown; needed, known : keys."""
    label = f"{section}." if section else ""
    if not isinstance(table, dict):
        raise ValueError(f"{section} is {table!r}; it must be a table [{section}]")
    for key in needed:
        if key not in table:
            raise ValueError(f"the key {label}{key} is missing")
    for key in table:
        if key not in known:
            raise ValueError(f"unknown key {label}{key}; known are {', '.join(known)}{meant(key, known)}")


def record(kind, table, section, needed=(), left_out=()):
    """A record from a table of a file; ValueError names the key. left_out : quantities that the file has not."""
    require(table, section, [item.name for item in fields(kind) if item.name not in left_out], needed)
    given = {key: value_of(kind, key, value, f"{section}.") for key, value in table.items()}
    try:
        return kind(**given)
    except ValueError as error:
        raise ValueError(f"{section}.{error}") from None


def value_of(kind, key, value, label):
    """A value of a field of a record in SI units; ValueError names it and says what is allowed.

    A field without a quantity has a function of its value in its metadata, `read`.
    """
    declared = dict(quantities(kind)).get(key)
    try:
        if declared is None:
            return kind.__dataclass_fields__[key].metadata["read"](value)
        is_named = isinstance(value, str) and value in declared.numbers
        number = declared.numbers[value] if is_named else in_si(value, declared.unit)
    except ValueError as error:
        more = f", {declared.range()}" if declared else ""
        raise ValueError(f"{label}{key} is {value!r}; {error}{more}") from None
    if not declared.allows(number):
        raise ValueError(f"{label}{key} is {value!r}; it must be {declared.range()}")
    return number


def factors(unit):
    """Units in which a quantity may be given, and their factors to its unit."""
    return {unit: 1.0} | {each["spelled"]: float(each["factor"]) for each in UNITS if each["unit"] == unit}


def spellings(unit):
    """Units in which a quantity may be given, in words."""
    return ", ".join(each or "no unit" for each in factors(unit))


def in_si(value, unit):
    """A number, or a text like "4 mm", as a number in the unit of its quantity; ValueError says what is allowed."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"it must be a number, or a text with a unit ({spellings(unit)})")
    if not isinstance(value, str):
        return value
    amount, _, spelled = value.strip().partition(" ")
    try:
        return float(amount) * factors(unit)[spelled.strip()]
    except (ValueError, KeyError):
        raise ValueError(f"it must be a number with one of the units {spellings(unit)}") from None
