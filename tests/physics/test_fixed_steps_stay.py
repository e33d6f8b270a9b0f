"""Fixed steps keep order 2 on the ground, at stops and in stiff tethers, and say where they do not.

References: the adaptive solver at a tolerance of 1e-8, which shares no code of a step with them, and closed forms.
"""

import warnings
from functools import cache

import numpy as np
import pytest

from networks import Network
from tetherfmu import (
    Environment,
    Ground,
    Line,
    PlausibilityWarning,
    Point,
    Solver,
    Tether,
    TetherDynamic,
    TetherDynamicFree,
    TetherSystem,
    Winch,
)

STEP, SINK, NODES = 0.02, 0.002, 11
EXACT = {"relative_tolerance": 1e-8}
ON_GROUND = {"environment": Environment(air_density=0.0), "ground": Ground(ground_contact="flat")}


def chain(**solver):
    stiffness = 2e4
    tether = Tether(
        segments=10,
        initial_length=50.0,
        axial_stiffness=stiffness,
        axial_damping=2e-3 * stiffness,
        diameter=0.008,
        density=2000.0,
    )
    return tether, Solver(initial_shape="straight", **solver)


def dragged(steps=100, **solver):
    """A chain that lies on the ground, dragged along at one end: positions of its nodes along it [m], of each step."""
    tether, ordered = chain(**solver)
    model = TetherDynamic(tether, solver=ordered, free_ends=(True, False), **ON_GROUND)
    model.initialize(positions=np.linspace((0.0, 0.0, -SINK), (50.0, 0.0, -SINK), NODES))
    found = []
    for k in range(steps):
        time = k * STEP
        way, speed = 50.0 + 0.5 * (time - 0.5 * np.sin(2.0 * time)), 0.5 * (1.0 - np.cos(2.0 * time))
        model.step(STEP, kite_position=(way, 0.0, -SINK), kite_velocity=(speed, 0.0, 0.0))
        found.append(model.positions[:, 0].copy())
    return np.array(found), model


def reeled(steps=100, **solver):
    """A kite that lies on the ground and is reeled in: positions of the nodes [m]."""
    tether, ordered = chain(**solver)
    model = TetherDynamicFree(tether, solver=ordered, kite_mass=5.0, **ON_GROUND)
    model.initialize(positions=np.linspace((0.0, 0.0, -SINK), (50.0, 0.0, -SINK), NODES))
    found = []
    for k in range(steps):
        model.step(STEP, reel_out_speed=-0.5 * (1.0 - np.cos(2.0 * k * STEP)))
        found.append(model.positions[:, 0].copy())
    return np.array(found), model


def errors_of(scene):
    """Largest errors [m] of a scene with fixed steps of 10, 5 and 2.5 ms, and the shares of those that fell back."""
    exact, _ = scene(**EXACT)
    errors, fallbacks = [], []
    for fixed_step in (0.01, 0.005, 0.0025):
        found, model = scene(fixed_step=fixed_step)
        errors.append(np.abs(found - exact).max())
        fallbacks.append(model.outputs().fallback_steps / model.counters["steps"])
    return errors, fallbacks, model


def test_order_2_on_the_ground():
    """Found: orders from 2.0 to 2.4; 0.05 mm at 10 ms, where backward Euler had 7 mm and the static pressure."""
    errors, fallbacks, model = errors_of(dragged)
    assert max(fallbacks) <= 0.01
    assert model.counters["iterations"] < 6 * model.counters["steps"]
    assert errors[0] < 1e-4
    assert (-np.diff(np.log2(errors)) > 1.8).all()


def test_rope_that_rests_while_nodes_move_through_it():
    """Where the pull of the winch has not come yet, the rope has no tension: steps fall back, and stay as exact."""
    errors, fallbacks, _ = errors_of(reeled)
    assert fallbacks[0] < 0.15
    assert max(fallbacks[1:]) < 0.02
    assert errors[0] < 1e-4
    assert -np.diff(np.log2(errors)).mean() > 1.8


