"""Variables of an FMU and their places in the flat arrays of the kernels (`plan_layout.py`).

A record for a single tether or a system: the slave uses it, and the tables of native FMUs are generated from it.
References are value references; -1 is none.
"""

from dataclasses import fields
from itertools import accumulate
from typing import NamedTuple

from ..runtime import layout as at
from ..runtime import outputs
from ..runtime import plan_layout as plan
from ..runtime.enumerations import UNIFORM
from ..runtime.inputs import PLACES, components
from ..runtime.instance import RunningLine
from ..runtime.kernel_library import SYSTEM
from ..runtime.outputs import COUNTERS
from ..runtime.parameters import Ground, Tether, Winch
from ..runtime.quantities import doubts_in
from ..runtime.sheaves import SHEAVE_QUANTITIES
from ..runtime.variants import BY_NAME, Variant, library_of
from .portions import all_portions
from .selection import shown, with_starts
from .system_variables import (
    ENDS,
    OF_A_LINE,
    OF_PORTIONS,
    OF_SHEAVES,
    OF_THE_SYSTEM,
    SPEED,
    SUMMED,
    TURNED,
    input_name,
)
from .system_variables import table_of as table_of_system
from .variables import INPUT, INPUT_NAMES, PARAMETER, line_of_tether, table_of

IDLE_PROFILE = "wind_profile has no effect: the wind is that of wind_at"
IDLE_BREAKING = "breaking_force is {value:g} N and has no effect: this tether cannot break; the dynamic one can"
CONTROLS = {  # of lines at shared winches
    "reel_out_speed": at.WINCH_BY_SPEED,
    "winch_length": at.WINCH_BY_LENGTH,
    "winch_force": at.WINCH_BY_FORCE,
}
FORCES = ("ground_force", "kite_force", "force", "tension_from", "tension_to")  # smooth ones count in derivatives


class WiredLine(NamedTuple):
    """A line of the kernels, and the references of its numbers."""

    running: RunningLine
    quantities: list  # (name, reference, default) in the order of the kernel `pack`
    carried: tuple = (-1, -1)  # of the masses of free points at its start and end: one line carries them
    sheave: tuple = (0, -1, -1, -1, -1)  # `layout.IS_PORTION`, and references of the next numbers, -1 for the default


class Wiring(NamedTuple):
    """One FMU. Fields with a default are empty for a single tether, whose inputs and outputs are the kernel arrays."""

    name: str  # in saved states
    record: Variant | None  # of a tether alone, None for a system
    table: tuple  # of `variables.Variable`, of the full FMU
    shown: tuple  # the variables that this FMU has, in the order of its description
    ends: tuple  # number of inputs, of inputs and outputs, and of all values
    lines: tuple  # of `WiredLine`
    inputs: list  # (place, reference, line, place among its inputs); of a load: -1, place among the loads
    outputs: tuple = ()  # (reference, places): the sum of the numbers there
    motion: tuple = ()  # of free points: (reference, line, 1 at its end, component from 0 to 5)
    starts: tuple = ()  # (place in the plan, reference) of the starts of free points
    held: tuple = ()  # terms of inputs of lines on shared winches: like `inputs`, with a factor
    turned: tuple = ()  # terms of their outputs: (reference, place, factor, subtracted reference)
    checked: tuple = ()  # variables of parameters that the kernel `pack` does not check
    free: tuple = ()  # names of the free points
    band: int = 0  # of their matrix
    holders: tuple = ()  # rows (line, place in its parameters, number), see `holders_of`

    @property
    def is_direct(self):
        """Whether inputs and outputs of the FMU are the kernel arrays, as for a single tether."""
        return self.record is not None

    @property
    def running(self):
        """`instance.RunningLine` of each line, a tuple."""
        return tuple(line.running for line in self.lines)

    @property
    def library(self):
        """Name of the library of its kernels."""
        return library_of(self.name) if self.is_direct else SYSTEM

    @property
    def constants(self):
        """Triples (name, reference, value) of inputs and parameters that it omits."""
        known = {each.place for each in self.shown}
        return [(v.name, v.place, float(v.start)) for v in self.table if v.place not in known and v.start is not None]

    @property
    def doubtful(self):
        """Doubtful ranges of parameters: (reference, side, limit, sentence), see `quantities.doubts_in`."""
        fixed = [each for each in self.table if each.causality == PARAMETER]
        found = [(each.place, *row) for each in fixed for row in doubts_in(each.name, each.quantity)]
        own = {each.name: each.place for each in fixed}
        if self.lines[0].running.wind_points:
            found.append((own["wind_profile"], 1.0, UNIFORM, IDLE_PROFILE))
        if self.record and "breaking_force" in self.record.ignored:
            found.append((own["breaking_force"], 1.0, 0.0, IDLE_BREAKING))
        return found


