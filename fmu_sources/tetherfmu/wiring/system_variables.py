"""FMI variables of a system of tethers, and their places in the flat arrays (`plan_layout.py`).

Points have `NAME.position`, lines have `NAME.reel_out_speed`; variables of the whole system have no prefix. A quantity has
the declaration of a single tether; here it gets the name of its point or line. The value reference of a variable is
its place in the array of all values: inputs, outputs, parameters.
"""

from dataclasses import replace

from ..runtime import inputs, outputs
from ..runtime import layout as at
from ..runtime.dependencies import depends_on
from ..runtime.inputs import DRIVEN_KITE, FREE_KITE, components
from ..runtime.outputs import POINTS, VECTOR
from ..runtime.parameters import Environment, FreeKite, Ground, Solver, Tether, Winch
from ..runtime.quantities import Quantity, quantities
from ..runtime.sheaves import SHEAVE_QUANTITIES
from ..runtime.variants import DYNAMIC
from .lines import sheaves_of
from .portions import all_portions, portions_of
from .system import values_of
from .variables import INPUT, OUTPUT, PARAMETER, Variable, elements, parameters_of, without_effect


def inputs_at(*terminals):
    """Names of the inputs of a tether that belong to terminals of FMI 3."""
    return tuple(each.name for each in inputs.INPUT_TABLE if each.terminal.partition(".")[0] in terminals)


ENDS = ("ground", "kite")  # of the tether of a line: its start and its end
OF_THE_SYSTEM = (Environment, Solver, Ground)
RECORDS_OF_A_LINE = (Tether, Winch)  # records with the parameters of a line
# outputs of a tether that a line has, and their names there
_OF_ENDS = {"ground_tension": "tension_from", "kite_tension": "tension_to"}
_OTHERS = ("max_tension", "peak_tension", "slack_segments", "grounded_length", "broken", "break_time")
OF_A_LINE = {name: _OF_ENDS.get(name, name) for name in ("tether_length", "winch_speed", *_OF_ENDS, *_OTHERS)}
MEANINGS = {
    "tension_from": "tension of the first segment, at {}; with winch_control = force where the line leaves the winch",
    "tension_to": "tension of the last segment, at {}",
}
SPEED = "reel_out_speed"  # an input of speed-controlled winches; otherwise a parameter, the start speed
TOLD = {  # inputs of shared winches
    "reel_out_speed": "speed at which {} pays out a line with the ratio 1; positive pays out",
    "winch_length": "length of a line with the ratio 1 that {} is to pay out from the start",
    "winch_force": "force with which {} pulls at its lines: sum of their tensions times their ratios; positive reels in",
}
TURNED = {  # their outputs: the output of a tether that they are made of
    "winch_speed": ("winch_speed", "reel-out speed of a line with the ratio 1"),
    "payout": ("tether_length", "length of a line with the ratio 1 that it has paid out since the start"),
}
# outputs of the portions and the sheaves of a line, in the order of `layout.PORTION_LENGTH`, ...: unit, meaning
OF_PORTIONS = {
    "portion_length": ("m", "unstretched length of portion {}"),
    "portion_tension_from": ("N", "tension at the start of portion {}"),
    "portion_tension_to": ("N", "tension at the end of portion {}"),
}
OF_SHEAVES = {
    "sheave_payout": ("m", "rope that has run over sheave {} from the portion before it since the start"),
    "sheave_speed": ("m/s", "rate of the rope that runs over sheave {}"),
}
SUMMED = ("solver_iterations",)  # summed over all lines; others are from the first line
GIVEN_TO_ALL = inputs_at("wind")  # vectors that all lines share
GIVEN = inputs_at("winch")  # inputs of a tether that a line has: of its winch
RELEASE = "release"  # and the release input
MOTION = inputs.BY_NAME["kite_load"].group  # of variables of points


def input_name(name, line):
    """Name of a tether input as input of a line or a portion of the system.

    "kite_position[1]" is "KITE.position[1]".
    """
    for end, point in zip(ENDS, (line.start, line.end), strict=True):
        if name.startswith(f"{end}_"):
            return f"{point}.{name.removeprefix(f'{end}_')}"
    is_own = name in (*GIVEN, RELEASE) or name.startswith(inputs.WIND_AT.name)
    return f"{line.name}.{name}" if is_own else name


