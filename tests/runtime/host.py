"""A small FMPy host for tests: variables by name, messages kept, states as bytes; and its flight on the circle."""

import atexit
import compileall
import functools
import math
import pickle
import shutil
from functools import lru_cache
from pathlib import Path
from zipfile import is_zipfile

import pytest
from fmpy import extract, read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Slave

from scenes import circle, kite_at_start, kite_inputs
from tetherfmu.export.archive import SLAVES

STEP = 0.02  # [s]
every_flavour = pytest.mark.parametrize("fmu_folder", ["pythonfmu", "native"], indirect=True)
every_flavour_and_version = pytest.mark.parametrize("fmu_folder", ["pythonfmu", "native", "native_fmi3"], indirect=True)
SHELLS = ("TetherCatenary", "TetherDynamicFree")  # native FMUs share their shell, but for nodes and a free kite


def of_every_flavour(argument, names=tuple(SLAVES), native=None):
    """Parametrize a test by the folder and by the name of an FMU: these of PythonFMU's, and these native ones (or some)."""
    native = [name for name in names if name in SHELLS] if native is None else native
    pairs = [("pythonfmu", name) for name in names] + [("native", name) for name in native]
    return pytest.mark.parametrize(("fmu_folder", argument), pairs, indirect=["fmu_folder"])


@lru_cache
def description_of(path):
    """Model description of an FMU, which FMPy validates while it reads; of those of the fixtures when they are extracted."""
    kept = kept_description(Path(path))
    return pickle.loads(kept.read_bytes()) if kept.exists() else read_model_description(str(path))


def shared_folder(path):
    """Where an FMU of the fixtures is extracted for all tests."""
    return path.parent / "extracted" / path.stem


def kept_description(path):
    """File with what FMPy has read of the model description of an FMU of the fixtures."""
    return path.parent / "extracted" / f"{path.stem}.pickle"


def extract_all(folder):
    """Extract and read all FMUs of a folder, and compile their Python: it would take most of the start of each test."""
    for path in folder.glob("*.fmu"):
        extract(str(path), unzipdir=str(shared_folder(path)))
        kept_description(path).write_bytes(pickle.dumps(read_model_description(str(path))))
    compileall.compile_dir(folder / "extracted", quiet=1)


def names_of(host, causality):
    """Names of the variables of a causality."""
    return [variable.name for variable in host.description.modelVariables if variable.causality == causality]


def reals_of(host, causality):
    """Names of those that are numbers, not Booleans."""
    return [name for name in names_of(host, causality) if host.kind[name] != "Boolean"]


class _Loaded:
    """Slaves of FMPy that look once at the types of all functions, which takes longer than a hundred steps."""

    types = ()  # of each function of FMI: name, names of its arguments, their types, the type that it returns

    def _loadFunctions(self):
        if not self.types:
            super()._loadFunctions()
            found = self._functions.items()
            type(self).types = [(name, each.argnames, each.argtypes, each.restype) for name, each in found]
        for name, argnames, argtypes, restype in self.types:
            function = getattr(self.dll, name)
            function.argnames, function.argtypes, function.restype = argnames, argtypes, restype
            self._functions[name] = function


class FMU2(_Loaded, FMU2Slave):
    """Of FMI 2; FMPy reads the version in the name of the class."""


class FMU3(_Loaded, FMU3Slave):
    """Of FMI 3."""