def landed(height, down, along, **solver):
    """Where a mass comes to rest [m] that lands on the ground with these speeds [m/s]."""
    tether = Tether(
        segments=1,
        initial_length=300.0,
        axial_stiffness=1e4,
        axial_damping=0.0,
        diameter=1e-4,
        density=10.0,
        slack_stiffness_ratio=0.0,
    )
    model = TetherDynamicFree(tether, solver=Solver(initial_shape="straight", **solver), kite_mass=10.0, **ON_GROUND)
    model.initialize((50.0, 0.0, height), (along, 0.0, -down), (0.0, 0.0, 1.0))
    for _ in range(75):
        outputs = model.step(STEP)
    return outputs.kite_position[0]


@pytest.mark.parametrize(("down", "along"), [(6.26, 10.0), (20.0, 10.0)])
def test_a_landing_converges(down, along):
    """The mean over the place in its step where it lands; found: 12, 6, 3, 1 mm from 20 m/s, where it did not (2 m)."""
    heights = np.linspace(0.3, 0.7, 5)
    exact = [landed(height, down, along, **EXACT) for height in heights]
    errors = []
    for fixed_step in (0.02, 0.005, 0.00125):
        found = [landed(height, down, along, fixed_step=fixed_step) for height in heights]
        errors.append(np.abs(np.subtract(found, exact)).mean())
    assert errors[0] < 0.02
    assert errors[1] < 0.5 * errors[0] or errors[0] < 2e-3
    assert errors[2] < 0.5 * errors[1]


@pytest.mark.parametrize("is_outer", [False, True])
def test_a_drum_at_its_stop_stays_there(is_outer):
    """At any length, also one that no binary number is: no step is left, was every one for a third of the lengths."""
    random = np.random.default_rng(4)
    for length in (30.7, 20.1, *random.uniform(5.0, 200.0, 10)):
        stop = {"longest_length": length} if is_outer else {"shortest_length": length}
        winch = Winch("force", winch_mass=10.0, **stop)
        model = TetherDynamic(Tether(5, length), Environment(), Solver(fixed_step=0.005), winch)
        kite = np.array((0.6, 0.0, 0.8)) * length * (1.001 if is_outer else 0.999)
        model.initialize(kite, winch_force=10.0 if is_outer else 5000.0, wind_velocity=(8.0, 0.0, 0.0))
        for _ in range(20):
            outputs = model.step(STEP, winch_force=10.0 if is_outer else 5000.0)
        assert outputs.fallback_steps == outputs.solver_rejections == 0
        assert outputs.tether_length == length


def swinging(stiffness, mass, fixed_step, **solver):
    """Tensions [N] of a load on five segments of steel rope that gets 20 % heavier, the model, and what was said."""
    tether = Tether(
        segments=5, initial_length=100.0, axial_stiffness=stiffness, axial_damping=0.0, diameter=0.05, density=5080.0
    )
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always", PlausibilityWarning)
        ordered = Solver(fixed_step=fixed_step, input_continuation="held", **solver)
        model = TetherDynamicFree(tether, solver=ordered, kite_mass=mass, kite_start="equilibrium")
        model.initialize(kite_position=(0.0, 0.0, -100.0 * (1.0 + mass * 9.81 / stiffness)))
        rows = [model.step(STEP, kite_load=(0.0, 0.0, -0.2 * mass * 9.81)).kite_tension for _ in range(50)]
    return np.array(rows), model, [str(each.message) for each in said if "fixed" in str(each.message)]


@pytest.mark.parametrize(("stiffness", "mass"), [(1e8, 5e4), (1e9, 5e5), (1e10, 5e6), (1e10, 5e4)])
def test_order_2_in_stiff_ropes(stiffness, mass):
    """At 5 ms; found: 0.4 % at most, where it was 14 %."""
    exact, _, _ = swinging(stiffness, mass, 0.0, relative_tolerance=1e-9)
    found, model, said = swinging(stiffness, mass, 0.005)
    assert np.abs(found - exact).max() < 0.01 * exact.max()
    assert model.outputs().fallback_steps == 0
    assert said == []


def test_a_step_that_resolves_no_swing_is_said():
    """The heavy load swings by 0.9 rad in a step: order 2, wrong by some percent; a light one hangs on a rod."""
    for mass, left in ((5e4, 0), (50.0, 50)):
        _, model, (said,) = swinging(1e10, mass, 0.02)
        assert said.startswith("fixed steps of 0.02 s are too long for the axial oscillation of a tether")
        assert model.outputs().fallback_steps == left


