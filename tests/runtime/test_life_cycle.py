"""One FMU through its life: equals the Python API, state, reset, variable steps, several instances."""

import numpy as np
import pytest

from isolation import in_shared_process
from runtime.host import Host, every_flavour, of_every_flavour
from scenes import REVOLUTION, circle, kite_at_start, kite_inputs
from tetherfmu.python import models
from tetherfmu.python.models import TetherDynamic
from tetherfmu.runtime.parameters import Solver, Tether

WIND = (0.1, 0.0, 0.0)
every_shell = pytest.mark.parametrize("fmu_folder", ["pythonfmu", "native", "native_fmi3"], indirect=True)


def fly(host, steps, step=0.02, begin=0):
    for k in range(begin, begin + steps):
        host.step(step, **kite_inputs(host.name, *circle(k * step)))
    return host.all_outputs()


def started(path, **values):
    host = Host(path)
    start = {"initial_length": 525.0, **kite_at_start(host.name, *circle(0.0)), "wind_velocity": WIND}
    return host.start(**{**start, **values})


@of_every_flavour("name")
@in_shared_process
def test_fmu_equals_the_python_api_bit_for_bit(fmu_folder, name):
    """Both call the same library; `libraries/test_same_bits.py` compares it with kernels compiled in another way."""
    host = started(fmu_folder / f"{name}.fmu")
    tether = getattr(models, name)(Tether(initial_length=525.0))
    position, velocity = circle(0.0)
    outputs = tether.initialize(position, velocity, wind_velocity=WIND)
    assert host.get("kite_force") == list(outputs.kite_force)
    for k in range(round(REVOLUTION / 0.02)):
        inputs = kite_inputs(name, *circle(0.02 * k))
        host.step(0.02, **inputs)
        outputs = tether.step(0.02, **inputs, wind_velocity=WIND)
        assert host.get("kite_force") == list(outputs.kite_force)
    moving = ("kite_position", "kite_velocity") if name == "TetherDynamicFree" else ()
    for field in ("ground_force", "kite_force", *moving):
        assert host.get(field) == list(getattr(outputs, field))
    for field in ("ground_tension", "kite_tension", "max_tension", "tether_length", "ground_elevation", "ground_azimuth"):
        assert host.get(field) == getattr(outputs, field)
    for field in ("slack_segments", "kite_end_mass", "kite_stiffness", "kite_damping", "wave_time", "sag"):
        assert host.get(field) == getattr(outputs, field)
    for name, count in tether.counters.items():
        assert host.get(f"solver_{name}") == getattr(outputs, f"solver_{name}") == count
    assert [host.get(f"shape[{k + 1},3]") for k in range(21)] == list(outputs.shape[:, 2])
    host.close()


@every_shell
@in_shared_process
def test_importers_tolerance_and_own_tolerance(fmu_folder):
    """A tolerance of 0 takes the importer's where that is tighter than the default; another one wins."""
    path = fmu_folder / "TetherDynamic.fmu"
    options = (
        {"tolerance": 1e-8},
        {"tolerance": 1e-2, "relative_tolerance": 1e-8},
        {},
        {"tolerance": 1e-3},
        {"tolerance": 0.5},
        {"relative_tolerance": 1e-3},
    )
    results = [fly(started(path, initial_shape=1, **option), 20) for option in options]  # at rest, so not at ease
    assert results[0] == results[1]
    assert results[0] != results[2]
    assert results[2] == results[3] == results[4]
    assert results[2] != results[5]


@every_shell
@in_shared_process
def test_a_tolerance_that_is_none_is_said(fmu_folder):
    """A warning, with which the run goes on as without a tolerance."""
    path = fmu_folder / "TetherDynamic.fmu"
    expected = fly(started(path), 20)
    for tolerance in (-1e-6, 0.0, float("nan")):
        host = started(path, tolerance=tolerance)
        assert any("is not used; it must be greater than 0" in text for text in host.messages), tolerance
        assert fly(host, 20) == expected


