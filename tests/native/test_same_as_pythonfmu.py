"""A native FMU is the one of PythonFMU: the same variables, numbers to the last bit, states and sentences."""

import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest

from isolation import own_process
from native import flights
from runtime import clients
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
def test_circle_with_reeling(fmu_folder, native_folder, name):
    found, expected = (own_process(clients.fmpy, path=folder / f"{name}.fmu") for folder in (native_folder, fmu_folder))
    assert clients.different(found, expected) == []


def test_closed_loop(fmu_folder, native_folder):
    name = "TetherDynamicFree.fmu"
    found, expected = (own_process(flights.closed_loop, path=each / name, steps=500) for each in (native_folder, fmu_folder))
    assert found == expected


@pytest.mark.parametrize("ways", [("pythonfmu", "native"), ("native", "pythonfmu")], ids=["to native", "from native"])
@every_fmu
def test_states_go_from_one_to_the_other(fmu_folder, native_folder, name, ways):
    """The bytes are the same, and the flight goes on to the last bit."""
    paths = {"pythonfmu": fmu_folder / f"{name}.fmu", "native": native_folder / f"{name}.fmu"}
    blob, expected = own_process(flights.first_half, path=paths[ways[0]])
    again, found = own_process(flights.second_half, path=paths[ways[1]], blob=blob)
    assert found == expected
    assert again == blob


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