# --- the table


def _vector(name, causality, declared, group, start=(None, None, None), known=(None, None, None)):
    """Variables of the components of a vector; start : values, known : their dependencies."""
    for (each, meaning), first, those in zip(elements(name, declared.meaning, VECTOR, 0), start, known, strict=True):
        yield Variable(each, causality, "Real", replace(declared, meaning=meaning), 0, first, those, group)


def _inputs(system):
    """Inputs: motion of driven points, loads on free ones, winches of lines, wind."""
    motion = [each for each in inputs.INPUT_TABLE if each.of == DRIVEN_KITE]
    load = next(each for each in inputs.INPUT_TABLE if each.of == FREE_KITE)
    for point in system.points:
        if not point.is_driven:
            declared = Quantity(load.unit, _LOAD.format(point.name))
            yield from _vector(f"{point.name}.load", INPUT, declared, load.group, load.start)
            continue
        for each, start in zip(motion, (system.position_of(point), point.velocity), strict=True):
            what = each.name.removeprefix("kite_")
            declared = Quantity(each.unit, f"{what} of {point.name}")
            yield from _vector(f"{point.name}.{what}", INPUT, declared, each.group, start)
    for line in system.lines:
        for name in () if system.holding(line.name) else GIVEN:
            declared = inputs.BY_NAME[name]
            quantity = Quantity(declared.unit, f"{declared.meaning}; of {line.name}, whose winch is at {line.start}")
            start = getattr(line, name, declared.start[0])
            yield Variable(f"{line.name}.{name}", INPUT, "Real", quantity, 0, start, group=declared.group)
    for winch in system.winches:
        declared = inputs.BY_NAME[winch.input]
        quantity = Quantity(declared.unit, TOLD[winch.input].format(winch.name))
        start = float(getattr(winch, winch.input, declared.start[0]))
        yield Variable(f"{winch.name}.{winch.input}", INPUT, "Real", quantity, 0, start, group=declared.group)
    for line in system.lines:
        declared = inputs.BY_NAME[RELEASE]
        quantity = Quantity("", _RELEASE.format(line))
        yield Variable(f"{line.name}.{RELEASE}", INPUT, declared.kind, quantity, 0, 0.0, group=declared.group)
    for each in (inputs.BY_NAME[name] for name in GIVEN_TO_ALL):
        for variable in _vector(each.name, INPUT, Quantity(each.unit, each.meaning), each.group, each.start):
            yield without_effect(variable, bool(system.wind_points), each.name)
    for line in system.lines:
        points, count = f"points on {line.name} at equal unstretched length, {line.start} first", len(portions_of(line))
        points += f", {system.wind_points} on each portion" if count > 1 else ""
        for name, meaning in elements(f"{line.name}.{inputs.WIND_AT.name}", points, POINTS, count * system.wind_points):
            quantity = Quantity(inputs.WIND_AT.unit, f"wind at {meaning}")
            yield Variable(name, INPUT, "Real", quantity, 0, 0.0, group=inputs.WIND_AT.group)


_RELEASE = "{0.name} lets go of {0.end}, permanently, at the start of the first step with true"
_LOAD = "external force on {}: aerodynamics, control; excludes its weight"
_START = "start of {}"
_STARTS = {"given": "at initial_position with initial_velocity"}
_STARTS["equilibrium"] = "at rest where its lines, its weight and its load are in equilibrium"