def of_tether(variant, options):
    """`Wiring` of a tether alone with these build options, see `fmi.resources.DEFAULT_OPTIONS`."""
    table, shape_points, wind_points = table_of(variant, options), options["shape_points"], options.get("wind_points", 0)
    fixed = [each for each in table if each.causality == PARAMETER]
    quantities = [(each.name, each.place, 0.0) for each in fixed]
    given = at.inputs_size(wind_points)
    return Wiring(
        name=variant,
        record=BY_NAME[variant],
        table=table,
        shown=shown(table, frozenset(options.get("left_out", ()))),
        ends=(given, fixed[0].place, fixed[-1].place + 1),
        lines=(WiredLine(line_of_tether(shape_points, wind_points), quantities),),
        inputs=[(place, place, 0, place) for place in range(given)],
    )


def of_system(system, left_out=(), starts=()):
    """`Wiring` of a `system.System`: the value reference of a variable is its place in the table.

    left_out : names of variables that the FMU omits.  starts : pairs (name, start value) that replace values of the
    system.
    """
    table = with_starts(table_of_system(system), starts)
    own = {each.name: each.place for each in table}
    given, fixed = (sum(each.causality == kind for each in table) for kind in (INPUT, PARAMETER))
    return Wiring(
        name=system.hash,
        record=None,
        table=table,
        shown=shown(table, frozenset(left_out)),
        ends=(given, len(table) - fixed, len(table)),
        lines=tuple(
            WiredLine(
                running, _quantities_of(system, each, own), [own.get(f"{p}.mass", -1) for p in points], _sheave_of(each, own)
            )
            for running, each, points in zip(lines_of(system), all_portions(system.lines), carried(system), strict=True)
        ),
        inputs=[(place, own[name], *row) for place, name, *row in inputs_of(system) if name in own],
        outputs=tuple(_outputs_of(system, own)),
        motion=tuple(_motion_of(system, own)),
        held=tuple((place, own[name], *row) for place, name, *row in held_of(system)),
        turned=tuple(_turned_of(system, own)),
        starts=tuple(_starts_of(system, own)),
        checked=tuple(each for each in table[-fixed:] if _is_checked(each.name, system)),
        free=system.free,
        band=system.band,
        holders=holders_of(system),
    )


# --- of systems


def _is_checked(name, system):
    """Whether a parameter is one that the kernel `pack` does not check: of a free point, a sheave, or a start speed."""
    return name.partition(".")[0] in system.free_names or name.endswith(("]", f".{SPEED}"))


def lines_of(system):
    """`instance.RunningLine` of each line of a system, a tuple.

    A line that runs over sheaves is one for each of its portions.
    """
    number, drums = {name: k for k, name in enumerate(system.free)}, drums_of(system)
    return tuple(
        RunningLine(
            each.name,
            (*names_of_inputs(system, each), *each.wind_at_names(system.wind_points)),
            system.shape_points_of(each),
            system.wind_points,
            *(number.get(name, plan.DRIVEN) for name in (each.start, each.end)),
            each.is_through,
            each.is_portion,
            k in drums,
            words_of(system, each),
        )
        for k, each in enumerate(all_portions(system.lines))
    )


def names_of_inputs(system, portion):
    """Names of system inputs that are inputs of a line or a portion, by place, without wind points."""
    for name in INPUT_NAMES:
        yield (told_by(system, portion.line, name) if portion.number == 0 else None) or input_name(name, portion)


