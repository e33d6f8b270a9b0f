"""Files that users write in TOML: numbers with units, and one line for each mistake.

Scenes (`files.scene_files`), maps of columns (`study.replay.columns`) and systems (`files.system_files`) are read with it.
"""

import csv
import re
import stat
import tomllib
from dataclasses import field, fields, make_dataclass
from itertools import combinations
from pathlib import Path

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.naming import LONGEST_NAME, meant, meant_or_all, prefixed, shortened
from tetherfmu.runtime.parameters import GROUND_WITHOUT_GRAVITY, Ground
from tetherfmu.runtime.quantities import can_be_given, check

with Path(__file__).with_name("units.csv").open(encoding="utf-8", newline="") as _table:
    # alternative units of a quantity, and the factor to its unit
    UNITS = list(csv.DictReader(_table))
NAME_OF_FILE = re.compile(r'[^\x00-\x1f\\/:*?"<>|]+')  # on all platforms
LARGEST_FILE = 1_000_000_000  # [B]


class WrongUse(ValueError):
    """Invalid input from the command line or a file; the message is one line with the reason and the permitted values."""


def without(prefix, record):
    """A record without the common prefix of its quantity names."""
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
            raise ValueError("cannot be read (it is not a regular file)")
        if status.st_size > LARGEST_FILE:
            raise ValueError(f"cannot be read (it has more than {LARGEST_FILE / 1e9:g} GB)")
        with path.open("rb") as file:
            return file.read(status.st_size)  # a file without a known size has 0
    except OSError as error:
        raise ValueError(f"cannot be read ({error.strerror})") from None


