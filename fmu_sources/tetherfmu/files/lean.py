"""Lean FMUs: selection of the variables of an FMU, by name, group or preset, and its start values.

Omitted variables are constant. `wiring/selection.py` has the part that runs in the FMU.
"""

from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from warnings import warn

from tetherfmu.runtime.naming import meant_or_all, prefixed
from tetherfmu.runtime.parameters import SCALED
from tetherfmu.runtime.quantities import NOT_WHOLE, checked
from tetherfmu.wiring.selection import GROUPS, own_name
from tetherfmu.wiring.variables import CALCULATED, INPUT, PARAMETER

from .toml_files import in_si, require

LISTS = {"inputs": (INPUT,), "outputs": CALCULATED, "parameters": (PARAMETER,)}
KEYS = ("preset", *LISTS, "set")  # of a table [build] of a file
NONE = "none"

TRUTHS = {"true": 1.0, "false": 0.0, True: 1.0, False: 0.0}  # permitted values of a Boolean, as a number


@dataclass(frozen=True)
class Lean:
    """Contents of a lean FMU.

    inputs, outputs, parameters : names of variables without the index of an element, names for all points and lines of a
    system without their prefix, groups (`selection.GROUPS`), or patterns with * and ?; None for those of the preset.
    starts : pairs (name of an input or a parameter, start value): a number, a text with a unit, the name of a choice, or
    three for a vector.  preset : of `PRESETS`; None for all variables.
    """

    inputs: tuple | None = None
    outputs: tuple | None = None
    parameters: tuple | None = None
    starts: tuple = ()
    preset: str | None = None

    def __post_init__(self):
        if self.preset not in (None, *PRESETS):
            hint = meant_or_all(str(self.preset), PRESETS, "it must be one of {}")
            raise ValueError(f"preset is {self.preset!r}{hint}")

    def __bool__(self):
        """Whether anything is chosen."""
        return self != Lean()

    def over(self, other: "Lean") -> "Lean":
        """This choice, completed by another one; the start values of both."""
        mine = {key: getattr(self, key) for key in (*LISTS, "preset") if getattr(self, key) is not None}
        return replace(other, starts=(*other.starts, *self.starts), **mine)

    def left_out(self, table: Sequence) -> tuple:
        """Names of the variables of a table that the FMU omits; ValueError names an unknown variable."""
        found = []
        for key, causalities in LISTS.items():
            wanted, listed = getattr(self, key), [each for each in table if each.causality in causalities]
            if wanted is None and self.preset is None:
                continue
            if wanted is None:
                kept = {each.name for each in listed if own_name(each.name) in PRESETS[self.preset][key]}
            else:
                kept = {name for text in wanted for name in matches(key, text, listed)}
            found += [each.name for each in listed if each.name not in kept]
        if len(found) == len(table):
            raise ValueError("an FMU needs inputs, outputs or parameters: name at least one of them")
        return tuple(found)

    def listed(self, table: Sequence) -> list:
        """Lines for people on the variables of a table that the FMU has: inputs, outputs, parameters, with unit and start.

        Errors as of `left_out` and `start_values`.
        """
        without, starts = set(self.left_out(table)), dict(self.start_values(table))
        lines = []
        for key, causalities in LISTS.items():
            kept = [each for each in table if each.causality in causalities and each.name not in without]
            vectors = dict.fromkeys(each.name.partition("[")[0] for each in kept)
            lines.append(f"{key}: {len(vectors)}, {len(kept)} with the elements of vectors" if kept else f"{key}: none")
            for name in vectors:
                own = [each for each in kept if each.name.partition("[")[0] == name]
                lines.append(f"  {in_words(name, own, starts)}")
        return lines

    def start_values(self, table: Iterable) -> tuple:
        """Pairs (name, number) of the start values in SI units; ValueError names an invalid one.

        A diameter alone scales stiffness and damping, as everywhere, with a warning.
        """
        given = {each.name: each for each in table if each.causality in (INPUT, PARAMETER)}
        found = {}
        for name, value in self.starts:
            found |= _starts_of(name, value, given)
        for name in [each for each in found if own_name(each) == "diameter"]:
            grown = scaled(found, {each: variable.start for each, variable in given.items()}, name.removesuffix("diameter"))
            if grown:
                values = " and ".join(f"{each} = {number:.4g} {given[each].quantity.unit}" for each, number in grown.items())
                warn(
                    f"{name} = {found[name]:g} m scales stiffness and damping: {values}; set them to change this",
                    stacklevel=3,
                )
            found |= grown
        return tuple(found.items())


def in_words(name, elements, starts):
    """Name of a variable or a vector, its start value and unit, and its meaning; starts : other start values, dict."""
    declared, values = elements[0].quantity, [starts.get(each.name, each.start) for each in elements]
    choices = {number: choice for choice, number in declared.numbers.items()} if declared.choices else {}
    texts = [str(choices.get(each, f"{each:g}")) for each in values if each is not None]
    start = f" = {', '.join(texts)}" if texts else ""
    unit = f" [{declared.unit}]" if declared.unit else ""
    meaning = declared.meaning.removesuffix(", x") if len(elements) > 1 else declared.meaning
    return f"{name}{start}{unit}: {meaning}"


