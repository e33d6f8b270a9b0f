"""Where the variables of a system of tethers stand in its flat arrays (`plan_layout.py`), and what of the plan is given.

References are value references by the names of variables, see `system_variables.py`.
"""

from dataclasses import fields
from itertools import count

from ..runtime import inputs, outputs
from ..runtime import layout as at
from ..runtime import plan_layout as plan
from ..runtime.inputs import components
from ..runtime.instance import Line
from ..runtime.outputs import COUNTERS
from ..runtime.parameters import Ground, Tether, Winch
from ..runtime.variables import input_names
from .system_variables import GIVEN, GIVEN_TO_ALL, OF_A_LINE, OF_THE_SYSTEM, SUMMED, input_name


def inputs_of(structure, places):
    """Rows (place in the `inputs` array, value reference, line, place among its inputs) of a system; of a load (place,
    value reference, -1, place among the loads).

    Free points have the motion of their start there. places : dict of the names of variables to value references.
    """
    free = {point.name for point in structure.points if point.is_free}
    found, first = [], 0
    for k, line in enumerate(structure.lines):
        named = {}  # place: name
        for end, point in line.ends:
            for what in ("position", "velocity"):
                own = f"{point}.{'initial_' if point in free else ''}{what}"
                named |= dict(zip(count(inputs.PLACES[f"{end}_{what}"]), components(own, 3), strict=False))
        for name in GIVEN:
            named[inputs.PLACES[name]] = f"{line.name}.{name}"
        for each in (inputs.BY_NAME[name] for name in GIVEN_TO_ALL):
            named |= dict(zip(count(inputs.PLACES[each.name]), components(each.name, each.size), strict=False))
        named |= {at.INPUTS + i: f"{line.name}.{name}" for i, name in enumerate(inputs.wind_at_names(line.wind_points))}
        found += [(first + own, places[name], k, own) for own, name in named.items()]
        first += at.inputs_size(line.wind_points)
    loads = [name for point in structure.free for name in components(f"{point}.load", 3)]
    return found + [(first + own, places[name], -1, own) for own, name in enumerate(loads)]


def outputs_of(structure, places):
    """Pairs (value reference, places in the `outputs` array) of a system; its output is the sum of the numbers there.

    The force on a point is that of its lines in their order, and of each line that of its start before that of its end.
    Positions and velocities of free points are not there, see `motion_of`. places : as of `inputs_of`.
    """
    firsts, first = {}, 0
    for line in structure.lines:
        firsts[line.name] = first
        first += at.outputs_size(line.shape_points)
    found = {}
    for line in structure.lines:
        first = firsts[line.name]
        for end, point in line.ends:
            for i, name in enumerate(components(f"{point}.force", 3)):
                found.setdefault(name, []).append(first + outputs.PLACES[f"{end}_force"] + i)
        for name, own in OF_A_LINE.items():
            found[f"{line.name}.{own}"] = [first + outputs.PLACES[name]]
        for k in range(line.shape_points):
            for i in range(3):
                found[f"{line.name}.shape[{k + 1},{i + 1}]"] = [first + at.SHAPE + 3 * k + i]
    for name in COUNTERS:
        every = [first + outputs.PLACES[name] for first in firsts.values()]
        found[name] = every if name in SUMMED else every[:1]
    return [(places[name], tuple(those)) for name, those in found.items() if name in places]


def free_ends(structure, places):
    """Where free points move: (value reference, number of the line, 1 at its end and 0 at its start, component from 0 to 5).

    Position and velocity have three components each. Of several lines at a point the last one counts.
    """
    found, free = {}, set(structure.free)
    for k, line in enumerate(structure.lines):
        for is_end, (_, point) in enumerate(line.ends):
            if point in free:
                names = (*components(f"{point}.position", 3), *components(f"{point}.velocity", 3))
                found |= {name: (places[name], k, is_end, component) for component, name in enumerate(names)}
    return list(found.values())


def motion_of(structure, places, segments, states_at):
    """Pairs (value reference, place in the `state` array) of the motion of free points.

    segments, states_at : of each line its number of segments, and the place of its state.
    """
    found = []
    for reference, k, is_end, component in free_ends(structure, places):
        what, axis = divmod(component, 3)
        node = (segments[k] + 1) * what + segments[k] * is_end
        found.append((reference, states_at[k] + at.STATE_HEADER + 3 * node + axis))
    return found


def starts_of(structure, places):
    """Pairs (place in the `plan` array, value reference of the start of the free point there) of all ends of lines."""
    found = []
    for k, line in enumerate(structure.lines):
        row = plan.PLAN_HEADER + plan.LINE_NUMBERS * k
        for place, name in ((plan.START_IS_SOUGHT, line.start), (plan.END_IS_SOUGHT, line.end)):
            if name in structure.free:
                found.append((row + place, places[f"{name}.start"]))
    return found


def sought(structure, places, values):
    """Whether the free points at the ends of lines are sought: pairs of place in the `plan` array and 1 or 0."""
    return [(place, int(values[reference] == at.START_AT_REST)) for place, reference in starts_of(structure, places)]


def lines_of(structure):
    """`instance.Line` of each line of a system, a tuple.

    structure : has `lines`, with `name`, `start`, `end`, `shape_points` and `wind_points`, and `free`.
    """
    number = {name: k for k, name in enumerate(structure.free)}
    return tuple(
        Line(
            line.name,
            tuple(input_name(each, line) for each in input_names(line.wind_points)),
            line.shape_points,
            line.wind_points,
            *(number.get(name, plan.DRIVEN) for name in (line.start, line.end)),
        )
        for line in structure.lines
    )


def packed_of(structure, places, values):
    """What `packing.pack_lines` takes of each line, from the values of all variables."""
    for line, points in zip(structure.lines, carried(structure), strict=True):
        known = quantities_of_line(line, places)
        numbers = [default if reference is None else values[reference] for _, reference, default in known]
        free_ends = [point in structure.free for point in (line.start, line.end)]
        yield line.name, numbers, 1, free_ends, [values[places[f"{point}.mass"]] if point else 0.0 for point in points]


def quantities_of_line(line, places):
    """Quantities in the order in which the kernel `pack` takes them: (name, value reference or None, default) of each.

    What the system has no variable for has its default.
    """
    found = []
    for record in (Tether, *OF_THE_SYSTEM[:2], Winch, Ground):
        for item in fields(record):
            own = item.name if record in OF_THE_SYSTEM else f"{line.name}.{item.name}"
            found.append((item.name, places.get(own), item.default))
    return found


def unpacked(structure):
    """Names of the parameters that the kernel `pack` does not check: those of free points."""
    for point in structure.points:
        if point.is_free:
            yield f"{point.name}.mass"
            yield f"{point.name}.start"
            for what in ("position", "velocity"):
                yield from components(f"{point.name}.initial_{what}", 3)


def carried(structure):
    """Of each line the names of the free points at its start and its end whose mass it carries, None for none.

    The first line at a point does.
    """
    free, found = set(structure.free), []
    for line in structure.lines:
        own = [point if point in free else None for point in (line.start, line.end)]
        free -= set(own)
        found.append(own)
    return found