def test_many_steps_of_lower_order_are_said_once():
    """A drum with friction that is drawn to and fro comes to rest in many of its steps."""
    winch = Winch("force", winch_mass=2.0, winch_friction=200.0)
    model = TetherDynamic(Tether(3, 100.0), solver=Solver(fixed_step=0.01), winch=winch)
    model.initialize((60.0, 0.0, 80.05), winch_force=500.0)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", PlausibilityWarning)
        for k in range(300):
            outputs = model.step(STEP, winch_force=500.0 + 400.0 * np.sin(60.0 * k * STEP))
    said = [str(each.message) for each in caught if "of the last 1000 fixed steps" in str(each.message)]
    assert len(said) == 1
    assert "the drum of the winch came to rest or to a stop" in said[0]
    assert 0.01 * 600 < outputs.fallback_steps == outputs.solver_rejections < 600


# --- a damped chain that swings, against the same masses, springs and dampers in `networks.py`

LENGTH, MASS, EA, DENSITY, DIAMETER = 10.0, 5.0, 2000.0, 724.0, 0.01
DURATION = 1.0
# of the load; the chain is straight and stays taut, and the load alone moves
START, SPEED = np.array([2.87, 0.0, -9.84]), np.array([0.0, 1.0, 0.0])
SIZES = (0.01, 0.005, 0.0025)
POINTS = [Point("top", (0.0, 0.0, 0.0)), Point("load", START, velocity=SPEED, mass=MASS)]


@cache
def swung(segments, damping):
    """Position of the load after DURATION; damping : D [N s]."""
    line, calm = Line("rope", "top", "load", rope(segments, damping)), Environment(air_density=0.0)
    network = Network(POINTS, [line], calm, np.zeros(3), {"top": lambda _: np.zeros((2, 3))})
    velocities = np.zeros((segments + 1, 3))
    velocities[-1] = SPEED
    start = network.state({"rope": np.linspace(np.zeros(3), START, segments + 1)}, {"rope": velocities})
    (end,) = network.integrate(start, (0.0, DURATION))
    return network.unpacked(DURATION, end)[0][1]


def rope(segments, damping):
    return Tether(
        segments=segments,
        initial_length=LENGTH,
        diameter=DIAMETER,
        density=DENSITY,
        axial_stiffness=EA,
        axial_damping=damping,
        drag_coefficient=0.0,
    )


def of_tether(segments, damping, solver):
    """The same of a tether with a free end."""
    tether = TetherDynamicFree(rope(segments, damping), kite_mass=MASS, solver=solver)
    nodes = np.linspace(np.zeros(3), START, segments + 1)
    velocities = np.zeros_like(nodes)
    velocities[-1] = SPEED
    tether.initialize(positions=nodes, velocities=velocities)
    for _ in range(round(DURATION / STEP)):
        outputs = tether.step(STEP)
    return outputs.kite_position


def of_system(segments, damping, solver):
    """The same of a line to a free point."""
    system = TetherSystem(POINTS, [Line("rope", "top", "load", rope(segments, damping))], solver=solver)
    system.initialize()
    for _ in range(round(DURATION / STEP)):
        outputs = system.step(STEP)
    return outputs.points["load"].position


@pytest.mark.parametrize("damping", [20.0, 200.0, 1000.0])
@pytest.mark.parametrize(("fly", "segments"), [(of_tether, 4), (of_tether, 1), (of_system, 1)])
def test_the_order_is_two(fly, segments, damping):
    """Between 10, 5 and 2.5 ms; 5e-6 m at 10 ms, where order 1 gives up to 2e-5."""
    exact = swung(segments, damping)
    errors = [np.linalg.norm(fly(segments, damping, Solver(fixed_step=size)) - exact) for size in SIZES]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert np.linalg.norm(fly(segments, damping, Solver(relative_tolerance=1e-9)) - exact) < 1e-7
    assert np.all(orders > 1.9), (errors, orders)
    assert errors[0] < 5e-6