def scaled(given, starts, line=""):
    """Stiffness and damping scaled by a diameter alone, dict by name, from the start values (dict) of an FMU.

    given : values of parameters by name, with the diameter.  line : prefix of the names of a line in a system.
    """
    area = (given[f"{line}diameter"] / float(starts[f"{line}diameter"])) ** 2
    names = [line + each for each in SCALED]
    return {name: area * float(starts[name]) for name in names if name in starts and name not in given}


_ENDS = ("kite_position", "kite_velocity", "ground_position", "ground_velocity")
_OF_POINTS = ("position", "velocity", "load")  # in a system
_ROPE = ("initial_length", "diameter", "density", "axial_stiffness", "axial_damping", "segments")
_AIR = ("drag_coefficient", "wind_profile", "wind_exponent", "wind_reference_height")
_FORCES = ("ground_force", "kite_force", "ground_tension", "kite_tension", "force", "tension_from", "tension_to")
_LENGTHS = ("tether_length", "winch_speed", "payout", "kite_position", "kite_velocity", "position", "velocity")
_WINCH_INPUTS = ("reel_out_speed", "winch_force", "winch_length")
_WINCH = ("winch_control", "winch_start", "winch_mass", "winch_damping", "winch_friction")
_START = ("initial_kite_position", "initial_position", "kite_start", "start")
PRESETS = {  # variables for a kind of scene, if the FMU has them
    "kite": {
        "inputs": ("kite_position", "kite_velocity", "kite_load", *_WINCH_INPUTS, "wind_velocity", *_OF_POINTS),
        "outputs": (*_FORCES, "peak_tension", *_LENGTHS),
        "parameters": (*_ROPE, *_AIR, "kite_mass", "mass", *_START, *_WINCH),
    },
    "crane": {
        "inputs": ("ground_position", "ground_velocity", "kite_load", *_WINCH_INPUTS, *_OF_POINTS),
        "outputs": (*_FORCES, "peak_tension", *_LENGTHS),
        "parameters": (*_ROPE, "kite_mass", "mass", *_START, *_WINCH),
    },
    "drone": {
        "inputs": (*_ENDS, "kite_load", *_WINCH_INPUTS, "wind_velocity", *_OF_POINTS),
        "outputs": (*_FORCES, *_LENGTHS, "grounded_length"),
        "parameters": (
            *_ROPE,
            "drag_coefficient",
            "kite_mass",
            "mass",
            *_START,
            "winch_control",
            "ground_contact",
            "ground_height",
        ),
    },
}


def matches(key, text, listed):
    """Names in a list that a text matches: a group, a name, or a pattern; ValueError if there are none.

    key : of `LISTS`, for the message.
    """
    if text == NONE:
        return []
    vectors = {each.name: each.name.partition("[")[0] for each in listed}
    if text in vectors and "[" in text:
        raise ValueError(f"{key}: {text} is an element of {vectors[text]}; name the whole vector")
    names = [name for name, vector in vectors.items() if fnmatchcase(vector, text) or own_name(name) == text]
    names = names or [each.name for each in listed if each.group == text]
    if not names and text not in GROUPS:
        known = dict.fromkeys([*vectors.values(), *GROUPS])
        raise ValueError(f"{key}: this FMU has no {text!r} among its {key}{meant_or_all(text, known)}")
    return names


def _starts_of(name, value, given):
    """Dict from the names of a start value to its numbers: one, or the components of a vector."""
    elements = [each for each in given if each.partition("[")[0] == name] if name not in given else [name]
    if not elements:
        known = dict.fromkeys(each.partition("[")[0] for each in given)
        raise ValueError(f"there is no input or parameter {name!r} to set{meant_or_all(name, known)}")
    values = value if isinstance(value, list | tuple) else str(value).split(",") if len(elements) > 1 else [value]
    if len(values) != len(elements):
        raise ValueError(f"{name} is {value!r}; it must be {len(elements)} numbers")
    return {each: _number(given[each], one) for each, one in zip(elements, values, strict=True)}


def _number(variable, value):
    """A start value of a variable as a number; ValueError if it is not allowed."""
    declared, name = variable.quantity, variable.name
    if variable.kind == "Boolean":
        if value not in TRUTHS:
            raise ValueError(f"{name} is {value!r}; it must be true or false")
        return TRUTHS[value]
    if isinstance(value, str):
        value = value.strip()
        with suppress(ValueError):
            value = float(value)
    try:
        number = declared.numbers[value] if value in declared.numbers else in_si(value, declared.unit)
    except ValueError as error:
        raise ValueError(f"{name} is {value!r}; {error}, {declared.range()}") from None
    if variable.kind == "Real":
        return float(checked(name, number, declared))
    if not float(number).is_integer():
        raise ValueError(NOT_WHOLE.format(name=name, value=number))
    return checked(name, int(number), declared)


# --- user input


def read(table):
    """`Lean` of a table [build] of a file; ValueError names the key."""
    require(table, "build", KEYS)
    for key in (each for each in LISTS if each in table):
        if not isinstance(table[key], list) or not all(isinstance(each, str) for each in table[key]):
            raise ValueError(f"build.{key} is {table[key]!r}; it must be a list of names")
    starts = table.get("set", {})
    if not isinstance(starts, dict):
        raise ValueError(f"build.set is {starts!r}; it must be a table [build.set] of start values")
    lists = {key: tuple(table[key]) for key in LISTS if key in table}
    with prefixed("build."):
        return Lean(**lists, starts=tuple(starts.items()), preset=table.get("preset"))