class Host:
    """One instance of an FMU, with the same calls, names and numbers for FMI 2 and FMI 3.

    A name is that of a scalar, of an element, as kite_force[1] or shape[21,3], or of a whole array, as kite_force or shape,
    whichever of them the version of FMI knows.

    path : of the FMU, or of a folder where it was extracted before.  own_folder : whether the FMU is extracted for this
    instance alone; else those of the fixtures share the folder in which `extract_all` has put them.
    Attributes: `messages` (list of str) as they were logged, `fmu` (fmpy's slave), `description`, `version` (2 or 3),
    `name`, `folder`, `native` (whether it runs without Python), `reference` (value references by name), `real_outputs`
    (those of all outputs and local variables that are real numbers), `flags` that the last step returned (in FMI 3).
    """

    def __new__(cls, path, name="tether", own_folder=False):
        return super().__new__(Fmi3 if description_of(path).fmiVersion.startswith("3") else Fmi2)

    def __init__(self, path, name="tether", own_folder=False):
        self.description = description_of(path)
        self.name = self.description.modelName
        self.folder = path
        self.is_shared = not is_zipfile(path)
        if not self.is_shared:
            self.is_shared = not own_folder and shared_folder(path).is_dir()
            self.folder = str(shared_folder(path)) if self.is_shared else extract(str(path))
        variables = self.description.modelVariables
        self.reference = {variable.name: variable.valueReference for variable in variables}
        self.kind = {variable.name: self.kind_of(variable) for variable in variables}
        outputs = [variable for variable in variables if variable.causality in ("output", "local")]
        self.output_names = list(dict.fromkeys(variable.name.partition("[")[0] for variable in outputs))
        self.elements = {}  # in FMI 2, of arrays: names of the scalars
        for each in self.reference:
            self.elements.setdefault(each.partition("[")[0], []).append(each)
        self.sizes = {}  # in FMI 3, of all variables: numbers of elements along each dimension, none of a scalar
        for variable in variables:
            self.sizes[variable.name] = [int(dimension.start) for dimension in getattr(variable, "dimensions", ())]
        self.real_outputs = [each.valueReference for each in outputs if self.kind[each.name] == self.REAL]
        self.messages = []
        self.fmu = self.SLAVE(
            guid=self.description.guid,
            unzipDirectory=self.folder,
            modelIdentifier=self.description.coSimulation.modelIdentifier,
            instanceName=name,
        )
        self.instantiate()
        self.native = not self.description.coSimulation.needsExecutionTool
        self._finalize = None
        if not self.native:
            self._finalize = self.fmu.dll.finalizePythonInterpreter
            atexit.register(self._finalize)  # a process that ends with the library loaded would crash
        self.time = 0.0

    def log(self, *facts):
        """Keep a message, the last thing that the function of either version gets."""
        self.messages.append(facts[-1].decode("utf-8"))

    def start(self, tolerance=None, **values):
        """Set values and initialize."""
        self.enter_initialization(tolerance)
        self.set(**values)
        self.fmu.exitInitializationMode()
        return self

    def all_outputs(self):
        """Numbers of all outputs that are real."""
        return self.get_reals(self.real_outputs)

    def outputs(self):
        """All outputs, by the names of scalars and whole arrays."""
        return {name: self.get(name) for name in self.output_names}

    def step(self, step, **values):
        """Set inputs and do a communication step."""
        self.set(**values)
        self.flags = self.fmu.doStep(self.time, step)
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

    def refuses_to_start(self, words, **values):
        """Set values with which the initialization must be refused in words."""
        self.enter_initialization(None)
        self.set(**values)
        with pytest.raises(Exception, match=r"[Ff]ailed|status|rror"):
            self.fmu.exitInitializationMode()
        assert words in " ".join(self.messages)

    def free(self):
        """Free the instance; the library stays loaded."""
        getattr(self.fmu, f"fmi{self.version}FreeInstance")(self.fmu.component)

    def close(self):
        """Terminate, free and remove what was extracted for this instance."""
        if self._finalize:
            atexit.unregister(self._finalize)  # fmpy unloads the library
        self.fmu.terminate()
        self.fmu.freeInstance()
        if not self.is_shared:
            shutil.rmtree(self.folder, ignore_errors=True)