def words_of(system, portion):
    """Names in sentences on a tether and their names for a line or a portion: pairs, longer ones first."""
    words = {}
    for end, point in zip(ENDS, (portion.start, portion.end), strict=True):
        first = "initial_" if point in system.free_names else ""
        place = words[f"{end}_position"] = f"{point}.{first}position"
        words |= {f"{end}_velocity": f"{point}.{first}velocity", f"the {end} end": f"its end at {point}"}
    load = f"{portion.end}.load" if portion.end in system.free_names else "a load"
    words |= {"the kite_load": load, "kite_mass; in a system the mass of the point": f"{portion.end}.mass"}
    for winch in system.winches:
        if portion.line.name in winch.lines:
            for name in dict.fromkeys((winch.input, SPEED, *winch.drum_names)):
                words[name] = " and ".join(filter(None, (words.get(name), f"{winch.name}.{name}")))
    return ("kite_position (initial_kite_position of a free kite end)", place), *words.items()


def told_by(system, line, name):
    """Names of the inputs, and start speeds, of shared winches that determine an input of a line, "" if none does."""
    holding = (each for each in system.holding(line.name) if name in (each.input, SPEED))
    return " and ".join(f"{each.name}.{name}" for each in holding if system.carriers.get(each.name, line.name) == line.name)


def drums_of(system):
    """Lines that may carry a drum that is shared or used with sheaves: dict of the lines that it drives.

    Pairs of a line and its ratio; lines as numbers. A line without shared winch carries its own.
    """
    first = {each.line.name: k for k, each in enumerate(all_portions(system.lines)) if each.number == 0}
    by_force = [each for each in system.winches if each.name in system.carriers]
    found = {first[system.carriers[each.name]]: [(first[line], r) for line, r in each.ratios] for each in by_force}
    held = {line for each in system.winches for line in each.lines}
    if by_force or any(line.through for line in system.lines):
        found |= {k: [(k, 1.0)] for name, k in first.items() if name not in held}
    return found


def holders_of(system):
    """Numbers in the parameters of lines that specify the drums driving them: rows (line, place, number)."""
    found, counts = [], {}
    for carrier, held in drums_of(system).items():
        for line, ratio in held:
            i = counts[line] = counts.get(line, -1) + 1
            found += [(line, at.HELD_BY + i, carrier + 1.0), (line, at.HELD_RATIO + i, float(ratio))]
        if any(ratio < 0.0 for _, ratio in held):
            found.append((carrier, at.PULLS_BACK, 1.0))
    return tuple(found)


def carried(system):
    """For each line the names of the free points at its start and its end whose mass it carries, None for none.

    The first line at a point carries it.
    """
    free, found = set(system.free), []
    for line in all_portions(system.lines):
        own = [point if point in free else None for point in (line.start, line.end)]
        free -= set(own)
        found.append(own)
    return found


def _quantities_of(system, portion, places):
    """Quantities of a line or a portion; defaults where the system has no variable.

    The winch is on the first portion. places : references by name, as below.
    """
    found, line = [], portion.line
    held = system.holding(portion.name)  # by winches with the same control
    carried = (each for each in held if system.carriers.get(each.name) == portion.name)
    drum = {own: f"{each.name}.{own}" for each in carried for own in each.drum_names}
    for record in (Tether, *OF_THE_SYSTEM[:2], Winch, Ground):
        for item in fields(record):
            own = item.name if record in OF_THE_SYSTEM else f"{line.name}.{item.name}"
            own = "" if record is Winch and portion.number > 0 else drum.get(item.name, own)
            default = CONTROLS[held[0].input] if held and item.name == "winch_control" else item.default
            found.append((item.name, places.get(own, -1), default))
    return found


def _sheave_of(portion, places):
    """Row of a portion of a line over sheaves, and of the sheave at its end."""
    own = (f"{portion.line.name}.{name}[{portion.number + 1}]" for name in ("initial_portions", *SHEAVE_QUANTITIES))
    kind = 0 if not portion.is_portion else int(at.BEHIND_SHEAVE) if portion.number else 1
    return kind, *(places.get(name, -1) for name in own)


