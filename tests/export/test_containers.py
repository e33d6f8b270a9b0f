"""Vectors of FMI 3 in containers of fmu-manipulation-toolbox: a free tether whose kite moves a second tether."""

import numpy as np
import pytest
from fmpy import extract, read_model_description, simulate_fmu
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Slave

from isolation import in_own_process

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
