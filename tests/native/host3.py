"""A small FMPy host for FMI 3: variables by name, arrays as lists, messages kept."""

from math import prod
from zipfile import is_zipfile

from fmpy import extract, read_model_description
from fmpy.fmi3 import FMU3Slave


class Host3:
    """One instance of an FMU for FMI 3.

    path : of the FMU, or of a folder where it was extracted before.
    Attributes: `messages`, `fmu` (FMPy's slave), `description`, `variables` (by name), `flags` that the last step returned.
    """

    def __init__(self, path, name="tether"):
        self.folder = extract(str(path)) if is_zipfile(path) else path
        self.description = read_model_description(self.folder)
        self.variables = {variable.name: variable for variable in self.description.modelVariables}
        self.messages = []
        self.fmu = FMU3Slave(
            guid=self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.fmu.instantiate(logMessage=self._hear)
        self.time = 0.0

    def _hear(self, environment, status, category, message):
        self.messages.append(message.decode("utf-8"))

    def start(self, **values):
        """Set values and initialize."""
        self.fmu.enterInitializationMode()
        self.set(**values)
        self.fmu.exitInitializationMode()
        return self

    def size(self, name):
        """Number of values of a variable."""
        return prod(int(dimension.start) for dimension in self.variables[name].dimensions)

    def _type(self, name):
        kind = self.variables[name].type
        return "Int64" if kind == "Enumeration" else kind

    def set(self, **values):
        """Set variables: numbers, or lists of numbers."""
        for name, value in values.items():
            numbers = [value] if self.size(name) == 1 else list(value)
            getattr(self.fmu, f"set{self._type(name)}")([self.variables[name].valueReference], numbers)

    def get(self, name):
        """Value of a variable: a number, or the list of an array."""
        read = getattr(self.fmu, f"get{self._type(name)}")
        values = read([self.variables[name].valueReference], self.size(name))
        return values if self.variables[name].dimensions else values[0]

    def outputs(self):
        """All outputs, by name."""
        return {each.name: self.get(each.name) for each in self.description.modelVariables if each.causality == "output"}

    def step(self, step, **values):
        """Set inputs and do a communication step."""
        self.set(**values)
        self.flags = self.fmu.doStep(self.time, step)
        self.time += step
