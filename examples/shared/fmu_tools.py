"""What the examples do with a tether FMU, in FMPy: find and load it, look up its variables, end it cleanly."""

import atexit
import tempfile
import zipfile
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

from fmpy import extract, read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import FMU2Slave

from shared import cache
from shared.scalars_of_fmi3 import ScalarsOfFmi3, scalars
from tetherfmu.check.inspection import MADE_BY_PYTHONFMU, crashing_characters
from tetherfmu.console.ending import one_line
from tetherfmu.console.options import file
from tetherfmu.files.lean import scaled
from tetherfmu.files.toml_files import WrongUse
from tetherfmu.libraries.children import ctrl_c_waits
from tetherfmu.runtime.parameters import Tether
from tetherfmu.runtime.quantities import quantities

WIND, WIND_AT = "wind_", "wind_at"  # begins the names of what an FMU with wind at points ignores, and the wind at these
# parameters that make another tether
OF_A_TETHER = tuple(name for name, _ in quantities(Tether) if name not in ("segments", "initial_length"))
SLAVES = {"2.0": FMU2Slave, "3.0": ScalarsOfFmi3}  # by version of FMI


def find_fmu(name, place=None):
    """Path of an FMU in a folder, which is built if it is not there; None: that in dist/, or else one that is kept."""
    file = (place or Path("dist")) / f"{name}.fmu"
    if file.exists():
        return file
    return cache.build(name, place) if place else cache.kept(name)


def description_of(fmu_file):
    """Model description of an FMU for co-simulation, vectors of FMI 3 as their elements; WrongUse if the file is none."""
    try:
        description = read_model_description(str(fmu_file))
    except Exception as error:  # also what zipfile and the readers of XML raise
        raise WrongUse(f"{fmu_file} is not a readable FMU: {one_line(error)}") from None
    if description.fmiVersion not in SLAVES or description.coSimulation is None:
        raise WrongUse(f"{fmu_file} is not an FMU for co-simulation by FMI 2.0 or 3.0")
    if description.fmiVersion == "3.0":
        description.modelVariables = scalars(description.modelVariables)
    return description


class Outputs(NamedTuple):
    """Outputs of an FMU that are read after each step, as numbers."""

    reals: dict  # name -> value reference
    integers: dict
    booleans: dict

    @property
    def names(self):
        """In the order of their values."""
        return [*self.reals, *self.integers, *self.booleans]

    def read(self, fmu):
        """Values, a list."""
        found = fmu.getReal([*self.reals.values()])
        found += fmu.getInteger([*self.integers.values()]) if self.integers else []
        return found + (fmu.getBoolean([*self.booleans.values()]) if self.booleans else [])


class Variables(NamedTuple):
    """The variables of an FMU; `all_variables` reads them."""

    file: Path
    description: Any  # of FMPy
    reference: dict  # name -> value reference, or what stands for it in FMI 3

    def of(self, *names):
        """Value references of variables and of all elements of vectors; WrongUse names one that the FMU lacks or ignores."""
        found = self.those_of(*names)
        is_blown_at_points = len(self.those_of(WIND_AT, "kite_force")) == 2  # a tether, which has the wind as an input
        ignored = [name for name in names if is_blown_at_points and name.startswith(WIND) and name != WIND_AT]
        if ignored:
            raise WrongUse(
                f"{self.file} has inputs {WIND_AT} and ignores {ignored[0]}; take one built without --wind-points"
            )
        for name in names:
            if name not in found:
                points = "with --shape-points 21 and " if name == "shape" else ""
                raise WrongUse(
                    f"{self.file} has no variable {name}; take one of tetherfmu build {points}that has all variables"
                )
        return [reference for references in found.values() for reference in references]

    def outputs(self, more=()):
        """`Outputs`: all of them, and more variables or vectors by name."""
        found = {"Real": {}, "Integer": {}, "Boolean": {}}
        for each in self.description.modelVariables:
            if each.type in found and (each.causality == "output" or each.name.partition("[")[0] in more):
                found[each.type][each.name] = each.valueReference
        return Outputs(*found.values())

    def completed(self, parameters):
        """Values of parameters, dict by name, with the stiffness and damping that a diameter alone scales."""
        if "diameter" not in parameters:
            return parameters
        starts = {each.name: each.start for each in self.description.modelVariables}
        return parameters | scaled(parameters, starts)

    def those_of(self, *names):
        """Dict name -> value references, of the variables and vectors of any size that the FMU has."""
        found = {name: [self.reference[each] for each in self.reference if each.partition("[")[0] == name] for name in names}
        return {name: references for name, references in found.items() if references}


def all_variables(fmu_file):
    """`Variables` of any FMU for co-simulation; WrongUse if the file is none."""
    description = description_of(fmu_file)
    return Variables(fmu_file, description, {each.name: each.valueReference for each in description.modelVariables})


