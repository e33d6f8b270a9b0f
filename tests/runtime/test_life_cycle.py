"""One FMU through its life: tolerances, variable steps, several instances, options of the solver."""

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from isolation import in_shared_process
from runtime.host import Host, every_flavour, every_flavour_and_version, fly, started
from scenes import circle, kite_inputs
from tetherfmu.python.models import TetherDynamic
from tetherfmu.runtime.parameters import Solver, Tether


@every_flavour_and_version
@in_shared_process
def test_importers_tolerance_and_own_tolerance(fmu_folder):
    """A tolerance of 0 takes the importer's where that is tighter than the default; another one wins."""
    path = fmu_folder / "TetherDynamic.fmu"
    # of the importer, and its own
    pairs = ((1e-8, 0.0), (1e-2, 1e-8), (None, 0.0), (1e-3, 0.0), (0.5, 0.0), (None, 1e-3))
    results = []
    for importers, own in pairs:
        host = started(path, importers, initial_shape=1, relative_tolerance=own)  # at rest, so not at ease
        results.append(fly(host, 0, 20))
    assert results[0] == results[1]
    assert results[0] != results[2]
    assert results[2] == results[3] == results[4]
    assert results[2] != results[5]


@every_flavour_and_version
@in_shared_process
def test_a_tolerance_that_is_none_is_said(fmu_folder):
    """A warning, with which the run goes on as without a tolerance."""
    path = fmu_folder / "TetherDynamic.fmu"
    expected = fly(started(path, None), 0, 20)
    for tolerance in (-1e-6, 0.0, float("nan")):
        host = started(path, tolerance)
        assert any("is not used; it must be greater than 0" in text for text in host.messages), tolerance
        assert fly(host, 0, 20) == expected


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
    """In turn, with another number of segments: each flies as alone."""
    path = fmu_folder / "TetherDynamic.fmu"
    alone = [fly(started(path, segments=count), 0, 40) for count in (20, 7)]
    found, hosts = ([], []), [started(path, segments=count) for count in (20, 7)]
    for k in range(40):
        for rows, host in zip(found, hosts, strict=True):
            rows += fly(host, k, k + 1)
    assert list(found) == alone


@every_flavour
@in_shared_process
def test_outputs_can_be_read_while_initializing(fmu_folder):
    host = Host(fmu_folder / "TetherDynamic.fmu")
    host.enter_initialization(None)
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
        host = started(fmu_folder / "TetherDynamic.fmu", fixed_step=0.005)
        for k in range(20):
            host.step(step, **kite_inputs(host.name, *circle(k * step)))
        results.append(host.all_outputs())
    # a stage is at rest where its last move is 1e-5 of a segment, so wrong by 1e-10 of it; found: 2e-9 of a force
    np.testing.assert_allclose(results[0], results[1], rtol=1e-8)
    tether = TetherDynamic(Tether(initial_length=525.0), solver=Solver(fixed_step=0.005))
    tether.initialize()
    tether.step(0.010000000000000009)
    assert tether.counters["steps"] == 2


# --- the motion of a free kite


FMU = "TetherDynamicFree.fmu"


@in_shared_process
def test_the_motion_starts_where_the_parameters_say(fmu_folder):
    """Also when the velocities of the ends are derived: that of a free kite is no input."""
    for derived in (1, 2):
        host = Host(fmu_folder / FMU)
        host.enter_initialization(None)
        assert host.get("kite_position") == [300.0, 0.0, 400.0]
        position, velocity = [310.0, -20.0, 380.0], [1.0, 2.0, -3.0]
        host.set(initial_kite_position=position, initial_kite_velocity=velocity, end_velocities=derived)
        assert host.get("kite_position") == position
        host.fmu.exitInitializationMode()
        assert (host.get("kite_position"), host.get("kite_velocity")) == (position, velocity)
        host.step(1e-4)
        np.testing.assert_allclose(host.get("kite_position"), np.add(position, 1e-4 * np.array(velocity)), atol=1e-6)


@in_shared_process
def test_the_motion_cannot_be_set(fmu_folder):
    host = Host(fmu_folder / FMU).start()
    host.set(**{"kite_position[1]": 0.0})
    assert host.get("kite_position") == [300.0, 0.0, 400.0]
    with pytest.raises(FMICallException):
        host.step(0.02)
    host.step(0.02)


@in_shared_process
def test_a_start_without_equilibrium_keeps_the_motion_that_was(fmu_folder):
    """Read in initialization mode: what cannot be calculated is NaN; later the motion of before is there again."""
    host = Host(fmu_folder / FMU)
    host.enter_initialization(None)
    before = host.all_outputs()
    kept = {name: host.get(name) for name in ("initial_kite_position", "axial_stiffness", "air_density_scale_height")}
    host.set(initial_kite_position=(1e9, 0.0, -1e9), axial_stiffness=1e-3, air_density_scale_height=1e-3)
    assert np.isnan(host.all_outputs()).all()
    assert host.messages
    host.set(**kept)
    assert host.all_outputs() == before
