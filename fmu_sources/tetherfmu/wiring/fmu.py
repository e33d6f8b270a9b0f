"""What an FMU is, and where its variables stand in the flat arrays of the kernels (`plan_layout.py`).

A record for a tether alone and for a system of them: the slave runs with it, the tables of native FMUs are made of it.
References are value references; -1 is none.
"""

from dataclasses import fields
from itertools import accumulate
from typing import NamedTuple

from ..runtime import layout as at
from ..runtime import outputs
from ..runtime import plan_layout as plan
from ..runtime.enumerations import UNIFORM
from ..runtime.inputs import PLACES, WIND_AT, components
from ..runtime.instance import Line
from ..runtime.kernel_library import SYSTEM
from ..runtime.outputs import COUNTERS
from ..runtime.parameters import Ground, Tether, Winch
from ..runtime.quantities import doubts_in
from ..runtime.sheaves import SHEAVE_QUANTITIES
from ..runtime.variants import BY_NAME, Variant, library_of
from .portions import all_portions, portions_of
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
    outputs_of_portions,
    table_of,
)
from .variables import INPUT, INPUT_NAMES, PARAMETER, line_of_tether, parameters_at, references, wind_points_in

IDLE_PROFILE = "wind_profile has no effect: the wind is that of wind_at"
IDLE_BREAKING = "breaking_force is {value:g} N and has no effect: this tether cannot break; the dynamic one can"
CONTROLS = {  # of lines at shared winches
    "reel_out_speed": at.WINCH_BY_SPEED,
    "winch_length": at.WINCH_BY_LENGTH,
    "winch_force": at.WINCH_BY_FORCE,
}
FORCES = ("force", "tension_from", "tension_to")  # of a system: on driven points, and of lines at their ends


class Wiring(NamedTuple):
    """One FMU. What has a default is empty for a tether alone, whose inputs and outputs are the arrays of the kernels."""

    name: str  # in saved states
    library: str  # of its kernels
    record: Variant | None  # of a tether alone, None for a system
    table: tuple  # of `variables.Variable`, of the full FMU
    references: list  # of the table
    shown: tuple  # the variables that this FMU has, in the order of its description
    shown_at: list  # their references
    constants: list  # (name, reference, value) of inputs and parameters that it goes without
    ends: tuple  # number of inputs, of inputs and outputs, and of all values
    lines: tuple  # `instance.Line` of each
    quantities: list  # of each line: (name, reference, default) in the order of the kernel `pack`
    doubtful: list  # (reference, side, limit, sentence) of parameters, see `quantities.doubts_in`
    slack_segments: list  # references, of each line
    forces: list  # references of the forces whose smoothness counts in directional derivatives
    sizes: dict  # dimensions of the arrays of FMI 3 that are no vectors, by name
    inputs: list  # (place, reference, line, place among its inputs); of a load: -1, place among the loads
    carried: list  # of each line the references of the masses of free points at its start and end: one line carries them
    outputs: tuple = ()  # (reference, places): the sum of the numbers there
    motion: tuple = ()  # of free points: (reference, line, 1 at its end, component from 0 to 5)
    starts: tuple = ()  # (place in the plan, reference) of the starts of free points
    held: tuple = ()  # terms of inputs of lines that shared winches hold: as those of `inputs`, with a factor
    turned: tuple = ()  # terms of their outputs: (reference, place, factor, reference of what is subtracted)
    checked: tuple = ()  # variables of parameters that the kernel `pack` does not check
    free: tuple = ()  # names of the free points
    band: int = 0  # of their matrix
    holders: tuple = ()  # rows (line, place in its parameters, number), see `holders_of`
    sheaves: tuple = ()  # of each line `layout.IS_PORTION`, and of the numbers behind it the references, -1 for the default


def of_tether(variant, table, shape_points, left_out=()):
    """`Wiring` of a tether alone with a table of `variables`; left_out : names of those that the FMU goes without."""
    points = wind_points_in(table)
    given, first = at.inputs_size(points), parameters_at(shape_points, points)
    listed = [each for each in table if each.causality == PARAMETER]
    own = {each.name: first + each.place for each in listed}
    at_value = references(table, shape_points)
    return Wiring(
        name=variant,
        library=library_of(variant),
        record=BY_NAME[variant],
        table=table,
        references=at_value,
        **_selection(table, at_value, left_out),
        ends=(given, first, first + len(listed)),
        lines=(line_of_tether(shape_points, points),),
        quantities=[[(each.name, own[each.name], 0.0) for each in listed]],
        doubtful=_doubtful([(own[each.name], each) for each in listed], points, BY_NAME[variant].ignored),
        slack_segments=[given + at.SLACK_SEGMENTS],
        forces=[given + place + i for place in (at.GROUND_FORCE, at.KITE_FORCE) for i in range(3)],
        sizes={"shape": (shape_points, 3), WIND_AT.name: (points, 3)},
        inputs=[(place, place, 0, place) for place in range(given)],
        carried=[(-1, -1)],
    )


