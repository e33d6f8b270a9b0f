"""The kites against formulas: forces, signs, turn rate law, free fall, terminal velocity, order; the air of the tether."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from example_fmus.example_slaves import Model
from tetherfmu.kernels.equations import air
from tetherfmu.libraries.examples import example
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.parameters import Environment
from tetherfmu.runtime.quantities import quantities

NO_WEIGHT = {"turning_by_weight": 0.0}


def lift_and_drag(load, felt):
    """Components along the apparent wind and across it (a vector)."""
    along = np.dot(load, felt) / np.linalg.norm(felt)
    return along, load - along * np.array(felt) / np.linalg.norm(felt)


@pytest.mark.parametrize("depower", [0.0, 0.4, 1.0])
@pytest.mark.parametrize("steering", [0.0, -0.5])
def test_lift_and_drag(depower, steering):
    """q S C_L across and q S C_D (1 + k |u|) along the apparent wind; the lift points outward."""
    position, velocity, wind = np.array([160.0, 30.0, 120.0]), np.array([-2.0, 12.0, 5.0]), np.array([8.0, 1.0, 0.0])
    kite = Model("PointMassKite", kite_position=position, kite_velocity=velocity, wind_velocity=wind, initial_heading=-1.3)
    kite.step(1e-9, depower=depower, steering=steering)
    felt = wind - velocity
    drag, lift = lift_and_drag(np.array(kite.get("kite_load")), felt)
    pressure = 0.5 * 1.225 * felt @ felt * 19.8
    # the heading turns by 1e-9 s times 1 rad/s
    assert drag == pytest.approx(pressure * (0.164 + depower * (0.043 - 0.164)) * (1.0 + 0.6 * abs(steering)), rel=1e-8)
    assert np.linalg.norm(lift) == pytest.approx(pressure * (0.59 + depower * (0.15 - 0.59)), rel=1e-8)
    assert lift @ position > 0.0
    assert kite.get("apparent_wind_speed") == pytest.approx(np.linalg.norm(felt), rel=1e-12)


@pytest.mark.parametrize("steering", [0.3, -1.0])
def test_turn_rate_law(steering):
    """Held in the wind, without weight: the heading turns by c1 |v_a| u, to the right as seen from the ground station."""
    kite = Model("PointMassKite", kite_position=(100.0, 0.0, 0.0), wind_velocity=(10.0, 0.0, 0.0), **NO_WEIGHT)
    for _ in range(20):
        assert kite.step(0.05, steering=steering)
    # in the first step the rate goes from that of no steering to c1 |v_a| u: half a step is lost
    assert kite.get("heading") == pytest.approx(0.0613 * 10.0 * steering * (1.0 - 0.025), rel=1e-9)
    side = kite.slave.values[-3]  # y of the heading: left of the wind is +y
    assert math.copysign(1.0, side) == -math.copysign(1.0, steering)


def test_turn_rate_law_of_the_kite_with_mass():
    """So heavy, without gravity, that it stays where it is."""
    held = {"kite_mass": 1e9, "gravity": 0.0, "wind_velocity": (10.0, 0.0, 0.0)}
    kite = Model("FlyingKite", initial_kite_position=(100.0, 0.0, 0.0), **held, **NO_WEIGHT)
    for _ in range(20):
        assert kite.step(0.05, steering=0.3)
    assert kite.get("heading") == pytest.approx(0.0613 * 10.0 * 0.3, rel=1e-6)  # it moves by 1e-7 of 100 m


def test_weight_turns_the_nose_down():
    """At elevation 0 the heading psi turns by c2/|v_a| sin(psi), which has the solution tan(psi/2) ~ exp(c2/|v_a| t)."""
    kite = Model("PointMassKite", kite_position=(100.0, 0.0, 0.0), wind_velocity=(10.0, 0.0, 0.0), initial_heading=0.2)
    for _ in range(500):
        kite.step(0.02)
    expected = 2.0 * math.atan(math.tan(0.1) * math.exp(0.1226 * 10.0))
    assert kite.get("heading") == pytest.approx(expected, rel=1e-5)  # second order: (0.1226 0.02)^2 = 6e-6


LAWS = dict(quantities(Environment))["wind_profile"].numbers


@pytest.mark.parametrize("profile", LAWS.values())
@pytest.mark.parametrize("height", [-5.0, 0.0, 1e-4, 3.0, 6.0, 150.0])
def test_the_air_is_that_of_the_tether(profile, height):
    of_examples = example("fmus.air")
    known = Environment(wind_profile=profile, wind_exponent=0.2, surface_roughness=0.01, air_density_scale_height=8550.0)
    parameters = np.zeros(at.PARAMETER_SCALARS)
    for name, value in vars(known).items():
        parameters[getattr(at, name.upper())] = value
    factor, density, _, _ = air.varying_air(height, parameters)
    assert of_examples.wind_factor(height, known) == pytest.approx(factor, rel=1e-14)
    assert of_examples.density(height, known) == pytest.approx(density, rel=1e-14)


def test_a_law_that_the_examples_do_not_know_is_refused():
    unknown = max(LAWS.values()) + 1
    with pytest.raises(ValueError, match=f"wind_profile is {unknown}, a law that examples/fmus/air.py does not know"):
        example("fmus.air").wind_factor(3.0, SimpleNamespace(wind_profile=unknown))


def test_free_fall():
    kite = Model("FlyingKite", initial_kite_velocity=(3.0, -2.0, 10.0), air_density=0.0)
    for _ in range(50):
        kite.step(0.02)
    expected = [300.0 + 3.0, -2.0, 400.0 + 10.0 - 0.5 * 9.81]
    np.testing.assert_allclose(kite.get("kite_position"), expected, rtol=0.0, atol=1e-9)  # exact for a constant acceleration


def test_terminal_velocity():
    """Drag alone: v = v_t tanh(g t/v_t), v_t^2 = 2 m g/(rho S C_D)."""
    errors = []
    for step in (0.01, 0.005):
        kite = Model("FlyingKite", powered_lift=0.0, kite_mass=20.0, powered_drag=0.5)
        for _ in range(round(1.0 / step)):
            kite.step(step)
        terminal = math.sqrt(2.0 * 20.0 * 9.81 / (1.225 * 19.8 * 0.5))
        errors.append(kite.get("kite_velocity")[2] + terminal * math.tanh(9.81 / terminal))
    assert abs(errors[1]) < 1e-4
    assert math.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)  # the order of the method


def test_a_force_that_changes_linearly():
    """Both continuations give the exact motion m x'' = F t once they know the slope."""
    for continuation in (1, 3):
        kite = Model("FlyingKite", kite_mass=2.0, air_density=0.0, gravity=0.0, input_continuation=continuation)
        for k in range(100):
            given = k if continuation == 1 else k + 1  # of the begin, or of the end of the step
            kite.step(0.01, kite_force=(100.0 * 0.01 * given, 0.0, 0.0))
        x = kite.get("kite_position")[0] - 300.0
        # 100 t^3/6/2; linear continuation holds the first force, 0, over the first step: it lacks 50 t^2/2 and 50 t^3/6
        lacking = 25.0 * 0.01**2 * 0.99 + 50.0 * 0.01**3 / 6.0 if continuation == 1 else 0.0
        assert x == pytest.approx(100.0 / 12.0 - lacking, rel=1e-9)


def test_the_point_mass_kite_flies_as_the_flying_one():
    """The load on the path of the other is its force: both have one aerodynamics."""
    start = {"wind_velocity": (8.0, 0.0, 0.0), "initial_heading": -1.0}
    flying = Model("FlyingKite", kite_mass=10.0, initial_kite_velocity=(0.0, 10.0, 0.0), **start)
    motion = {"kite_position": flying.get("kite_position"), "kite_velocity": flying.get("kite_velocity")}
    point = Model("PointMassKite", **start, **motion, input_continuation=3)
    for k in range(100):
        before = np.array(flying.get("kite_velocity"))
        steering = 0.5 * math.sin(0.1 * k)
        flying.step(0.01, steering=steering, kite_force=(-300.0, 0.0, -400.0))
        load = np.array(point.get("kite_load"))
        motion = {name: flying.get(name) for name in ("kite_position", "kite_velocity")}
        assert point.step(0.01, steering=steering, **motion)
        mean = 0.5 * (load + point.get("kite_load")) + [-300.0, 0.0, -400.0 - 10.0 * 9.81]
        change = 10.0 * (np.array(flying.get("kite_velocity")) - before) / 0.01
        # one load is that of the moved kite, the other that of the predicted one: second order, of 0.01 s times 20/s
        np.testing.assert_allclose(change, mean, atol=0.05 * np.linalg.norm(load))
    assert point.get("heading") == pytest.approx(flying.get("heading"), abs=0.02)
