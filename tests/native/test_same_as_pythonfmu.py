"""A native FMU is the one of PythonFMU: the same variables and masses; flights and sentences: `runtime`."""

import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest

from isolation import in_own_process
from runtime.host import Host
from tetherfmu.export.archive import SLAVES

every_fmu = pytest.mark.parametrize("name", list(SLAVES))


def description(path):
    with zipfile.ZipFile(path) as archive:
        return ElementTree.fromstring(archive.read("modelDescription.xml"))


def canonical(element):
    return ElementTree.canonicalize(ElementTree.tostring(element), strip_text=True)


@every_fmu
def test_variables_and_structure(fmu_folder, native_folder, name):
    """All of the description that is about variables, and each capability of PythonFMU's."""
    ours, theirs = (description(folder / f"{name}.fmu") for folder in (native_folder, fmu_folder))
    for part in ("UnitDefinitions", "TypeDefinitions", "ModelVariables", "ModelStructure"):
        assert canonical(ours.find(part)) == canonical(theirs.find(part))
    capable, expected = (each.find("CoSimulation").attrib for each in (ours, theirs))
    assert capable["needsExecutionTool"] == "false"
    assert all(capable[flag] == "true" for flag in expected if flag.startswith("can") and expected[flag] == "true")


@in_own_process
def test_numbers_of_any_diameter(fmu_folder, native_folder):
    """The parameters are packed with the same arithmetic, in C and in Python."""
    for diameter in np.random.default_rng(1).uniform(1e-4, 0.1, 50).tolist():
        given = {"diameter": diameter, "density": 1000.0 / 3.0, "drag_coefficient": 1.0 / 7.0}
        one, other = (Host(folder / "TetherStraight.fmu").start(**given) for folder in (native_folder, fmu_folder))
        assert one.all_outputs() == other.all_outputs()
