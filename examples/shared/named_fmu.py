"""An FMU whose variables are read and set by name. Helper of the examples."""

from contextlib import ExitStack, contextmanager

import numpy as np

from shared.fmu_tools import all_variables, running


class NamedFmu:
    """An instance; a name is that of a variable, or of a vector with the elements [1], [2], [3]."""

    def __init__(self, variables, instance):
        self.variables, self.fmu, self.found = variables, instance, {}

    def references(self, name):
        """Value references of a variable."""
        if name not in self.found:
            self.found[name] = self.variables.of(name)
        return self.found[name]

    def set(self, **values):
        """Set variables; whole numbers are integers of FMI, texts are strings, all others real numbers."""
        for name, value in values.items():
            if isinstance(value, str):
                self.fmu.setString(self.references(name), [value])
                continue
            put = self.fmu.setInteger if isinstance(value, int) else self.fmu.setReal
            put(self.references(name), np.ravel(value))

    def get(self, name):
        """Value of a variable of real numbers, a vector as an array (3,)."""
        values = np.array(self.fmu.getReal(self.references(name)))
        return values if len(values) > 1 else values[0]

    def step(self, time, step):
        """A communication step [s]."""
        self.fmu.doStep(time, step)

    @contextmanager
    def saved(self):
        """A function that takes the FMU back to where it is now, as often as you like within the block."""
        state = self.fmu.getFMUState()
        yield lambda: self.fmu.setFMUState(state)
        self.fmu.freeFMUState(state)

    def start(self, inputs, **parameters):
        """Initialize with these parameters, and these inputs at the start."""
        self.fmu.setupExperiment(startTime=0.0)
        self.set(**parameters)
        self.fmu.enterInitializationMode()
        self.set(**inputs)
        self.fmu.exitInitializationMode()


@contextmanager
def all_running(fmu_files):
    """A list of `NamedFmu`, one of each file, and a function to call between steps, for Ctrl-C."""
    with ExitStack() as stack:
        fmus, stops = [], []
        for variables in [all_variables(each) for each in fmu_files]:
            instance, stop_if_pressed = stack.enter_context(running(variables.file, variables.description))
            fmus.append(NamedFmu(variables, instance))
            stops.append(stop_if_pressed)
        yield fmus, stops[0]  # the first hears Ctrl-C
