"""Physics knows no x, no origin, no left, no ground and no rest: a moved, turned, mirrored or reversed scene moves alike.

A kite pulls an arc of 1 s in wind; then the same scene is transformed. Forces and node positions must follow.
"""

import numpy as np
import pytest

from solvers import MODELS
from tetherfmu import Environment, Solver, Tether, TetherDynamic, tether_of

STEP, COUNT = 0.02, 50
SAME, UNIFORM = np.eye(3), Environment()
WIND = np.array([7.0, 3.0, 0.5])
# Equal runs differ by rounding alone: positions near 300 m are rounded at 6e-14 m, EA/l0 = 2e4 N/m makes 1e-9 N of it,
# and the steps of the solver, which follow its error estimate, differ as little. Observed 1e-9 N and 3e-12 m.
FORCE = 1e-7
POSITION = 1e-9


def turn(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def kite(time):
    """Position and velocity of the kite [m, m/s] on a horizontal arc with 25 m/s."""
    phase = 0.5 * time
    position = np.array([200.0 + 50.0 * np.cos(phase), 50.0 * np.sin(phase), 150.0])
    return position, 25.0 * np.array([-np.sin(phase), np.cos(phase), 0.0])


def ground(time):
    """Position and velocity of a station [m, m/s] that drives along y."""
    return np.array([0.0, 3.0 * time, 10.0]), np.array([0.0, 3.0, 0.0])


def fly(matrix=SAME, shift=0.0, reverse=False, environment=UNIFORM, initial_shape=1, speed=0.7):
    """Forces on both ends (2, 3) and node positions after the run, in the transformed scene."""
    model = TetherDynamic(Tether(segments=15, initial_length=310.0), environment, Solver(initial_shape=initial_shape))
    ends = ("ground", "kite") if reverse else ("kite", "ground")

    def inputs(time):
        values = {"wind_velocity": matrix @ WIND, "reel_out_speed": speed}
        for name, (position, velocity) in zip(ends, (kite(time), ground(time)), strict=True):
            values |= {f"{name}_position": matrix @ position + shift, f"{name}_velocity": matrix @ velocity}
        return values

    model.initialize(**inputs(0.0))
    for k in range(COUNT):
        out = model.step(STEP, **inputs(k * STEP))
    return np.array([out.ground_force, out.kite_force]), model.positions, out


@pytest.mark.parametrize("initial_shape", [1, 2])
@pytest.mark.parametrize(
    "matrix",
    [turn(0.3), turn(np.pi / 2), turn(-2.5), np.diag([1.0, -1.0, 1.0]), turn(1.0) @ np.diag([-1.0, 1.0, 1.0])],
    ids=["turn 0.3", "quarter turn", "turn -2.5", "mirror y", "mirror and turn"],
)
def test_turn_about_z_and_mirror(matrix, initial_shape):
    air = Environment(wind_profile=4, air_density_scale_height=8550.0)  # height matters, direction does not
    force, x, out = fly(environment=air, initial_shape=initial_shape)
    turned_force, turned_x, turned_out = fly(matrix, environment=air, initial_shape=initial_shape)
    np.testing.assert_allclose(turned_force, force @ matrix.T, rtol=0, atol=FORCE)
    np.testing.assert_allclose(turned_x, x @ matrix.T, rtol=0, atol=POSITION)
    assert turned_out.ground_elevation == pytest.approx(out.ground_elevation, abs=1e-8)
    assert turned_out.sag == pytest.approx(out.sag, abs=POSITION)


@pytest.mark.parametrize("shift", [(0.0, 0.0, 70.0), (-30.0, 400.0, -10.0)], ids=str)
def test_translation_in_uniform_wind(shift):
    shift = np.array(shift)
    force, x, _ = fly()
    moved_force, moved_x, _ = fly(shift=shift)
    np.testing.assert_allclose(moved_force, force, rtol=0, atol=FORCE)
    np.testing.assert_allclose(moved_x, x + shift, rtol=0, atol=POSITION)


def test_reversed_ends():
    air = Environment(wind_profile=2)
    force, x, out = fly(environment=air, speed=0.0)  # rope that is paid out flows from the first end
    reversed_force, reversed_x, reversed_out = fly(environment=air, reverse=True, speed=0.0)
    np.testing.assert_allclose(reversed_force[::-1], force, rtol=0, atol=FORCE)
    np.testing.assert_allclose(reversed_x[::-1], x, rtol=0, atol=POSITION)
    assert reversed_out.ground_tension == pytest.approx(out.kite_tension, abs=FORCE)


def test_several_falls_are_one_tether_of_their_sum():
    """n falls side by side: n times stiffness, damping, mass and drag; each end force is n times that of one fall."""
    falls, wire = 4, tether_of("steel", 0.012, initial_length=80.0)
    names = ("axial_stiffness", "axial_damping", "density", "drag_coefficient")
    together = {name: falls * getattr(wire, name) for name in names}
    forces = []
    for more in ({}, together):
        tether = TetherDynamic(wire, **more)
        tether.initialize((30.0, 0.0, 20.05), ground_position=(30.0, 0.0, 100.0), wind_velocity=(0.0, 15.0, 0.0))
        outputs = [tether.step(STEP, (30.0 + 1.0 * STEP * k, 0.0, 20.05), (1.0, 0.0, 0.0)) for k in range(100)]
        forces.append(np.array([each.kite_force for each in outputs]))
    # the steps are chosen by relative errors of positions, which are the same: rounding, grown by the stiffness
    np.testing.assert_allclose(forces[1], falls * forces[0], rtol=0.0, atol=1e-6 * np.abs(forces[1]).max())


# --- an observer who moves uniformly

FORCED = {"winch_control": "force", "winch_mass": 2.0}
ANY = [(model, {}) for model in MODELS]
ANY += [(TetherDynamic, {"fixed_step": 0.005}), (TetherDynamic, FORCED), (TetherDynamic, {"fixed_step": 0.005, **FORCED})]


@pytest.mark.parametrize("frame", [(20.0, -7.0, 3.0), (200.0, 0.0, 0.0)], ids=str)
@pytest.mark.parametrize("slack", [0.998, 1.02])
@pytest.mark.parametrize(("model", "options"), ANY)
def test_a_moving_observer_sees_the_same(model, options, slack, frame):
    """Ends, wind and all move along, from the start on: forces and length to 1e-9 (found: 4e-11), with the same work."""
    found = []
    for motion in np.array((np.zeros(3), frame)):
        tether, rows = model(Tether(segments=10, initial_length=100.0 * slack), **options), []

        def inputs(time, motion=motion):
            c, s = np.cos(0.5 * time), np.sin(0.5 * time)
            kite, velocity = np.array((60.0 * c, 60.0 * s, 80.0)), 30.0 * np.array((-s, c, 0.0))
            ends = {"kite_position": kite + motion * time, "kite_velocity": velocity + motion}
            ends |= {"ground_position": motion * time, "ground_velocity": motion}
            return ends | {"wind_velocity": np.add(motion, (8.0, 0.0, 0.0))}

        tether.initialize(**inputs(0.0))
        for time in STEP * np.arange(COUNT):
            told = {"winch_force": 800.0} if "winch_mass" in options else {"reel_out_speed": 0.3 * np.sin(10.0 * time)}
            out = tether.step(STEP, **inputs(time), **told)
            rows.append((*out.ground_force, *out.kite_force, out.tether_length))
        found.append((np.array(rows), tether.counters))
    (still, work), (moving, as_much) = found
    np.testing.assert_allclose(moving, still, rtol=0, atol=1e-9 * np.abs(still).max())
    assert as_much == work
