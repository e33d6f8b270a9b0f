"""Every client gets the numbers of FMPy, to the last bit: all outputs, Real and Integer, at the start and after each step.

FMPy, which steps by 0.02 s, is the measure. A client that rounds the size of its steps is compared with FMPy that does the
same steps.
"""

from importlib.util import find_spec

import pytest

from isolation import own_process
from runtime import clients
from runtime.clients import different
from runtime.host import of_every_flavour
from tetherfmu.export.archive import SLAVES
from tetherfmu.runtime.variants import VARIANTS, class_name

# a rounded step is wrong by 2e-13 of it; what the solvers make of that was found, with a margin of three
ROUNDED = {
    "TetherStraight": 1e-14,
    "TetherCatenary": 3e-14,
    "TetherQuasiSteady": 2e-11,
    "TetherDynamic": 4e-11,
    "TetherDynamicFree": 2e-11,
}


@of_every_flavour("name")
def test_simulate_fmu_of_fmpy(fmu_folder, name):
    """It takes the size of a step from the difference of times."""
    path = fmu_folder / f"{name}.fmu"
    expected = clients.expected_of(path, "DIFFERENCES")
    assert different(own_process(clients.fmpy_simulate, path=path), expected) == []


@pytest.mark.parametrize("name", list(SLAVES))
@pytest.mark.parametrize("steps", ["DIFFERENCES", "NANOSECONDS"])
def test_rounded_steps(fmu_folder, name, steps):
    """How much the rounding of a client changes."""
    path = fmu_folder / f"{name}.fmu"
    found, expected = clients.expected_of(path, steps), clients.expected_of(path)
    assert clients.difference(found, expected) < ROUNDED[name]


def test_fmpy_in_several_threads(fmu_folder):
    """How it calls an FMU is a matter of PythonFMU's library, which all have."""
    path = fmu_folder / "TetherDynamicFree.fmu"
    expected = clients.expected_of(path)
    results = own_process(clients.fmpy_in_threads, path=path, count=4)
    assert [different(result, expected) for result in results] == [[]] * 4


@of_every_flavour("name")
def test_libcosim(fmu_folder, name):
    """It takes the size of a step from the difference of times in whole nanoseconds."""
    pytest.importorskip("libcosimpy", reason="libcosimpy has no wheel for this platform or this Python")
    path = fmu_folder / f"{name}.fmu"
    expected = clients.expected_of(path, "NANOSECONDS")
    assert different(own_process(clients.libcosim, path=path), expected) == []


@pytest.mark.skipif(find_spec("ecospy") is None, reason="ecospy is for 64-bit Linux")
@of_every_flavour("name")
def test_ecos(fmu_folder, name):
    path = fmu_folder / f"{name}.fmu"
    assert different(own_process(clients.ecos_step_by_step, path=path), clients.expected_of(path)) == []


@of_every_flavour("name", ["TetherDynamicFree"])  # those with driven ends: in the next test
def test_container_of_one_tether(fmu_folder, tmp_path, name):
    path = fmu_folder / f"{name}.fmu"
    expected = clients.expected_of(path)
    assert different(own_process(clients.container, paths=[path], folder=tmp_path), expected) == []


@pytest.mark.parametrize("mt", [False, True], ids=["one thread", "a thread for each"])
def test_container_of_all_tethers(fmu_folder, tmp_path, mt):
    """All with driven ends side by side in one process, with common inputs and parameters."""
    paths = [fmu_folder / f"{class_name(variant)}.fmu" for variant in VARIANTS]
    found = own_process(clients.container, paths=paths, folder=tmp_path, mt=mt)
    for path in paths:
        expected = clients.expected_of(path)
        result = {name: found[f"{path.stem}.{name}"] for name in expected}
        assert different(result, expected) == []
