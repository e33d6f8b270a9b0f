"""A winch that is told a force, in FMUs: the flight of the Python API to the last bit; states continue bit for bit."""

import math

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from isolation import in_shared_process
from runtime.host import STEP, Host, blob_of, every_flavour, flown_in_python, of_every_flavour, restore
from scenes import circle, kite_at_start, kite_inputs
from tetherfmu.export.archive import SLAVES

DRUM = {"winch_mass": 50.0, "winch_damping": 20.0, "winch_friction": 30.0}
WINCHES = {
    "no drum": {},
    "friction": {"winch_friction": 30.0},
    "drum": DRUM,
    "drum that stops": {**DRUM, "shortest_length": 499.98, "longest_length": 500.02},
    "no drum, fixed steps": {"fixed_step": 0.005},
    "drum, fixed steps": {**DRUM, "fixed_step": 0.005},
}
GIVEN = {"initial_length": 500.0, "winch_control": 2, "relative_tolerance": 1e-5}
WIND = (5.0, 1.0, 0.0)


def inputs(name, k):
    """Inputs of communication step k: the kite on the circle, a force that swings by a third."""
    return {**kite_inputs(name, *circle(k * STEP)), "winch_force": 400.0 + 130.0 * math.sin(0.6 * k)}


def started(path, winch):
    host = Host(path)
    return host.start(**GIVEN, **winch, **kite_at_start(host.name, *circle(0.0)), wind_velocity=WIND, reel_out_speed=0.3)


def fly(host, begin, end):
    """All outputs after each step, as dicts."""
    rows = []
    for k in range(begin, end):
        host.time = k * STEP
        host.step(STEP, **inputs(host.name, k))
        rows.append(host.outputs())
    return rows


def rows_in_python(name, winch, steps):
    """The same rows of the Python API."""
    import tetherfmu

    tether = getattr(tetherfmu, name)(**GIVEN, **winch)
    tether.initialize(*circle(0.0), wind_velocity=WIND, reel_out_speed=0.3)
    return flown_in_python(tether, steps, lambda k: inputs(name, k))


@every_flavour
@pytest.mark.parametrize("name", list(SLAVES))
@in_shared_process
def test_the_flight_of_the_python_api(fmu_folder, name):
    """And each winch ends with another length."""
    lengths = set()
    for winch, values in WINCHES.items():
        expected = rows_in_python(name, values, 20)
        for found, row in zip(fly(started(fmu_folder / f"{name}.fmu", values), 0, 20), expected, strict=True):
            assert {each: np.ravel(value).tolist() for each, value in found.items()} == {k: row[k] for k in found}, winch
        lengths.add(expected[-1]["tether_length"][0])
    # without waves and a drum, steps change rounding at most
    alike = 0 if name in ("TetherDynamic", "TetherDynamicFree") else 1
    assert len(lengths) >= len(WINCHES) - alike


@of_every_flavour("name")
@pytest.mark.parametrize("winch", ["no drum", "drum that stops", "drum, fixed steps"])
@in_shared_process
def test_a_state_continues_bit_for_bit(fmu_folder, name, winch):
    """From any communication point, in another instance, and after a step that was refused."""
    path = fmu_folder / f"{name}.fmu"
    host, rows, blobs = started(path, WINCHES[winch]), [], []
    for k in range(12):
        blobs.append(blob_of(host))
        rows += fly(host, k, k + 1)
    for k in (9, 2, 6):
        restore(host, blobs[k])
        assert blob_of(host) == blobs[k]
        with pytest.raises(FMICallException):
            host.step(STEP, winch_force=math.nan)
        assert fly(host, k, 12) == rows[k:]
    other = Host(path, "other")
    restore(other, blobs[5])
    assert fly(other, 5, 12) == rows[5:]