def inputs_of(system):
    """Rows (place, name, line, place among its inputs) of inputs; for a load -1 and its place among the loads.

    For free points, the motion is their start.  Inputs from shared winches are in `held_of`.
    """
    first, winches = 0, {each.name for each in system.winches}
    for k, line in enumerate(lines_of(system)):
        for own, name in enumerate(line.inputs):
            point, _, what = name.partition(".")
            if point not in winches and "]." not in name:  # a portion but the first one has no winch
                yield first + own, f"{point}.initial_{what}" if point in system.free_names else name, k, own
        first += len(line.inputs)
    loads = (name for point in system.free for name in components(f"{point}.load", 3))
    yield from ((first + own, name, -1, own) for own, name in enumerate(loads))


def held_of(system):
    """Terms of inputs of lines on shared winches, rows as in `inputs_of` with a factor.

    `winch_length` begins with the initial length.
    """
    first = 0
    for k, line in enumerate(lines_of(system)):
        for winch in system.holding(line.name):
            own = PLACES[winch.input]
            carrier = system.carriers.get(winch.name, "")
            if carrier not in ("", line.name):
                continue
            if winch.input == "winch_length" and winch is system.holding(line.name)[0]:
                yield first + own, f"{line.name}.initial_length", k, own, 1.0
            factor = 1.0 if carrier else float(winch.lines[line.name])
            for name in dict.fromkeys((winch.input, SPEED)):
                yield first + PLACES[name], f"{winch.name}.{name}", k, PLACES[name], factor
        first += len(line.inputs)


def _turned_of(system, places):
    """Terms of the outputs of shared winches."""
    firsts = accumulate((line.outputs_size for line in lines_of(system)), initial=0)
    firsts = dict(zip((each.name for each in all_portions(system.lines)), firsts, strict=False))
    for winch, shares in zip(system.winches, system.shares, strict=True):
        for own, (name, _) in TURNED.items():
            for line, share in shares:
                less = places[f"{line}.initial_length"] if name == "tether_length" else -1
                yield places[f"{winch.name}.{own}"], firsts[line] + outputs.PLACES[name], float(share), less


def _outputs_of(system, places):
    """Rows of outputs.

    The force on a point sums its lines in order, the start of each line before its end.
    """
    *firsts, _ = accumulate((line.outputs_size for line in lines_of(system)), initial=0)
    found = {}
    for each, first in zip(all_portions(system.lines), firsts, strict=True):
        line = each.line
        for end, point in each.ends:
            for i, name in enumerate(components(f"{point}.force", 3)):
                found.setdefault(name, []).append(first + outputs.PLACES[f"{end}_force"] + i)
        # a line over sheaves has them in its first portion, except its last tension
        for name, own in OF_A_LINE.items():
            if each.number == 0 or (name == "kite_tension" and not each.is_through):
                found[f"{line.name}.{own}"] = [first + outputs.PLACES[name]]
        shape_points = system.shape_points_of(line)
        for k in range(shape_points):
            for i in range(3):
                number = each.number * shape_points + k + 1
                found[f"{line.name}.shape[{number},{i + 1}]"] = [first + at.SHAPE + 3 * k + i]
        for i, name in enumerate((*OF_PORTIONS, *OF_SHEAVES) if each.is_portion else ()):
            found[f"{line.name}.{name}[{each.number + 1}]"] = [first + at.SHAPE + 3 * shape_points + i]
    for name in COUNTERS:
        every = [first + outputs.PLACES[name] for first in firsts]
        found[name] = every if name in SUMMED else every[:1]
    return ((places[name], those) for name, those in found.items() if name in places)


def _motion_of(system, places):
    """Rows of the motion of free points; of several lines at a point the last one counts."""
    found, free = {}, set(system.free)
    for k, line in enumerate(all_portions(system.lines)):
        for is_end, (_, point) in enumerate(line.ends):
            if point in free:
                names = (*components(f"{point}.position", 3), *components(f"{point}.velocity", 3))
                found |= {name: (places[name], k, is_end, component) for component, name in enumerate(names)}
    return found.values()


def _starts_of(system, places):
    """Rows of the starts of free points, of all ends of lines there."""
    for k, line in enumerate(all_portions(system.lines)):
        row = plan.PLAN_HEADER + plan.LINE_NUMBERS * k
        for place, name in ((plan.START_IS_SOUGHT, line.start), (plan.END_IS_SOUGHT, line.end)):
            if name in system.free_names:
                yield row + place, places[f"{name}.start"]
