"""Every client gets the numbers of FMPy, to the last bit: all outputs, Real and Integer, at the start and after each step.

FMPy, which steps by 0.02 s, is the measure. A client that rounds the size of its steps is compared with FMPy that does the
same steps.
"""

from importlib.util import find_spec

import numpy as np
import pytest
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Slave

from isolation import in_own_process, own_process
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


# --- vectors of FMI 3 in containers: a free tether whose kite moves a second tether


STEP, STEPS = 0.02, 50
GIVER, TAKER, PASSED = "TetherDynamicFree", "TetherDynamic", ("kite_position", "kite_velocity")


def container(folder, version):
    """Path of the container of two FMUs for FMI 3, itself for another version of FMI."""
    from fmu_manipulation_toolbox.container import FMUContainer

    built = FMUContainer("pair", folder, fmi_version=version)
    for name in (GIVER, TAKER):
        built.get_fmu(f"{name}.fmu")
    for name in PASSED:
        built.add_link(f"{GIVER}.fmu", name, f"{TAKER}.fmu", name)
    built.add_input("wind_velocity", f"{GIVER}.fmu", "wind_velocity")
    for fmu, name in ((TAKER, "kite_force"), (GIVER, "kite_position")):
        built.add_output(f"{fmu}.fmu", name, name)
    built.make_fmu(folder / "pair.fmu", step_size=STEP)
    return folder / "pair.fmu"


def copied(fmi3_folder, folder):
    """The folder with both FMUs."""
    for name in (GIVER, TAKER):
        (folder / f"{name}.fmu").symlink_to(fmi3_folder / f"{name}.fmu")
    return folder


def by_hand(folder):
    """Force on the second kite and position of the first one after each step, array (steps, 6), by a Jacobi master."""
    slaves, references = {}, {}
    for name in (GIVER, TAKER):
        path = str(folder / f"{name}.fmu")
        described = read_model_description(path)
        slave = FMU3Slave(
            guid=described.guid, unzipDirectory=extract(path), modelIdentifier=name, instanceName=name, fmiCallLogger=None
        )
        slave.instantiate()
        slave.enterInitializationMode(startTime=0.0)
        slaves[name], references[name] = slave, {each.name: each.valueReference for each in described.modelVariables}

    def get(name, variable):
        return slaves[name].getFloat64([references[name][variable]], 3)

    def passed():
        for variable in PASSED:
            slaves[TAKER].setFloat64([references[TAKER][variable]], get(GIVER, variable))

    rows = []
    passed()
    for slave in slaves.values():
        slave.exitInitializationMode()
    for k in range(STEPS):
        passed()
        for slave in slaves.values():
            slave.doStep(k * STEP, STEP)
        rows.append([*get(TAKER, "kite_force"), *get(GIVER, "kite_position")])
    return np.array(rows)


@in_own_process
def test_vectors_in_a_container_for_fmi_3(fmi3_folder, tmp_path):
    """They are linked and shown whole, and the numbers are those of a master that passes them."""
    path = container(copied(fmi3_folder, tmp_path), 3)
    found = simulate_fmu(str(path), stop_time=STEPS * STEP, output_interval=STEP, validate=False)
    rows = np.hstack([found["kite_force"], found["kite_position"]])[1:]
    assert len(rows) == STEPS
    np.testing.assert_array_equal(rows, by_hand(tmp_path))


@in_own_process
def test_a_container_for_fmi_2_has_no_vectors(fmi3_folder, tmp_path):
    """It reads one number of three, which the tether refuses: no wrong number comes out."""
    path = container(copied(fmi3_folder, tmp_path), 2)
    with pytest.raises(FMICallException):
        simulate_fmu(str(path), stop_time=STEP, output_interval=STEP, validate=False)
