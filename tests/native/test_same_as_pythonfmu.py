"""A native FMU is the one of PythonFMU: the same variables and sentences; numbers: `runtime/test_flavours.py`."""

import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest

from isolation import own_process
from native import flights
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


@every_fmu
def test_sentences(fmu_folder, native_folder, name):
    """The same words and the same digits, which C and Python write in different ways."""
    found, expected = (own_process(flights.said, path=folder / f"{name}.fmu") for folder in (native_folder, fmu_folder))
    assert found == expected
    assert sum(map(len, expected)) >= len(flights.MISUSES) - 6  # parameters that a tether ignores


def test_numbers_of_any_diameter(fmu_folder, native_folder):
    """The parameters are packed with the same arithmetic, in C and in Python."""
    diameters = np.random.default_rng(1).uniform(1e-4, 0.1, 50).tolist()
    paths = [folder / "TetherStraight.fmu" for folder in (native_folder, fmu_folder)]
    found, expected = (own_process(flights.masses, path=path, diameters=diameters) for path in paths)
    assert found == expected