def variables_of(fmu_file, free=False):
    """`Variables` of a tether FMU; WrongUse if the file is none, or has the other kite end.

    free : whether the kite end has to be free; otherwise it has to be driven.
    """
    variables = all_variables(fmu_file)
    if free and "kite_load[1]" not in variables.reference:
        raise WrongUse(f"{fmu_file} has no free kite end: no variable kite_load; take TetherDynamicFree.fmu")
    if not free and "kite_load[1]" in variables.reference:
        raise WrongUse(f"{fmu_file} has a free kite end, whose motion cannot be prescribed; take one with driven ends")
    return variables


def constants_of(fmu_file):
    """Values of what a tether FMU has no variables for, a dict by name; empty of a full one, and of one of another maker."""
    with zipfile.ZipFile(fmu_file) as opened:
        root = ElementTree.fromstring(opened.read("modelDescription.xml"))
    return {each.get("name"): float(each.get("value")) for each in root.iter("Constant")}


def refuse_different(fmu_files, parameters):
    """WrongUse if FMUs of tethers to be compared have different ones, but for what the parameters set, names."""
    known, settled = {}, {*parameters, *(("axial_stiffness", "axial_damping") if "diameter" in parameters else ())}
    for fmu_file in fmu_files:
        starts = {each.name: each.start for each in description_of(fmu_file).modelVariables} | constants_of(fmu_file)
        for name in (each for each in OF_A_TETHER if each in starts and each not in settled):
            value, where = known.setdefault(name, (float(starts[name]), fmu_file))
            if float(starts[name]) != value:
                raise WrongUse(
                    f"{name} is {value:g} in {where} and {float(starts[name]):g} in {fmu_file}: different tethers cannot be "
                    "compared; build both alike, or choose one with --fmu"
                )


def add_fmu(parser, default="those in dist/, or else in a cache of yours"):
    """Add the option --fmu FILE."""
    text = f"a tether FMU of your own, for FMI 2 or 3 (default: {default})"
    parser.add_argument("--fmu", type=file, metavar="FILE", help=text)


class FlightEnded(RuntimeError):
    """A step was refused; flown : what there is until then, arguments of `circular_flight.flight_of`."""

    def __init__(self, said, flown):
        super().__init__(said)
        self.flown = flown


@contextmanager
def running(fmu_file, description):
    """An instance of an FMU and a function to call between its steps, for Ctrl-C; RuntimeError if it refuses something.

    `FlightEnded` if an error of FMPy in it has `flown`.
    """
    try:
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder, ctrl_c_waits() as stop_if_pressed:
            fmu = load(fmu_file, description, folder)
            free = getattr(fmu, f"fmi{description.fmiVersion[0]}FreeInstance")  # not freeInstance, see `load`
            try:
                yield fmu, stop_if_pressed
            except FMICallException as error:
                if hasattr(error, "flown"):  # other FMUs fly after this one
                    free(fmu.component)
                raise
            free(fmu.component)
    except FMICallException as error:
        said = f"{fmu_file}: {str(error).rstrip('.')}; the FMU has said why"
        raise (FlightEnded(said, error.flown) if hasattr(error, "flown") else RuntimeError(said)) from None


def load(fmu_file, description, folder):
    """Extract an FMU to a folder and instantiate it; RuntimeError if its library cannot be loaded here, or would crash.

    When a Python process ends, PythonFMU's library gives its interpreter state back twice, and the process crashes. The
    function called here at exit leaves nothing to give back. It needs the library: never unload it, so end an instance with
    `fmi2FreeInstance` or `fmi3FreeInstance`; FMPy's `freeInstance` unloads. This holds for every library that is loaded.
    """
    name = description.coSimulation.modelIdentifier
    refuse_to_crash(fmu_file, folder)
    try:
        extract(str(fmu_file), folder)
        slave = SLAVES[description.fmiVersion]
        fmu = slave(guid=description.guid, unzipDirectory=folder, modelIdentifier=name, instanceName=name)
        if hasattr(fmu.dll, "finalizePythonInterpreter"):
            atexit.register(fmu.dll.finalizePythonInterpreter)
        fmu.instantiate(loggingOn=not hasattr(fmu.dll, "finalizePythonInterpreter"))  # PythonFMU's are on stderr anyway
    except Exception as error:  # FMPy has no other class for this
        raise RuntimeError(f"{fmu_file} cannot be loaded: {one_line(error)}; try tetherfmu check {fmu_file}") from None
    return fmu


def refuse_to_crash(fmu_file, folder):
    """RuntimeError if an FMU is to be extracted to a folder on whose path PythonFMU's library crashes."""
    characters = crashing_characters(folder)
    with zipfile.ZipFile(fmu_file) as archive:
        made_by_pythonfmu = MADE_BY_PYTHONFMU in archive.namelist()
    if characters and made_by_pythonfmu:
        raise RuntimeError(
            f"{fmu_file} would be extracted to {folder}, and PythonFMU's library crashes on {' '.join(characters)} in that "
            "path; set the variable TMPDIR (TEMP on Windows) to a folder with a plain path, or take a native FMU"
        )