def of_system(system, left_out=(), starts=()):
    """`Wiring` of a `system.System`: the value reference of a variable is its place in the table.

    left_out : as in `of_tether`.  starts : pairs (name, start value) that replace those of the system.
    """
    table = with_starts(table_of(system), starts)
    own = {each.name: each.place for each in table}
    given, fixed = (sum(each.causality == kind for each in table) for kind in (INPUT, PARAMETER))
    sizes = {f"{line.name}.shape": (system.shape_points_of(line) * len(portions_of(line)), 3) for line in system.lines}
    for line in (line for line in system.lines if line.through):
        sizes |= {f"{line.name}.{name}": (count,) for name, *_, count in outputs_of_portions(line)}
        sizes |= {f"{line.name}.{name}": (len(line.through),) for name in SHEAVE_QUANTITIES}
        sizes[f"{line.name}.initial_portions"] = (len(line.through) + 1,)
    sizes |= {f"{line.name}.{WIND_AT.name}": (len(portions_of(line)) * system.wind_points, 3) for line in system.lines}
    return Wiring(
        name=system.hash,
        library=SYSTEM,
        record=None,
        table=table,
        references=[each.place for each in table],
        **_selection(table, [each.place for each in table], left_out),
        ends=(given, len(table) - fixed, len(table)),
        lines=lines_of(system),
        quantities=[_quantities_of(system, each, own) for each in all_portions(system.lines)],
        doubtful=_doubtful([(each.place, each) for each in table[-fixed:]], bool(system.wind_points)),
        slack_segments=[own[f"{each.line.name}.slack_segments"] for each in all_portions(system.lines)],
        forces=[each.place for each in table if each.name.rpartition(".")[2].partition("[")[0] in FORCES],
        sizes=sizes,
        inputs=[(place, own[name], *row) for place, name, *row in inputs_of(system) if name in own],
        carried=[[own[f"{point}.mass"] if point else -1 for point in points] for points in carried(system)],
        outputs=tuple(_outputs_of(system, own)),
        motion=tuple(_motion_of(system, own)),
        held=tuple((place, own[name], *row) for place, name, *row in held_of(system)),
        turned=tuple(_turned_of(system, own)),
        starts=tuple(_starts_of(system, own)),
        checked=tuple(each for each in table[-fixed:] if _is_checked(each.name, system)),
        free=system.free,
        band=system.band,
        holders=holders_of(system),
        sheaves=tuple(_sheaves_of(system, own)),
    )


def _doubtful(listed, has_wind_points, ignored=()):
    """What is doubtful of parameters, a list as in `Wiring`; listed : pairs (reference, variable); ignored : names."""
    found = [(place, *row) for place, each in listed for row in doubts_in(each.name, each.quantity)]
    if has_wind_points:
        found += [(place, 1.0, UNIFORM, IDLE_PROFILE) for place, each in listed if each.name == "wind_profile"]
    if "breaking_force" in ignored:
        found += [(place, 1.0, 0.0, IDLE_BREAKING) for place, each in listed if each.name == "breaking_force"]
    return found


def _selection(table, references, left_out):
    """What a `Wiring` says of the variables that its FMU has, and of those that it goes without."""
    found = dict(zip((each.name for each in table), references, strict=True))
    listed = shown(table, frozenset(left_out))
    fixed = (each for each in table if each.name in left_out and each.start is not None)
    return {
        "shown": listed,
        "shown_at": [found[each.name] for each in listed],
        "constants": [(each.name, found[each.name], float(each.start)) for each in fixed],
    }


# --- of systems


def _is_checked(name, system):
    """Whether a parameter is one that the kernel `pack` does not check: of a free point, a sheave, or a start speed."""
    return name.partition(".")[0] in system.free or name.endswith(("]", f".{SPEED}"))


