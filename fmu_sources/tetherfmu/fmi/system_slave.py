"""The slave of a system of tethers: `slave.TetherSlave` with variables that have names and places of their own.

Its structure is a build option; `system_maps` says where its variables stand in the arrays of the lines.
"""

from ..runtime.instance import Instance, zeros
from ..runtime.kernel_library import SYSTEM
from ..runtime.packing import pack_lines
from ..runtime.quantities import NOT_WHOLE, checked
from ..runtime.variables import INPUT, PARAMETER
from . import system_maps
from .slave import TetherSlave
from .system_variables import structure_of, table_of


class SystemSlave(TetherSlave):
    """A system of tethers as a PythonFMU slave; `options.json` in its resources says which points and lines it has."""

    library = SYSTEM

    def make(self, options):
        """Make the table of variables and the instance from build options."""
        self._structure = structure = structure_of(options["system"])
        self.variant, self.modelName = structure.hash, structure.name
        table = table_of(structure)
        self._places = {each.name: each.place for each in table}
        self._diameters = [self._places[f"{line.name}.diameter"] for line in structure.lines]
        self._instance = Instance(self._kernels(), system_maps.lines_of(structure), structure.free, structure.band)
        self._outputs_at = sum(each.causality == INPUT for each in table)
        self._parameters_at = sum(each.causality != PARAMETER for each in table)
        self._checked = [each for each in table if each.causality == PARAMETER]
        self._inputs_from = system_maps.inputs_of(structure, self._places)
        first = self._instance.outputs_at
        found = system_maps.outputs_of(structure, self._places)
        found = [(reference, [first + place for place in those]) for reference, those in found]
        self._sums = [each for each in found if len(each[1]) > 1]
        self._counts, self._motion = (), ()
        self._alone = [(reference, those[0]) for reference, those in found if len(those) == 1]
        self.declare(table, zeros(len(table)), [each.place for each in table], options)

    def _first_shape(self):
        """Find the first shapes of all lines. Returns what is wrong, or None."""
        self._give()
        return self._shown(self._instance.start())

    def advance(self, step):
        """One communication step [s]. Returns what is wrong, or None."""
        self._give()
        return self._shown(self._instance.advance(step))

    def _take_outputs(self):
        """Compute the outputs that belong to the states; returns the status."""
        return self._shown(self._instance.take_outputs())

    def _packed(self, values, tolerance):
        """What `Instance.set_up` takes, from an array of all values; ValueError names the variable that is not allowed."""
        for each in self._checked:
            value = values[each.place]
            checked(each.name, int(value) if each.kind != "Real" and value.is_integer() else value, each.quantity)
            if each.kind != "Real" and not value.is_integer():
                raise ValueError(NOT_WHOLE.format(name=each.name, value=value))
        lines = system_maps.packed_of(self._structure, self._places, values)
        sought = system_maps.sought(self._structure, self._places, values)
        return *pack_lines(self._instance.kernels, lines, tolerance), sought

    def _give(self):
        """Put the values of the inputs into the array of the kernels."""
        given, values = self._instance.values, self.values
        for place, reference, _, _ in self._inputs_from:
            given[place] = values[reference]

    def _shown(self, problem):
        """Put the outputs of the kernels into the values, if nothing is wrong; returns what is."""
        if problem:
            return problem
        values, found, state = self.values, self._instance.values, self._instance.state
        for reference, place in self._alone:
            values[reference] = found[place]
        for reference, those in self._sums:
            values[reference] = sum(found[place] for place in those)
        for reference, place in self._motion_of(self._instance.counts):
            values[reference] = state[place]
        return problem

    def _motion_of(self, counts):
        """Pairs of value reference and place in the state of the motion of free points, with these numbers of segments."""
        if self._counts != counts:
            self._counts = counts
            self._motion = system_maps.motion_of(self._structure, self._places, counts, self._instance.states_at)
        return self._motion
