"""A running system of tethers: as `instance.Instance`, for the library of systems and its arrays (`system_layout.py`)."""

from array import array

from . import layout as at
from . import plausibility, status, system_maps
from . import system_layout as places
from .instance import address, zeros
from .packing import pack_line
from .quantities import NOT_WHOLE, checked
from .saved_state import check_state
from .system_refusals import sentence
from .variables import INPUT, PARAMETER


class SystemInstance:
    """A system that is set up, started, and advanced step by step; a refused start or step keeps state and outputs.

    Parameters
    ----------
    kernels : kernel_library.SystemKernels
    structure : system_variables.Structure
    table : tuple of variables.Variable
        Of `system_variables.table_of`.

    Attributes
    ----------
    values : array
        Inputs, outputs (from `outputs_at` on) and parameters (from `parameters_at` on) in the order of the table.
    state, segments : array, int
        States of all lines, and their segments together; 0 before it is set up.
    """

    def __init__(self, kernels, structure, table):
        self.kernels, self.structure, self.table = kernels, structure, table
        self.values = zeros(len(table))
        self.outputs_at = sum(each.causality == INPUT for each in table)
        self.parameters_at = sum(each.causality != PARAMETER for each in table)
        self.places = {each.name: each.place for each in table}
        self._checked = [each for each in table if each.causality == PARAMETER]
        self._inputs_from = system_maps.inputs_of(structure, self.places)
        found = system_maps.outputs_of(structure, self.places)
        self._sums = [each for each in found if len(each[1]) > 1]
        self._alone = [(reference, those[0]) for reference, those in found if len(those) == 1]
        self.segments, self._counts = 0, ()
        self.state = zeros(0)

    def packed(self, values, tolerance):
        """What `set_up` takes, from an array of all values; ValueError names the variable that is not allowed.

        tolerance : the importer's relative tolerance [-], 0 for none.
        """
        for each in self._checked:
            value = values[each.place]
            checked(each.name, int(value) if each.kind != "Real" and value.is_integer() else value, each.quantity)
            if each.kind != "Real" and not value.is_integer():
                raise ValueError(NOT_WHOLE.format(name=each.name, value=value))
        found, parameters = [], array("d")
        for line, points in zip(self.structure.lines, system_maps.carried(self.structure), strict=True):
            known = system_maps.quantities_of_line(line, self.places)
            numbers = [default if reference is None else values[reference] for _, reference, default in known]
            free = [point in self.structure.free for point in (line.start, line.end)]
            masses = [values[self.places[f"{point}.mass"]] if point else 0.0 for point in points]
            try:
                segments, own = pack_line(self.kernels, numbers, 1, free, masses, tolerance)
            except ValueError as problem:
                raise ValueError(f"the line {line.name}: {problem}") from None
            found.append(segments)
            parameters += own
        return sum(found), tuple(found), parameters, system_maps.sought(self.structure, self.places, values)

    def set_up(self, total, counts, parameters, sought):
        """Take segments in all and of each line, their parameters and which points are sought, and make the arrays.

        sought : dict of place in the plan to 1 or 0.  The system is to be started next.
        """
        self.parameters = parameters
        if counts != self._counts:
            self.segments, self._counts = total, counts
            self._make_plan()
            plan = self.plan
            self.inputs = zeros(plan[places.INPUTS_SIZE])
            self.state, self.before = zeros(plan[places.STATE_SIZE]), zeros(plan[places.STATE_SIZE])
            self.outputs, self.work = zeros(plan[places.OUTPUTS_SIZE]), zeros(plan[places.WORK_SIZE])
            self._motion = system_maps.motion_of(self.structure, self.places, counts, self._states_at[:-1])
            self._warned = [0] * len(counts)
        for place, is_sought in sought.items():
            self.plan[place] = is_sought
        self._fixed = tuple(map(address, (self.plan, self.parameters, self.inputs)))
        self._changing = tuple(map(address, (self.state, self.before, self.outputs, self.work)))

    def _make_plan(self):
        self.plan = array("q", bytes(8 * places.plan_size(len(self._counts))))
        for place, number in system_maps.plan_of(self.structure).items():
            self.plan[place] = number
        rows = range(places.PLAN_HEADER, len(self.plan), places.LINE_NUMBERS)
        for row, segments in zip(rows, self._counts, strict=True):
            self.plan[row + places.SEGMENTS] = segments
        self.kernels.complete(address(self.plan))
        self._states_at = [*(self.plan[row + places.STATE_AT] for row in rows), self.plan[places.STATE_SIZE]]

    def state_size(self, segments):
        """Length of the state array of so many segments in all lines together."""
        lines = len(self.structure.lines)
        return lines * at.state_size(0) + at.state_size(segments) - at.state_size(0)

    def start(self):
        """Find the first shapes of all lines. Returns what is wrong, or None."""
        self._give()
        result = self.kernels.initialize(*self._fixed, *self._changing)
        if result != status.OK:
            return sentence(result, 0.0, self, self.structure.lines, self.structure.free, at_start=True)
        self._warned = [0] * len(self._counts)
        self._show()
        return None

    def advance(self, step):
        """Do a communication step of `step` [s] with the inputs at its start. Returns what is wrong, or None."""
        self._give()
        result = self.kernels.advance(*self._fixed, step, *self._changing)
        if result != status.OK:
            return sentence(result, step, self, self.structure.lines, self.structure.free)
        self._show()
        return None

    def take_outputs(self):
        """Compute the outputs that belong to the state; returns the status."""
        plan, parameters, _ = self._fixed
        state, _, outputs, work = self._changing
        result = self.kernels.outputs(plan, parameters, state, outputs, work)
        if result == status.OK:
            self._show()
        return result

    def take(self, state):
        """Continue from a state, an array of its size; there is no second warning of what was implausible in it.

        ValueError, and nothing is changed, if it says so in numbers that no state has.
        """
        own = [state[first:end] for first, end in self._parts()]
        for each in own:
            check_state(each)
        self._warned = [warned | plausibility.kinds(each) for warned, each in zip(self._warned, own, strict=True)]
        self.state[:] = state

    def warnings(self):
        """Sentences on what has been implausible since the start, each once, with the name of its line."""
        said = []
        for k, ((first, end), line) in enumerate(zip(self._parts(), self.structure.lines, strict=True)):
            if self.state[first + at.WARNINGS] != self._warned[k]:
                own = self.state[first:end]
                said += [f"the line {line.name}: {each}" for each in plausibility.sentences(own, self._warned[k])]
                self._warned[k] |= plausibility.kinds(own)
        return said

    def _parts(self):
        """First place of the state of each line, and the place behind it."""
        return zip(self._states_at[:-1], self._states_at[1:], strict=True)

    def _give(self):
        """Put the values of the inputs into the array of the kernels."""
        given, values = self.inputs, self.values
        for place, reference in self._inputs_from:
            given[place] = values[reference]

    def _show(self):
        """Put the outputs of the kernels into the values."""
        values, found, state = self.values, self.outputs, self.state
        for reference, place in self._alone:
            values[reference] = found[place]
        for reference, those in self._sums:
            values[reference] = sum(found[place] for place in those)
        for reference, place in self._motion:
            values[reference] = state[place]