def tables_of(path):
    """Tables of a TOML file, dict; ValueError describes a problem without the file name."""
    try:
        return tomllib.loads(contents_of(path).decode("utf-8-sig"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"is not a TOML file ({error})") from None
    except RecursionError:
        raise ValueError("cannot be used (its tables or lists are nested too deeply)") from None


def name_in(table, name):
    """The name in a table of a file, used for file names, or else `name`; ValueError if it is invalid."""
    name = table.get("name", name)
    if not isinstance(name, str) or not 0 < len(name) <= LONGEST_NAME or not NAME_OF_FILE.fullmatch(name):
        raise ValueError(
            f"name is {shortened(name)}; files are named by it: it must be a text of 1 to {LONGEST_NAME} characters, "
            'none of them one of \\ / : * ? " < > |'
        )
    return name


def vector(value, unit, limit=at.LARGEST_INPUT):
    """Three numbers of this unit, or texts with units, within a limit, from a value of a file."""
    if not isinstance(value, list) or len(value) != 3:
        raise ValueError(f"it must be three numbers [x, y, z] in {unit}")
    found = tuple(float(in_si(each, unit)) for each in value)
    if not all(abs(each) <= limit for each in found):  # NaN is not
        raise ValueError(f"each must be a finite number of at most {limit:g} {unit} in magnitude")
    return found


def numbers(value, unit):
    """A number of this unit, or a text with a unit, or a tuple of them from a list, from a value of a file."""
    return tuple(in_si(each, unit) for each in value) if isinstance(value, list) else in_si(value, unit)


def listed(value, unit):
    """`numbers` of a list only."""
    if not isinstance(value, list):
        raise ValueError(f"it must be a list of numbers in {unit}")
    return numbers(value, unit)


def names(value, _unit):
    """Names of points from a list in a file."""
    if not isinstance(value, list) or not value or not all(isinstance(each, str) for each in value):
        raise ValueError('it must be a list of names of points, as ["block"]')
    return tuple(value)


FORMS = {"vector": vector, "numbers": numbers, "list": listed, "names": names}  # of `wiring.lines.given_in`


def ground_of(table, environment):
    """The `Ground` of a table of a file; ValueError if it does not go with the environment."""
    ground = Ground(**{GROUND + name: value for name, value in vars(table).items()})
    if ground.ground_contact == at.FLAT and environment.gravity == 0.0:
        raise ValueError(GROUND_WITHOUT_GRAVITY.replace(GROUND, "ground."))
    return ground


def require(table, section, known, needed=()):
    """ValueError unless a table has its required keys and no unknown ones; needed, known : keys."""
    label = f"{section}." if section else ""
    if not isinstance(table, dict):
        raise ValueError(f"{section} is {table!r}; it must be a table [{section}]")
    for key in table:
        if key not in known:
            raise ValueError(f"unknown key {label}{key}{meant_or_all(key, known, 'known are {}')}")
    for key in needed:
        if key not in table:
            raise ValueError(f"the key {label}{key} is missing")


def keys_of(kind):
    """Keys that a table of a record may have."""
    return [*(item.name for item in fields(kind)), *getattr(kind, "instead", ())]


def record(kind, table, section, needed=(), left_out=()):
    """A record from a table of a file; ValueError names the key. left_out : quantities that the file has not."""
    require(table, section, [name for name in keys_of(kind) if name not in left_out], needed)
    given = {key: value_of(kind, key, value, f"{section}.") for key, value in table.items()}
    with prefixed(f"{section}."):
        return kind(**given)


def value_of(kind, key, value, label):
    """A value of a field of a record in SI units; ValueError names it and the permitted values.

    A field without a quantity has a form in its metadata, or a function of its value, `read`.
    """
    declared = dict(can_be_given(kind)).get(key)
    try:
        if declared is None:
            facts = kind.__dataclass_fields__[key].metadata
            return facts["read"](value) if "read" in facts else FORMS[facts["form"]](value, facts["unit"])
        is_named = isinstance(value, str) and value in declared.numbers
        number = declared.numbers[value] if is_named else in_si(value, declared.unit)
    except ValueError as error:
        if declared and declared.choices:
            raise ValueError(
                f"{label}{key} is {value!r}; it must be {declared.range()}{meant(str(value), declared.numbers)}"
            ) from None
        more = f", {declared.range()}" if declared else ""
        raise ValueError(f"{label}{key} is {value!r}; {error}{more}") from None
    if not declared.allows(number):
        raise ValueError(f"{label}{key} is {value!r}; it must be {declared.range()}{unit_meant(value, declared)}")
    return number


def unit_meant(value, declared):
    """Text that suggests a smaller unit for a number that is too large, such as deg; "" if none fits."""
    no_part = declared.unit == "" and declared.maximum > 1.0  # of something, as percents are
    if isinstance(value, str) or declared.choices or abs(value) <= declared.maximum or no_part:
        return ""
    smaller = (each for each, factor in factors(declared.unit).items() if factor < 1.0 and declared.allows(factor * value))
    unit = next(smaller, "")
    return f'; did you mean "{value:g} {unit}"?' if unit else ""


def check_once(names, key_of=str, made_of=None):
    """ValueError if two names set the same value: by one key, or one names a vector and the other an element of it.

    key_of : function of a name to its key.  made_of : dict of a key to the vector whose first two numbers it changes.
    """
    for first, second in combinations(names, 2):
        keys = key_of(first), key_of(second)
        for one, other in (keys, keys[::-1]):
            vector = (made_of or {}).get(one)
            if one == other or other.startswith(f"{one}[") or (vector and other in (vector, f"{vector}[1]", f"{vector}[2]")):
                twice = f"{first} is" if first == second else f"{first} and {second} are the same value,"
                raise ValueError(f"{twice} given twice; give one of them")


def factors(unit):
    """Permitted units of a quantity, and their factors to its unit."""
    return {unit: 1.0} | {each["spelled"]: float(each["factor"]) for each in UNITS if each["unit"] == unit}


def spellings(unit):
    """Permitted units of a quantity, in words."""
    return ", ".join(each or "no unit" for each in factors(unit))


def in_si(value, unit):
    """A number, or a text like "4 mm", as a number in the unit of its quantity; ValueError names the permitted units."""
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        raise ValueError(f"it must be a number, or a text with a unit ({spellings(unit)})")
    if not isinstance(value, str):
        return value
    amount, _, spelled = value.strip().partition(" ")
    try:
        return float(amount) * factors(unit)[spelled.strip()]
    except (ValueError, KeyError):
        raise ValueError(f"it must be a number with one of the units {spellings(unit)}") from None
