"""The flat arrays of a system, and what moves them: the single tethers of its lines, and the kernels for all at once.

Each line is a dynamic tether of its own between its two points (`runtime.instance`): it packs its parameters, finds its
first shape and its outputs. What moves all of them works on copies of their arrays, one behind the other
(`runtime/system_layout.py`).
"""

import numpy as np

from tetherfmu.libraries import ready
from tetherfmu.runtime import layout as at
from tetherfmu.runtime import status
from tetherfmu.runtime import system_layout as places
from tetherfmu.runtime.inputs import PLACES
from tetherfmu.runtime.instance import OUTPUTS_AT, Instance
from tetherfmu.runtime.kernel_library import SYSTEM
from tetherfmu.runtime.packing import pack_records
from tetherfmu.runtime.parameters import Winch
from tetherfmu.runtime.status import OK
from tetherfmu.runtime.variables import INPUT_NAMES

from .results import StepRefused
from .system_ordering import ordered

ENDS = ("ground", "kite")  # of the tether of a line: its start and its end


class Arrays:
    """All numbers of a system.

    Attributes
    ----------
    instances : list of Instance
        The dynamic tethers of the lines.
    plan, parameters, inputs, state, before, work : array
        As `system_layout.py` has them; `before` is the state before the last step.
    """

    def __init__(self, points, lines, environment, solver, ground):
        self.points, self.lines = points, lines
        self.free, band = ordered([point.name for point in points if not point.is_driven], lines)
        self._kernels = ready.kernels(SYSTEM)
        self.instances = []
        carried = set()
        for line in lines:
            self.instances.append(self._instance(line, carried, environment, solver, ground))
        self._make_plan(band)
        self.inputs = np.zeros(places.inputs_size(len(lines), len(self.free)))
        self.rows = [self.inputs[k * at.INPUTS : (k + 1) * at.INPUTS] for k in range(len(lines))]
        self.loads = self.inputs[len(lines) * at.INPUTS :].reshape(-1, 3)
        self.parameters = np.concatenate([each.parameters for each in self.instances])
        self.state = np.zeros(sum(len(each.state) for each in self.instances))
        self.before = np.zeros_like(self.state)
        self.work = np.zeros(self._work_size)

    def _instance(self, line, carried, environment, solver, ground):
        """The tether of a line. A free point whose mass no other line carries is in it; carried (modified): such points."""
        tethers = line.tether if isinstance(line.tether, tuple | list) else (line.tether,)
        ends = [self.point(name) for name in (line.start, line.end)]
        nodes = 0, sum(tether.segments for tether in tethers)
        masses = [
            (node, end.mass) for node, end in zip(nodes, ends, strict=True) if not end.is_driven and end.name not in carried
        ]
        carried.update(end.name for end in ends)
        kernels = ready.kernels("dynamic")
        instance = Instance(kernels, nodes[1] + 1)
        free = [not end.is_driven for end in ends]
        try:
            packed = pack_records(
                kernels, tethers, environment, solver, Winch(), ground, point_masses=masses, free_ends=free
            )
        except ValueError as problem:
            raise ValueError(f"the line {line.name}: {problem}") from None
        instance.set_up(*packed)
        return instance

    def _make_plan(self, band):
        """The plan, and the length of the work array; band : of the matrix of the free points."""
        rows, here = [], np.zeros(3, int)
        for line, instance in zip(self.lines, self.instances, strict=True):
            ends = [self.free.index(name) if name in self.free else places.DRIVEN for name in (line.start, line.end)]
            rows.append([instance.segments, *ends, *here.tolist()])
            work = self._kernels.line_work_size(instance.segments)
            here += [len(instance.parameters), len(instance.state), work]
        rows.append([0, places.DRIVEN, places.DRIVEN, *here.tolist()])
        header = [0] * places.PLAN_HEADER
        header[places.LINES], header[places.FREE_POINTS] = len(self.lines), len(self.free)
        header[places.POINTS_WORK], header[places.BAND] = here[2], band
        self.plan = np.array([*header, *(number for row in rows for number in row)], dtype=np.int64)
        self._work_size = int(here[2]) + self._kernels.points_work_size(len(self.free), band)
        self.states_at = [row[places.STATE_AT] for row in rows]

    def topology(self):
        """Copy of the plan without what the kernels write there."""
        found = self.plan.copy()
        found[places.STATUS_LINE] = 0
        return found

    def point(self, name):
        """The record of a point."""
        return next(point for point in self.points if point.name == name)

    def put_point_in(self, rows, name, what, vector):
        """Set "position" [m] or "velocity" [m/s] of a point, (..., 3), among the inputs of its lines.

        rows : views (..., INPUTS) of the inputs of all lines (modified).
        """
        for line, row in zip(self.lines, rows, strict=True):
            for end, point in zip(ENDS, (line.start, line.end), strict=True):
                if point == name:
                    place = PLACES[f"{end}_{what}"]
                    row[..., place : place + 3] = vector

    def of_line(self, k):
        """View of the state of line k."""
        return self.state[self.states_at[k] : self.states_at[k + 1]]

    def nodes(self, k, state=None):
        """Positions [m] and velocities [m/s] of the nodes of line k, view (..., 2, segments + 1, 3) of its states."""
        state = self.state if state is None else state
        own = state[..., self.states_at[k] + at.STATE_HEADER : self.states_at[k + 1]]
        return own.reshape(*own.shape[:-1], 2, self.instances[k].segments + 1, 3)

    def forces_at_rest(self, k, ends):
        """Forces [N] of line k at rest on its start and its end, (2, 3), with these there [m], (2, 3); None if it has none.

        Wind and unstretched length are those of the inputs; the state of its instance is modified.
        """
        instance = self.instances[k]
        values = np.frombuffer(instance.values)
        values[: at.INPUTS] = self.rows[k]
        values[at.GROUND_POSITION : at.GROUND_POSITION + 3], values[at.KITE_POSITION : at.KITE_POSITION + 3] = ends
        shape = instance.parameters[at.INITIAL_SHAPE]
        instance.parameters[at.INITIAL_SHAPE] = at.STATIC_EQUILIBRIUM
        problem = instance.start()
        instance.parameters[at.INITIAL_SHAPE] = shape
        found = values[OUTPUTS_AT:]
        places_of_forces = (at.GROUND_FORCE, at.KITE_FORCE)
        return None if problem else np.array([found[place : place + 3] for place in places_of_forces])

    def start_line(self, k):
        """Find the first shape of line k between its points as the inputs say; StepRefused names the line."""
        instance = self.instances[k]
        np.frombuffer(instance.values)[: at.INPUTS] = self.rows[k]
        if instance.start():
            raise StepRefused(self.sentence(instance.status, 0.0, k), instance.status)

    def start(self):
        """Find the first shapes of all lines; StepRefused, and nothing but the inputs is changed, if that is not possible.

        Driven ends that two lines share move alike only if neither line turns them on its own in its first step
        (`end_motion.turning_accelerations`): that is for systems of one line.
        """
        before = [(each.state[:], each.values[:]) for each in self.instances]
        try:
            for k in range(len(self.lines)):
                self.start_line(k)
        except StepRefused:
            for each, (state, values) in zip(self.instances, before, strict=True):
                each.state[:], each.values[:] = state, values
            raise
        self.parameters[:] = np.concatenate([each.parameters for each in self.instances])
        for k, instance in enumerate(self.instances):
            self.of_line(k)[:] = instance.state
            if len(self.lines) > 1:
                self.parameters[self.parameters_at(k) + at.INITIAL_SHAPE] = at.STATIC_EQUILIBRIUM

    def parameters_at(self, k):
        """Place of the parameters of line k."""
        return self.plan[places.PLAN_HEADER + places.LINE_NUMBERS * k + places.PARAMETERS_AT]

    def advance(self, step):
        """Do a communication step [s]; returns the status, and all is as it was but on OK."""
        arrays = self.parameters.ctypes.data, self.inputs.ctypes.data
        states = self.state.ctypes.data, self.before.ctypes.data
        return self._kernels.advance(self.plan.ctypes.data, *arrays, step, *states, self.work.ctypes.data)

    def fly(self, inputs, step, every):
        """Do a communication step [s] for each row of inputs until one is refused: how many, and the states that were kept.

        inputs : contiguous array (steps, inputs).  every : a state is kept after every so many steps; 0 for none.
        """
        kept = np.zeros((len(inputs) // every if every else 0, len(self.state)))
        flight = self.parameters.ctypes.data, inputs.ctypes.data, len(inputs), step, every
        states = self.state.ctypes.data, self.before.ctypes.data
        done = self._kernels.fly(self.plan.ctypes.data, *flight, *states, kept.ctypes.data, self.work.ctypes.data)
        return done, kept[: done // every if every else 0]

    def take_outputs(self, k, state=None):
        """Outputs of line k, a new array, in its present state or another one; OUTPUT_NOT_FINITE is refused in words."""
        instance = self.instances[k]
        np.frombuffer(instance.state)[:] = self.of_line(k) if state is None else state
        np.frombuffer(instance.values)[: at.INPUTS] = self.rows[k]
        found = instance.take_outputs()
        if found != OK:
            raise StepRefused(self.sentence(found, 0.0, k), found)
        return np.frombuffer(instance.values)[OUTPUTS_AT:].copy()

    def problem(self, result, step):
        """What a status of `advance` says about a step [s]."""
        return self.sentence(result, step, int(self.plan[places.STATUS_LINE]))

    def sentence(self, result, step, k):
        """What a status says about a step [s] of line k, or of all of them; an input has the name of its point or line."""
        instance = self.instances[max(k, 0)]
        np.frombuffer(instance.values)[: at.INPUTS] = self.rows[max(k, 0)]
        if status.code(result) == status.INPUT_NOT_FINITE:
            place = status.index(result)
            return status.sentence(result, name=self._input_name(INPUT_NAMES[place], k), value=instance.values[place])
        said = instance.sentence(result, step)
        return said if k == places.ALL_LINES else f"the line {self.lines[k].name}: {said}"

    def _input_name(self, name, k):
        """Name of an input of line k as an input of the system: "kite_position[1]" is "KITE.position[1]"."""
        line = self.lines[k]
        for end, point in zip(ENDS, (line.start, line.end), strict=True):
            if name.startswith(f"{end}_"):
                return f"{point}.{name.removeprefix(f'{end}_')}"
        return f"{line.name}.{name}" if name.startswith(("reel", "winch")) else name
