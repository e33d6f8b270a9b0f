"""A small FMPy host for tests: variables by name, messages kept, states as bytes; and its flight on the circle."""

import atexit
import functools
import math
import shutil
from functools import lru_cache
from zipfile import is_zipfile

import pytest
from fmpy import extract, read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

from scenes import circle, kite_at_start, kite_inputs
from tetherfmu.export.archive import SLAVES

STEP = 0.02  # [s]
every_flavour = pytest.mark.parametrize("fmu_folder", ["pythonfmu", "native"], indirect=True)
SHELLS = ("TetherCatenary", "TetherDynamicFree")  # native FMUs share their shell, but for nodes and a free kite


def of_every_flavour(argument, names=tuple(SLAVES)):
    """Parametrize a test by the folder and by the name of an FMU: all of PythonFMU's, and some of the native ones."""
    pairs = [("pythonfmu", name) for name in names] + [("native", name) for name in names if name in SHELLS]
    return pytest.mark.parametrize(("fmu_folder", argument), pairs, indirect=["fmu_folder"])


@lru_cache
def description_of(path):
    """Model description of an FMU, which FMPy validates while it reads; many instances of a test share it."""
    return read_model_description(str(path))


def names_of(host, causality):
    """Names of the variables of a causality."""
    return [variable.name for variable in host.description.modelVariables if variable.causality == causality]


class Host:
    """One instance of an FMU.

    path : of the FMU, or of a folder where it was extracted before.
    Attributes: `messages` (list of str) as they were logged, `fmu` (fmpy's slave), `description`, `name`, `folder`, `native`
    (whether it runs without Python).
    """

    def __init__(self, path, name="tether"):
        self.description = description_of(path)
        self.name = self.description.modelName
        self.folder = extract(str(path)) if is_zipfile(path) else path
        self.reference = {variable.name: variable.valueReference for variable in self.description.modelVariables}
        self.kind = {variable.name: variable.type for variable in self.description.modelVariables}
        self.real_outputs = [
            v.valueReference for v in self.description.modelVariables if v.causality == "output" and v.type == "Real"
        ]
        self.messages = []
        self._callbacks = fmi2CallbackFunctions()
        self._callbacks.logger = fmi2CallbackLoggerTYPE(self._log)
        self.fmu = FMU2Slave(
            guid=self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.fmu.instantiate(callbacks=self._callbacks, loggingOn=True)
        self.native = not self.description.coSimulation.needsExecutionTool
        self._finalize = None
        if not self.native:
            self._finalize = self.fmu.dll.finalizePythonInterpreter
            atexit.register(self._finalize)  # a process that ends with the library loaded would crash
        self.time = 0.0

    def _log(self, environment, instance, status, category, message):
        self.messages.append(message.decode("utf-8"))

    def start(self, tolerance=None, **values):
        """Set values and initialize."""
        self.fmu.setupExperiment(startTime=0.0, tolerance=tolerance)
        self.fmu.enterInitializationMode()
        self.set(**values)
        self.fmu.exitInitializationMode()
        return self

    def set(self, **values):
        """Set variables; a vector sets name[1], name[2], ..."""
        for name, value in values.items():
            names = [name] if name in self.reference else [f"{name}[{i + 1}]" for i in range(3)]
            numbers = [value] if name in self.reference else list(value)
            references = [self.reference[each] for each in names]
            if self.kind[names[0]] == "Real":
                self.fmu.setReal(references, numbers)
            else:
                self.fmu.setInteger(references, numbers)

    def get(self, name):
        """Value of a variable, or the list of a vector."""
        if name in self.reference:
            read = self.fmu.getReal if self.kind[name] == "Real" else self.fmu.getInteger
            return read([self.reference[name]])[0]
        return self.fmu.getReal([self.reference[f"{name}[{i + 1}]"] for i in range(3)])

    def all_outputs(self):
        """All Real outputs."""
        return self.fmu.getReal(self.real_outputs)

    def step(self, step, **values):
        """Set inputs and do a communication step."""
        self.set(**values)
        self.fmu.doStep(self.time, step)
        self.time += step

    def refuses(self, action, words):
        """Do what must be refused in words: a native FMU does so at once, PythonFMU's can only refuse the next step."""
        self.messages.clear()
        if not self.native:
            action()
            assert words in self.messages[-1], self.messages
            action = functools.partial(self.fmu.doStep, self.time, 0.02)
        with pytest.raises(FMICallException):
            action()
        assert words in self.messages[-1], self.messages

    def free(self):
        """Free the instance; the library stays loaded."""
        self.fmu.fmi2FreeInstance(self.fmu.component)

    def close(self):
        """Terminate, free and remove the extracted files."""
        if self._finalize:
            atexit.unregister(self._finalize)  # fmpy unloads the library
        self.fmu.terminate()
        self.fmu.freeInstance()
        shutil.rmtree(self.folder, ignore_errors=True)


def blob_of(host):
    """The state of now as bytes."""
    state = host.fmu.getFMUState()
    blob = host.fmu.serializeFMUstate(state)
    host.fmu.freeFMUState(state)
    return blob


def restore(host, blob):
    """Go back to a state of `blob_of`."""
    state = host.fmu.deSerializeFMUstate(blob)
    host.fmu.setFMUState(state)
    host.fmu.freeFMUState(state)


def count_of(host):
    """Number of FMI values in a state."""
    return 1 + max(host.reference.values())


def started(path):
    """An instance that is about to fly the circle."""
    host = Host(path)
    kite = kite_at_start(host.name, *circle(0.0))
    return host.start(initial_length=525.0, **kite, wind_velocity=(5.0, 1.0, 0.0), tolerance=1e-5)


def fly(host, begin, end):
    """Outputs after each step on the circle."""
    rows = []
    for k in range(begin, end):
        host.time = k * STEP
        host.step(STEP, **kite_inputs(host.name, *circle(k * STEP)), reel_out_speed=0.5 * math.sin(k))
        rows.append(host.all_outputs())
    return rows