def lines_of(system):
    """`instance.Line` of each line of a system, a tuple.

    A line that runs over sheaves is one for each of its portions.
    """
    number, drums = {name: k for k, name in enumerate(system.free)}, drums_of(system)
    return tuple(
        Line(
            each.name,
            (*names_of_inputs(system, each), *each.wind_at_names(system.wind_points)),
            system.shape_points_of(each.line),
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
    """Names of the inputs of the system that are those of a line or a portion, by their places, but for its wind points."""
    for name in INPUT_NAMES:
        yield (told_by(system, portion.line, name) if portion.number == 0 else None) or input_name(name, portion)


def words_of(system, portion):
    """What sentences on a tether say, and what that is called of a line or a portion: pairs, longer ones first."""
    words = {}
    for end, point in zip(ENDS, (portion.start, portion.end), strict=True):
        first = "initial_" if point in system.free else ""
        place = words[f"{end}_position"] = f"{point}.{first}position"
        words |= {f"{end}_velocity": f"{point}.{first}velocity", f"the {end} end": f"its end at {point}"}
    load = f"{portion.end}.load" if portion.end in system.free else "a load"
    words |= {"the kite_load": load, "kite_mass; in a system the mass of the point": f"{portion.end}.mass"}
    for winch in system.winches:
        if portion.line.name in winch.lines:
            for name in dict.fromkeys((winch.input, SPEED, *winch.drum_names)):
                words[name] = " and ".join(filter(None, (words.get(name), f"{winch.name}.{name}")))
    return ("kite_position (initial_kite_position of a free kite end)", place), *words.items()


def told_by(system, line, name):
    """Names of the inputs, and start speeds, of shared winches that make an input of a line, "" if none does."""
    holding = (each for each in system.holding(line.name) if name in (each.input, SPEED))
    return " and ".join(f"{each.name}.{name}" for each in holding if system.carriers.get(each.name, line.name) == line.name)


def drums_of(system):
    """Lines that may carry a drum that turns beside sheaves, or that holds several lines: a dict of what it holds.

    Pairs of a line and its ratio; lines as numbers. A line that no shared winch holds carries its own.
    """
    first = {each.line.name: k for k, each in enumerate(all_portions(system.lines)) if each.number == 0}
    by_force = [each for each in system.winches if each.name in system.carriers]
    found = {first[system.carriers[each.name]]: [(first[line], r) for line, r in each.ratios] for each in by_force}
    held = {line for each in system.winches for line in each.lines}
    if by_force or any(line.through for line in system.lines):
        found |= {k: [(k, 1.0)] for name, k in first.items() if name not in held}
    return found


def holders_of(system):
    """Numbers in the parameters of lines that say which drums hold them: rows (line, place, number)."""
    found, counts = [], {}
    for carrier, held in drums_of(system).items():
        for line, ratio in held:
            i = counts[line] = counts.get(line, -1) + 1
            found += [(line, at.HELD_BY + i, carrier + 1.0), (line, at.HELD_RATIO + i, float(ratio))]
        if any(ratio < 0.0 for _, ratio in held):
            found.append((carrier, at.PULLS_BACK, 1.0))
    return tuple(found)


def carried(system):
    """Of each line the names of the free points at its start and its end whose mass it carries, None for none.

    The first line at a point does.
    """
    free, found = set(system.free), []
    for line in all_portions(system.lines):
        own = [point if point in free else None for point in (line.start, line.end)]
        free -= set(own)
        found.append(own)
    return found


def _quantities_of(system, portion, places):
    """Quantities of a line or a portion; what the system has no variable for has its default.

    The winch is that of the first portion. places : references by name, as below.
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


def _sheaves_of(system, places):
    """Rows of portions of lines over sheaves, and of the sheaves at their ends."""
    for each in all_portions(system.lines):
        kind = int(at.BEHIND_SHEAVE) if each.number else 1
        own = [f"{each.line.name}.{name}[{each.number + 1}]" for name in ("initial_portions", *SHEAVE_QUANTITIES)]
        yield kind if each.is_portion else 0, *(places.get(name, -1) for name in own)


def inputs_of(system):
    """Rows (place, name, line, place among its inputs) of inputs; of a load -1 and its place among the loads.

    Free points have the motion of their start there.  What shared winches give is in `held_of`.
    """
    first, winches = 0, {each.name for each in system.winches}
    for k, line in enumerate(lines_of(system)):
        for own, name in enumerate(line.inputs):
            point, _, what = name.partition(".")
            if point not in winches and "]." not in name:  # a portion but the first one has no winch
                yield first + own, f"{point}.initial_{what}" if point in system.free else name, k, own
        first += len(line.inputs)
    loads = (name for point in system.free for name in components(f"{point}.load", 3))
    yield from ((first + own, name, -1, own) for own, name in enumerate(loads))


def held_of(system):
    """Terms of inputs of lines that shared winches hold, rows as those of `inputs_of` with a factor.

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

    The force on a point is that of its lines in their order, and of each line that of its start before that of its end.
    """
    *firsts, _ = accumulate((line.outputs_size for line in lines_of(system)), initial=0)
    found = {}
    for each, first in zip(all_portions(system.lines), firsts, strict=True):
        line = each.line
        for end, point in each.ends:
            for i, name in enumerate(components(f"{point}.force", 3)):
                found.setdefault(name, []).append(first + outputs.PLACES[f"{end}_force"] + i)
        # those of a line over sheaves are in its first portion, but for its last tension
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
            if name in system.free:
                yield row + place, places[f"{name}.start"]