class Fmi2(Host):
    """Its arrays are scalars with the names of elements."""

    version, SLAVE, REAL = 2, FMU2, "Real"
    SERIALIZE, DESERIALIZE = "serializeFMUstate", "deSerializeFMUstate"

    @staticmethod
    def kind_of(variable):
        return "Integer" if variable.type == "Enumeration" else variable.type

    def instantiate(self, **options):
        self._callbacks = fmi2CallbackFunctions()
        self._callbacks.logger = fmi2CallbackLoggerTYPE(self.log)
        self.fmu.instantiate(callbacks=self._callbacks, loggingOn=True, **options)

    def enter_initialization(self, tolerance):
        self.fmu.setupExperiment(startTime=0.0, tolerance=tolerance)
        self.fmu.enterInitializationMode()

    def scalars(self, name):
        """Names of the scalars that a name stands for."""
        return [name] if name in self.reference else self.elements[name]

    def set(self, **values):
        """Set variables by name: numbers, or those of an array."""
        for name, value in values.items():
            names = self.scalars(name)
            numbers = [value] if name in self.reference else list(value)
            getattr(self.fmu, f"set{self.kind[names[0]]}")([self.reference[each] for each in names], numbers)

    def get(self, name):
        """Value of a variable, or the list of an array."""
        names = self.scalars(name)
        values = getattr(self.fmu, f"get{self.kind[names[0]]}")([self.reference[each] for each in names])
        return values[0] if name in self.reference else values

    def get_reals(self, references):
        return self.fmu.getReal(references)


class Fmi3(Host):
    """Its arrays are read and set as a whole."""

    version, SLAVE, REAL = 3, FMU3, "Float64"
    SERIALIZE, DESERIALIZE = "serializeFMUState", "deserializeFMUState"

    @staticmethod
    def kind_of(variable):
        return "Int64" if variable.type == "Enumeration" else variable.type

    def instantiate(self, **options):
        self.fmu.instantiate(logMessage=self.log, **options)

    def enter_initialization(self, tolerance):
        self.fmu.enterInitializationMode(tolerance=tolerance)

    def place(self, name):
        """Of an element, as shape[21,3]: the name of its array and its place in the array, both as FMI 3 counts."""
        array, _, indices = name.partition("[")
        place = 0
        for size, index in zip(self.sizes[array], indices.rstrip("]").split(","), strict=True):
            place = place * size + int(index) - 1
        return array, place

    def set(self, **values):
        """Set variables by name: numbers, or those of an array."""
        for name, value in values.items():
            if name not in self.reference:
                name, place = self.place(name)
                numbers = self.get(name)
                numbers[place] = value
            else:
                numbers = list(value) if self.sizes[name] else [value]
            getattr(self.fmu, f"set{self.kind[name]}")([self.reference[name]], numbers)

    def get(self, name):
        """Value of a variable, or the list of an array."""
        if name not in self.reference:
            name, place = self.place(name)
            return self.get(name)[place]
        sizes = self.sizes[name]
        values = list(getattr(self.fmu, f"get{self.kind[name]}")([self.reference[name]], math.prod(sizes)))
        return values if sizes else values[0]

    def get_reals(self, references):
        names = {reference: name for name, reference in self.reference.items()}
        count = sum(math.prod(self.sizes[names[reference]]) for reference in references)
        return list(self.fmu.getFloat64(references, count))


def blob_of(host):
    """The state of now as bytes."""
    state = host.fmu.getFMUState()
    blob = getattr(host.fmu, host.SERIALIZE)(state)
    host.fmu.freeFMUState(state)
    return blob


def restore(host, blob):
    """Go back to a state of `blob_of`."""
    state = getattr(host.fmu, host.DESERIALIZE)(blob)
    host.fmu.setFMUState(state)
    host.fmu.freeFMUState(state)


def count_of(host):
    """Number of FMI values in a state."""
    return 1 + max(host.reference.values())


def started(path, tolerance=1e-5, **start):
    """An instance that is about to fly the circle; tolerance : of the importer.  start : more values."""
    host = Host(path)
    kite = kite_at_start(host.name, *circle(0.0))
    return host.start(initial_length=525.0, **kite, wind_velocity=(5.0, 1.0, 0.0), tolerance=tolerance, **start)


def fly(host, begin, end):
    """Outputs after each step on the circle."""
    rows = []
    for k in range(begin, end):
        host.time = k * STEP
        host.step(STEP, **kite_inputs(host.name, *circle(k * STEP)), reel_out_speed=0.5 * math.sin(k))
        rows.append(host.all_outputs())
    return rows
