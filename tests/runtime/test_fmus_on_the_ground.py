"""Tethers on the ground, in FMUs: the flight of the Python API to the last bit; states continue bit for bit."""

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from isolation import in_shared_process
from runtime.host import STEP, Host, blob_of, every_flavour, flown_in_python, of_every_flavour, restore
from scenes import kite_at_start, kite_inputs
from tetherfmu.export.archive import SLAVES

GROUNDS = {
    "friction": {},
    "no friction, soft": {"ground_friction": 0.0, "ground_sink": 0.02},
    "below the station": {"ground_height": -4.0},
    "fixed steps": {"fixed_step": 0.005},
    "a winch that holds 30 N": {"winch_control": 2},
}
GIVEN = {"initial_length": 60.0, "segments": 10, "ground_contact": 2, "relative_tolerance": 1e-5}


def motion(k):
    """A kite that comes down and drags: position [m] and velocity [m/s]."""
    time = k * STEP
    return np.array((45.0 + 2.0 * time, time, 12.0 - 4.0 * time)), np.array((2.0, 1.0, -4.0))


def started(path, ground):
    host = Host(path)
    return host.start(**GIVEN, **ground, **kite_at_start(host.name, *motion(0)), winch_force=30.0)


def fly(host, begin, end):
    """All outputs after each step, as dicts."""
    rows = []
    for k in range(begin, end):
        host.time = k * STEP
        host.step(STEP, **kite_inputs(host.name, *motion(k)))
        rows.append(host.outputs())
    return rows


def rows_in_python(name, ground, steps):
    """The same rows of the Python API."""
    import tetherfmu

    tether = getattr(tetherfmu, name)(**GIVEN, **ground, shape_points=21)  # as FMUs have
    tether.initialize(*motion(0), winch_force=30.0 if ground.get("winch_control") == 2 else None)
    return flown_in_python(tether, steps, lambda k: kite_inputs(name, *motion(k)))


@every_flavour
@pytest.mark.parametrize("name", list(SLAVES))
@in_shared_process
def test_the_flight_of_the_python_api(fmu_folder, name):
    touched = {}
    for ground, values in GROUNDS.items():
        expected = rows_in_python(name, values, 25)
        for found, row in zip(fly(started(fmu_folder / f"{name}.fmu", values), 0, 25), expected, strict=True):
            assert {each: np.ravel(value).tolist() for each, value in found.items()} == {k: row[k] for k in found}, ground
        touched[ground] = max(row["grounded_length"][0] for row in expected)
    held = touched.pop("a winch that holds 30 N")  # at once, which pulls a tether without waves off the ground
    if name == "TetherStraight":  # which ignores the ground
        assert max(*touched.values(), held) == 0.0
    else:
        assert min(touched.values()) > 5.0


@of_every_flavour("fmu")
@in_shared_process
def test_states_continue(fmu_folder, fmu):
    host = started(fmu_folder / f"{fmu}.fmu", {})
    fly(host, 0, 10)
    blob = blob_of(host)
    rest = fly(host, 10, 20)
    another = Host(fmu_folder / f"{fmu}.fmu", "another")
    restore(another, blob)
    assert fly(another, 10, 20) == rest


@of_every_flavour("fmu")
@in_shared_process
def test_a_ground_without_gravity_is_refused(fmu_folder, fmu):
    host = Host(fmu_folder / f"{fmu}.fmu")
    with pytest.raises(FMICallException):
        host.start(ground_contact=2, gravity=0.0, **kite_at_start(host.name, *motion(0)))
    said = "ground_contact is flat; it needs a gravity above 0, for ground_sink is a depth under weight"
    assert any(said in message for message in host.messages)
