"""The flat arrays of a system, and the kernels that move all its lines at once.

The library for systems packs the parameters of each line, completes the plan (`runtime/system_layout.py`), starts, moves and
observes all lines.
"""

import numpy as np

from tetherfmu.libraries import ready
from tetherfmu.results import StepRefused
from tetherfmu.runtime import layout as at
from tetherfmu.runtime import system_layout as places
from tetherfmu.runtime.inputs import PLACES
from tetherfmu.runtime.kernel_library import SYSTEM
from tetherfmu.runtime.packing import pack_line
from tetherfmu.runtime.parameters import numbers_of
from tetherfmu.runtime.status import OK
from tetherfmu.runtime.system_refusals import sentence
from tetherfmu.runtime.system_variables import ENDS

from .ordering import ordered


class Arrays:
    """All numbers of a system.

    Attributes
    ----------
    segments : list of int
        Of the lines.
    plan, parameters, inputs, state, before, outputs, work : array
        As `system_layout.py` has them; `before` is the state before the last step.
    """

    def __init__(self, points, lines, environment, solver, ground):
        self.points, self.lines = points, lines
        self.free, band = ordered([point.name for point in points if not point.is_driven], lines)
        self._kernels = ready.kernels(SYSTEM)
        carried = set()
        packed = [self._packed(line, carried, environment, solver, ground) for line in lines]
        self.segments = [segments for segments, _ in packed]
        self._make_plan(band)
        self.inputs = np.zeros(self.plan[places.INPUTS_SIZE])
        self.rows = [self.inputs[k * at.INPUTS : (k + 1) * at.INPUTS] for k in range(len(lines))]
        self.loads = self.inputs[len(lines) * at.INPUTS :].reshape(-1, 3)
        self.parameters = np.concatenate([parameters for _, parameters in packed])
        self.state, self.before = np.zeros((2, self.plan[places.STATE_SIZE]))
        self.outputs = np.zeros(self.plan[places.OUTPUTS_SIZE])
        self.work = np.zeros(self.plan[places.WORK_SIZE])

    def _packed(self, line, carried, environment, solver, ground):
        """Number of segments and parameters of a line; ValueError names it if one is not allowed.

        The mass of a free point that no other line carries is in it; carried (modified): such points.
        """
        tethers = line.tether if isinstance(line.tether, tuple | list) else (line.tether,)
        ends = [self.point(name) for name in (line.start, line.end)]
        masses = [0.0 if end.is_driven or end.name in carried else end.mass for end in ends]
        carried.update(end.name for end in ends)
        free = [not end.is_driven for end in ends]
        numbers = numbers_of(tethers, environment, solver, line.winch, ground)
        try:
            return pack_line(self._kernels, numbers, len(tethers), free, masses)
        except ValueError as problem:
            raise ValueError(f"the line {line.name}: {problem}") from None

    def _make_plan(self, band):
        """The plan; band : of the matrix of the free points."""
        self.plan = np.zeros(places.plan_size(len(self.lines)), dtype=np.int64)
        self.plan[[places.LINES, places.FREE_POINTS, places.BAND]] = len(self.lines), len(self.free), band
        rows = self._line_rows()
        for row, line, segments in zip(rows, self.lines, self.segments, strict=True):
            ends = [self.free.index(name) if name in self.free else places.DRIVEN for name in (line.start, line.end)]
            given = [places.SEGMENTS, places.START_POINT, places.END_POINT, places.SHAPE_POINTS]
            row[given] = segments, *ends, segments + 1
        self._kernels.complete(self.plan.ctypes.data)
        self.states_at = [*rows[:, places.STATE_AT].tolist(), int(self.plan[places.STATE_SIZE])]
        self.outputs_at = [*rows[:, places.OUTPUTS_AT].tolist(), int(self.plan[places.OUTPUTS_SIZE])]

    def topology(self):
        """Copy of the plan without what the kernels write there, and which points the start has found."""
        found = self.plan.copy()
        found[places.STATUS_LINE] = 0
        rows = found[places.PLAN_HEADER :].reshape(-1, places.LINE_NUMBERS)
        rows[:, [places.START_IS_SOUGHT, places.END_IS_SOUGHT]] = 0
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
        return own.reshape(*own.shape[:-1], 2, self.segments[k] + 1, 3)

    def start(self, sought):
        """Find the first shapes of all lines; StepRefused, and no array but the inputs is changed, if there are none.

        sought : names of free points whose positions are found, and set among the inputs.
        """
        for row, line in zip(self._line_rows(), self.lines, strict=True):
            row[[places.START_IS_SOUGHT, places.END_IS_SOUGHT]] = line.start in sought, line.end in sought
        found = self._kernels.initialize(*self._addresses(self.plan, self.parameters, self.inputs), *self._results())
        if found != OK:
            raise StepRefused(self.problem(found, 0.0, at_start=True), found)

    def _line_rows(self):
        """View of what the plan says about each line, a row for each."""
        return self.plan[places.PLAN_HEADER :].reshape(-1, places.LINE_NUMBERS)

    def _addresses(self, *arrays):
        """Addresses of arrays."""
        return [each.ctypes.data for each in arrays]

    def _results(self):
        """Addresses of what a start or a step modifies."""
        return self._addresses(self.state, self.before, self.outputs, self.work)

    def advance(self, step):
        """Do a communication step [s]; returns the status, and all is as it was but on OK."""
        return self._kernels.advance(*self._addresses(self.plan, self.parameters, self.inputs), step, *self._results())

    def fly(self, inputs, step, every):
        """Do a communication step [s] for each row of inputs until one is refused: how many, and the states that were kept.

        inputs : contiguous array (steps, inputs).  every : a state is kept after every so many steps; 0 for none.
        """
        kept = np.zeros((len(inputs) // every if every else 0, len(self.state)))
        flight = self.parameters.ctypes.data, inputs.ctypes.data, len(inputs), step, every
        states = self.state.ctypes.data, self.before.ctypes.data
        done = self._kernels.fly(self.plan.ctypes.data, *flight, *states, kept.ctypes.data, self.work.ctypes.data)
        return done, kept[: done // every if every else 0]

    def take_outputs(self, state=None):
        """Outputs of all lines, a list of new arrays, in the present state or another one; OUTPUT_NOT_FINITE is refused."""
        own = self.state if state is None else np.ascontiguousarray(state)
        arrays = self._addresses(self.plan, self.parameters, own, self.outputs, self.work)
        found = self._kernels.outputs(*arrays)
        if found != OK:
            raise StepRefused(self.problem(found, 0.0), found)
        return np.split(self.outputs.copy(), self.outputs_at[1:-1])

    def problem(self, result, step, at_start=False):
        """What a status says about a step [s]; at_start : whether the lines have the lengths of their start."""
        return sentence(result, step, self, self.lines, self.free, at_start)