def _parameters(system):
    """Parameters: of the whole system, of free points, of lines."""
    for each in parameters_of(OF_THE_SYSTEM, values_of(system.environment, system.solver, system.ground)):
        yield without_effect(each, bool(system.wind_points))
    mass, kind_of_start = (dict(quantities(FreeKite))[name] for name in ("kite_mass", "kite_start"))
    units = {"position": "m", "velocity": "m/s"}
    for point in system.points:
        if not point.is_driven:
            meaning = "point mass, in addition to the halves of the segments that meet there"
            declared = replace(mass, meaning=meaning)
            yield Variable(f"{point.name}.mass", PARAMETER, "Real", declared, 0, point.mass, group=MOTION)
            start = at.START_GIVEN if point.position else at.START_AT_REST  # of where it was found
            declared = replace(kind_of_start, meaning=_START.format(point.name), choices=_STARTS)
            yield Variable(f"{point.name}.start", PARAMETER, "Enumeration", declared, 0, start, group=MOTION)
            for (what, unit), first in zip(units.items(), (system.position_of(point), point.velocity), strict=True):
                declared = Quantity(unit, f"{what} of {point.name} at the start", -at.LARGEST_INPUT, at.LARGEST_INPUT)
                yield from _vector(f"{point.name}.initial_{what}", PARAMETER, declared, MOTION, first)
    for line in system.lines:
        records = RECORDS_OF_A_LINE[:1] if system.holding(line.name) else RECORDS_OF_A_LINE
        for each in parameters_of(records, values_of(*line.tethers, line.winch)):
            yield replace(each, name=f"{line.name}.{each.name}")
        yield from _parameters_of_sheaves(line)
    for winch in system.winches:
        yield from _parameters_of_winch(winch)


def _parameters_of_winch(winch):
    """Parameters of a shared winch: of its drum, and how it starts."""
    drum = {name: float(getattr(winch, name)) for name in winch.drum_names}
    for each in parameters_of((Winch,), drum):
        if each.name in drum:
            declared = replace(each.quantity, meaning=each.quantity.meaning.replace("force control: ", ""))
            yield replace(each, name=f"{winch.name}.{each.name}", quantity=declared)
    if winch.input != SPEED:
        declared = Quantity("m/s", f"{TURNED['winch_speed'][1]} at the start", -at.LARGEST_INPUT, at.LARGEST_INPUT)
        yield Variable(f"{winch.name}.{SPEED}", PARAMETER, "Real", declared, 0, float(winch.reel_out_speed), group="winch")


def _parameters_of_sheaves(line):
    """Parameters of the portions and the sheaves of a line that runs over some."""
    portions, starts = (portions_of(line), sheaves_of(line)) if line.through else ((), {})
    for k, portion in enumerate(portions):
        meaning = f"unstretched length at the start of portion {k + 1}, from {portion.start} to {portion.end}, "
        meaning += "in proportion to those of the others; 0 of any: each sheave starts with the same tension on both sides"
        declared, start = Quantity("m", meaning, 0.0, 1e5), starts["initial_portions"][k]
        yield Variable(f"{line.name}.initial_portions[{k + 1}]", PARAMETER, "Real", declared, 0, start, group="geometry")
    for name, declared in SHEAVE_QUANTITIES.items():
        for k, portion in enumerate(portions[:-1]):
            own = replace(declared, meaning=f"{declared.meaning}; of sheave {k + 1}, at {portion.end}")
            start = starts[name][k]
            yield Variable(f"{line.name}.{name}[{k + 1}]", PARAMETER, "Real", own, 0, start, group="forces")


def _dependencies(name, system, line):
    """Names of inputs and parameters that a line depends on; name : of the one that a tether depends on."""
    if name in GIVEN and system.holding(line.name):
        return [f"{winch.name}.{name}" for winch in system.holding(line.name)]
    if name in _QUANTITIES_OF_A_LINE:
        return [f"{line.name}.{name}"]
    renamed = input_name(name, line)
    point, _, what = renamed.partition(".")
    return [f"{point}.initial_{what}" if point in system.free_names else renamed]


_QUANTITIES_OF_A_LINE = frozenset(name for record in RECORDS_OF_A_LINE for name, _ in quantities(record))


def _known(system, line, output, element, known):
    """Names of the dependencies of a line output when initialization ends; None for anything.

    Between driven points each line has its own shape; sought free points couple all lines, and so
    do sought drums. known : names of inputs and parameters.
    """
    found = depends_on(DYNAMIC, output, element, system.shape_points_of(line), system.wind_points)
    if (
        line.through
        or any(each.name in system.carriers for each in system.holding(line.name))
        or (system.free and any(name.startswith(("kite_position", "ground_position")) for name in found))
    ):
        return None
    named = (each for name in found for each in _dependencies(name, system, line))
    return tuple(name for name in dict.fromkeys(named) if name in known)