@of_every_flavour("name")
@in_shared_process
def test_state_is_restored_bit_for_bit(fmu_folder, name):
    host = started(fmu_folder / f"{name}.fmu")
    fly(host, 50)
    state = host.fmu.getFMUState()
    blob = host.fmu.serializeFMUstate(state)
    time = host.time
    expected = fly(host, 50, begin=50)
    host.fmu.setFMUState(state)
    host.time = time
    assert fly(host, 50, begin=50) == expected
    other = Host(fmu_folder / f"{name}.fmu", "other").start()
    other.fmu.setFMUState(other.fmu.deSerializeFMUstate(blob))
    other.time = time
    assert fly(other, 50, begin=50) == expected
    host.fmu.freeFMUState(state)


@of_every_flavour("name")
@in_shared_process
def test_reset_equals_a_fresh_instance(fmu_folder, name):
    host = started(fmu_folder / f"{name}.fmu")
    fresh = fly(host, 30)
    host.fmu.reset()
    host.time = 0.0
    host.start(initial_length=525.0, **kite_at_start(name, *circle(0.0)), wind_velocity=WIND)
    assert fly(host, 30) == fresh


@every_flavour
@in_shared_process
def test_steps_of_any_length_lead_to_the_same_motion(fmu_folder):
    """Held ends: how the time is cut changes the result by the solver's tolerance only."""
    values = {"kite_position": (300.0, 0.0, 400.0), "wind_velocity": (5.0, 0.0, 0.0), "initial_shape": 3}
    results = []
    for steps in (np.full(100, 0.02), np.full(8, 0.25), [0.013, 0.9, 0.001, 0.5, 0.586]):
        host = Host(fmu_folder / "TetherDynamic.fmu").start(relative_tolerance=1e-7, **values)
        for step in steps:
            host.step(step)
        results.append(host.all_outputs()[-63:])
    np.testing.assert_allclose(results[0], results[1], atol=1e-4)
    np.testing.assert_allclose(results[0], results[2], atol=1e-4)


@every_flavour
@in_shared_process
def test_two_instances_do_not_see_each_other(fmu_folder):
    path = fmu_folder / "TetherDynamic.fmu"
    alone = fly(started(path), 40)
    first, second = started(path), started(path, segments=7)
    for k in range(40):
        fly(first, 1, begin=k)
        fly(second, 1, begin=k)
    assert first.all_outputs() == alone
    assert second.get("kite_end_mass") == pytest.approx(724.0 * np.pi * 0.002**2 * 525.0 / 14.0)


@every_flavour
@in_shared_process
def test_outputs_can_be_read_while_initializing(fmu_folder):
    host = Host(fmu_folder / "TetherDynamic.fmu")
    host.fmu.setupExperiment(startTime=0.0)
    host.fmu.enterInitializationMode()
    assert host.get("tether_length") == 505.0
    host.set(initial_length=510.0)
    assert host.get("tether_length") == 510.0
    before = host.get("kite_force")
    host.fmu.exitInitializationMode()
    assert host.get("kite_force") == before


@every_flavour
@in_shared_process
def test_solver_options(fmu_folder):
    """fixed_step takes exactly its steps, also when the importer's step is not exactly representable."""
    results = []
    for step in (0.01, 0.010000000000000009):
        results.append(fly(started(fmu_folder / "TetherDynamic.fmu", fixed_step=0.005), 20, step))
    # a stage is at rest where its last move is 1e-5 of a segment, so wrong by 1e-10 of it; found: 2e-9 of a force
    np.testing.assert_allclose(results[0], results[1], rtol=1e-8)
    tether = TetherDynamic(Tether(initial_length=525.0), solver=Solver(fixed_step=0.005))
    tether.initialize()
    tether.step(0.010000000000000009)
    assert tether.counters["steps"] == 2
