"""The slave of a system of tethers: `slave.TetherSlave` around a `SystemInstance`, whose structure is a build option."""

from .kernel_library import SYSTEM
from .slave import TetherSlave
from .system_instance import SystemInstance
from .system_variables import structure_of, table_of


class SystemSlave(TetherSlave):
    """A system of tethers as a PythonFMU slave; `options.json` in its resources says which points and lines it has."""

    library = SYSTEM

    def make(self, options):
        """Make the table of variables and the instance from build options."""
        structure = structure_of(options["system"])
        self.variant, self.modelName = structure.hash, structure.name
        table = table_of(structure)
        self._instance = SystemInstance(self._kernels(), structure, table)
        self._diameters = [self._instance.places[f"{line.name}.diameter"] for line in structure.lines]
        self.declare(table, self._instance.values, [each.place for each in table], options)

    def _first_shape(self):
        """Find the first shapes of all lines. Returns what is wrong, or None."""
        return self._instance.start()

    def _packed(self, values, tolerance):
        """What `SystemInstance.set_up` takes, from an array of all values; ValueError if one is not allowed."""
        return self._instance.packed(values, tolerance)
