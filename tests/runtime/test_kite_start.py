"""FMUs whose free kite starts in equilibrium: the numbers of the Python API, states, a reset, refusals."""

import pytest

from isolation import in_own_process
from runtime.host import STEP, Host, blob_of, flown_in_python, restore
from tetherfmu import TetherDynamicFree

CRANE = {"initial_length": 40.0, "segments": 8, "kite_mass": 300.0, "kite_start": 2}
INPUTS = {"ground_position": (1.0, 2.0, 50.0), "wind_velocity": (15.0, 3.0, 0.0), "kite_load": (200.0, 0.0, 100.0)}
BEGIN = (1.0, 2.0, 10.0)
STEPS = 10

every_fmu = pytest.mark.parametrize("flavour", ["fmu_folder", "native_folder", "fmi3_folder"])


def started(host):
    return host.start(**CRANE, **INPUTS, initial_kite_position=BEGIN, initial_kite_velocity=(1.0, 2.0, 3.0))


def flown(host):
    rows = []
    for k in range(STEPS):
        host.step(STEP, reel_out_speed=0.1 * k)
        rows.append(host.outputs())
    return rows


@every_fmu
def test_numbers_states_and_reset(request, flavour):
    check(folder=request.getfixturevalue(flavour))


@in_own_process
def check(folder):
    tether = TetherDynamicFree(**CRANE)
    start = tether.initialize(BEGIN, **INPUTS)
    expected = flown_in_python(tether, STEPS, lambda k: {"reel_out_speed": 0.1 * k})
    host = started(Host(folder / "TetherDynamicFree.fmu"))
    assert host.get("kite_position") == start.kite_position.tolist()
    assert host.get("kite_velocity") == [0.0, 0.0, 0.0]
    blob = blob_of(host)
    rows = flown(host)
    for row, one in zip(rows, expected, strict=True):
        assert row["kite_position"] == one["kite_position"]
        assert row["ground_force"] == one["ground_force"]
    restore(host, blob)
    host.time = 0.0
    assert flown(host) == rows
    host.fmu.reset()
    host.time = 0.0
    assert flown(started(host)) == rows


@every_fmu
def test_a_start_without_equilibrium_is_refused(request, flavour):
    check_refusal(folder=request.getfixturevalue(flavour))


@in_own_process
def check_refusal(folder):
    host = Host(folder / "TetherDynamicFree.fmu")
    host.enter_initialization(None)
    host.set(**CRANE, axial_stiffness=1.0, wind_velocity=(100.0, 0.0, 0.0))
    with pytest.raises(Exception, match=r"failed|status|Error"):
        host.fmu.exitInitializationMode()
    assert "no equilibrium was found in which the free kite is at rest" in " ".join(host.messages)
    host.set(axial_stiffness=614600.0, wind_velocity=(0.0, 0.0, 0.0))