def _together(listed):
    """All names in lists of them, each once; None if one of them is None."""
    listed = tuple(listed)
    return None if None in listed else tuple(dict.fromkeys(name for names in listed for name in names))


def _outputs(system, known):
    """Outputs: forces on driven points, motion of free ones, outputs of lines, solver work."""
    forces_at = {}  # by the name of the point: pairs of a line and its force there
    for each in all_portions(system.lines):
        for end, name in each.ends:
            forces_at.setdefault(name, []).append((each.line, outputs.BY_NAME[f"{end}_force"]))
    for point in system.points:
        if not point.is_driven:
            for what in ("position", "velocity"):
                declared = replace(outputs.BY_NAME[f"kite_{what}"].quantity, meaning=f"{what} of {point.name}")
                starts = [(name,) for name in components(f"{point.name}.initial_{what}", 3)]
                known_of = (None, None, None) if what == "position" else starts
                yield from _vector(f"{point.name}.{what}", OUTPUT, declared, MOTION, known=known_of)
            continue
        declared = replace(outputs.BY_NAME["kite_force"].quantity, meaning=f"force of its lines on {point.name}")
        at_it = forces_at[point.name]
        found = [
            _together(_known(system, line, force, f"{force.name}[{i}]", known) for line, force in at_it) for i in (1, 2, 3)
        ]
        yield from _vector(f"{point.name}.force", OUTPUT, declared, at_it[0][1].group, known=found)
    for line in system.lines:
        yield from _outputs_of_line(system, line, known)
    for winch in system.winches:
        lines = [line for line in system.lines if line.name in winch.lines]
        for own, (name, meaning) in TURNED.items():
            each = outputs.BY_NAME[name]
            found = _together(_known(system, line, each, name, known) for line in lines)
            quantity = replace(each.quantity, meaning=f"{meaning}; of {winch.name}")
            yield Variable(f"{winch.name}.{own}", OUTPUT, each.kind, quantity, 0, depends_on=found, group=each.group)
    for name in outputs.COUNTERS:
        each = outputs.BY_NAME[name]
        yield Variable(name, each.causality(), each.kind, each.quantity, 0, group=each.group)


def _outputs_of_line(system, line, known):
    """Outputs of a line."""
    for name, own in OF_A_LINE.items():
        each = outputs.BY_NAME[name]
        end = line.start if name.startswith(ENDS[0]) else line.end
        meaning = MEANINGS[own].format(end) if own in MEANINGS else each.quantity.meaning
        found = _known(system, line, each, name, known)
        quantity = replace(each.quantity, meaning=meaning)
        yield Variable(f"{line.name}.{own}", OUTPUT, each.kind, quantity, 0, depends_on=found, group=each.group)
    shape = outputs.BY_NAME["shape"]
    points = f"points on the line at equal unstretched length, {line.start} first"
    count = system.shape_points_of(line) * len(portions_of(line))
    for name, meaning in elements(f"{line.name}.shape", points, POINTS, count):
        quantity = replace(shape.quantity, meaning=meaning)
        yield Variable(name, shape.causality(system.wind_points), "Real", quantity, 0, group=shape.group)
    if line.through:
        for name, unit, meaning, count in outputs_of_portions(line):
            for k in range(count):
                quantity = Quantity(unit, meaning.format(k + 1))
                yield Variable(f"{line.name}.{name}[{k + 1}]", OUTPUT, "Real", quantity, 0, depends_on=None, group="tether")


def outputs_of_portions(line):
    """Outputs of the portions and the sheaves of a line: name, unit, meaning with a number, and how many there are."""
    count = len(line.through) + 1
    for name, (unit, meaning) in OF_PORTIONS.items():
        yield name, unit, meaning, count
    for name, (unit, meaning) in OF_SHEAVES.items():
        yield name, unit, meaning, count - 1


def table_of(system):
    """The table of all variables of a system, a tuple of `variables.Variable`: inputs, outputs and local ones, parameters.

    The place of a variable is its value reference.
    """
    given, fixed = list(_inputs(system)), list(_parameters(system))
    found = _outputs(system, {each.name for each in (*given, *fixed)})
    return tuple(replace(each, place=k) for k, each in enumerate((*given, *found, *fixed)))
