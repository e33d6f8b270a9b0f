"""The slave of a system of tethers: `slave.TetherSlave` around a `SystemInstance`, whose structure is a build option."""

from .kernel_library import SYSTEM
from .parameters import diameter_in_doubt
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
        self.declare(table, self._instance.values, [each.place for each in table], options["step"])

    def start(self):
        """Check the parameters, find the first shapes. Returns what is wrong, or None."""
        if self._no_kernels:
            return self._no_kernels
        try:
            self._instance.set_up(*self._packed(self.values, self._importer_tolerance))
        except ValueError as error:
            return str(error)
        doubts = [diameter_in_doubt(self.values[place]) for place in self._diameters]
        self._doubts = tuple(dict.fromkeys(filter(None, doubts)))
        return self._instance.start()

    def _packed(self, values, tolerance):
        """What `SystemInstance.set_up` takes, from an array of all values; ValueError if one is not allowed."""
        return self._instance.packed(values, tolerance)
