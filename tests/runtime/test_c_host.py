"""A host written in C, with the library of Python preloaded, gets the numbers of FMPy to the last bit in all it does."""

import shutil

import pytest

from isolation import own_process
from runtime import clients
from tetherfmu.export.archive import SLAVES

FLIGHTS = {  # plan: what the flights are that it prints
    "alone": ["alone"],
    "interleaved": ["first", "second"],
    "threads": ["each in a thread of its own"] * 4,
    "relay": ["every step in a new thread"],
    "states": ["alone", "state set back", "state set in another instance", "reset"],
}


# the kernels and states of all FMUs; how they are called is PythonFMU's and the slave's matter, which all share
EACH = [*((name, "states") for name in SLAVES), *(("TetherDynamicFree", plan) for plan in FLIGHTS if plan != "states")]


@pytest.mark.parametrize(("name", "plan"), EACH)
def test_c_host(c_host_program, fmu_folder, tmp_path, name, plan):
    path = fmu_folder / f"{name}.fmu"
    expected = clients.expected_of(path)
    results = clients.c_host(c_host_program, path, tmp_path, plan)
    assert [clients.different(result, expected) for result in results] == [[] for _ in FLIGHTS[plan]]


def test_container_in_a_c_host(c_host_program, fmu_folder, tmp_path):
    """A container of two tethers: their libraries are loaded by one that knows nothing of Python."""
    paths = [fmu_folder / "TetherStraight.fmu", fmu_folder / "TetherDynamic.fmu"]
    built = clients.build_container(paths, tmp_path)
    expected = own_process(clients.fmpy, path=built)
    (result,) = clients.c_host(c_host_program, built, tmp_path, "alone", "unload")
    assert clients.different(result, expected) == []


@pytest.mark.parametrize("plan", ["threads", "states"])
def test_native_fmu(c_host_program, native_folder, tmp_path, plan):
    path = native_folder / "TetherDynamicFree.fmu"
    expected = clients.expected_of(path)
    results = clients.c_host(c_host_program, path, tmp_path, plan, "unload")
    assert [clients.different(result, expected) for result in results] == [[] for _ in FLIGHTS[plan]]


@pytest.mark.skipif(shutil.which("valgrind") is None, reason="valgrind is not installed")
def test_native_fmu_under_valgrind(c_host_program, native_folder, tmp_path):
    """Two instances, states, a reset: no error and no loss."""
    kinds = "--errors-for-leak-kinds=definite,possible"
    valgrind = ("valgrind", "--quiet", "--error-exitcode=9", "--leak-check=full", kinds)
    path = native_folder / "TetherStraight.fmu"
    results = clients.c_host(c_host_program, path, tmp_path, "states", "stay", under=valgrind)
    assert [clients.different(result, results[0]) for result in results] == [[]] * 4
