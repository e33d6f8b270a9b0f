"""Directional derivatives: of the outputs that the last step has led to, by the inputs that it was done with."""

import math

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from isolation import in_shared_process
from mechanics import drags, line_density, node_masses
from native.steps_again import assert_columns_agree, differences
from runtime.host import Host, blob_of, fly, names_of, restore, started
from tetherfmu.export.archive import SLAVES
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.parameters import Environment, Tether
from tetherfmu.runtime.saved_state import from_bytes

STEP = 0.02
FORCES = [f"{end}_force[{i}]" for end in ("ground", "kite") for i in (1, 2, 3)]
MOTION = [f"kite_{what}[{i}]" for what in ("position", "velocity") for i in (1, 2, 3)]
CHANGES = {"kite_position": 1e-4, "ground_position": 1e-4, "kite_load": 0.1, "wind_velocity": 0.1}  # [m], [N], [m/s]; 1 mm/s
every_fmu = pytest.mark.parametrize("name", list(SLAVES))


def inputs_of(name):
    """Scalar inputs of an FMU by which its forces are derived here."""
    kite = [f"kite_load[{i}]" for i in (1, 2, 3)] if name == "TetherDynamicFree" else MOTION
    return [*kite, "ground_position[1]", "ground_velocity[3]", "reel_out_speed", "wind_velocity[2]"]


def derivative(host, outputs, inputs, seed):
    references = [[host.reference[name] for name in names] for names in (outputs, inputs)]
    return np.array(host.fmu.getDirectionalDerivative(*references, list(seed)))


def jacobian(host, outputs, inputs):
    return np.stack([derivative(host, outputs, [name], [1.0]) for name in inputs], axis=1)


def flown(path, steps=30):
    """An instance on the circle that has done some steps; the state before the last one."""
    host = started(path, initial_shape=1)  # from a jolt, so that no segment is at its kink
    fly(host, 0, steps - 1)
    blob = blob_of(host)
    fly(host, steps - 1, steps)
    return host, blob


@every_fmu
@in_shared_process
def test_differences_of_steps_that_are_done_again(native_folder, name):
    """By save, restore and steps with other inputs, extrapolated.

    Observed 1e-5 at most. The changes are small beside the stretch of a segment, 2 mm at 50 N: there is a kink.
    """
    host, before = flown(native_folder / f"{name}.fmu")
    changes = {each: CHANGES.get(each.partition("[")[0], 1e-3) for each in inputs_of(name)}
    found, given = jacobian(host, FORCES, changes), {each: host.get(each) for each in changes}
    assert_columns_agree(found, differences(host, before, STEP, given, FORCES, changes), 1e-4)


@pytest.mark.parametrize("mass", [0.0, 50.0], ids=["no drum", "drum"])
@every_fmu
@in_shared_process
def test_by_the_force_of_a_winch(native_folder, name, mass):
    """Without mass T = 2 W - W_last at the end of equal steps, so 2 of the tension; else by steps that are done again.

    Those are extrapolated over changes of 1 N. Of the tension at the kite, which no wave has reached, 1e-7 is noise. A
    tether in equilibrium takes changes of 6 N, 1 % of the force: their third order is felt in its length, 2e-4.
    """
    host = Host(native_folder / f"{name}.fmu").start(winch_control=2, winch_mass=mass, initial_length=500.0)
    for k in range(6):
        before = blob_of(host)
        host.step(STEP, winch_force=400.0 + 20.0 * k)
    outputs = ["ground_tension", "kite_tension", "tether_length", "winch_speed"]
    found = derivative(host, outputs, ["winch_force"], [1.0])
    expected = differences(host, before, STEP, {}, outputs, {"winch_force": 1.0})[:, 0]
    np.testing.assert_allclose(found, expected, rtol=1e-3, atol=1e-7)
    if mass == 0.0:
        assert found[0] == pytest.approx(2.0, rel=1e-6)


@in_shared_process
def test_formula_of_a_taut_straight_line(native_folder):
    """T = EA (c/L - 1): K = EA/L e e^T + T/c (1 - e e^T) by position, and what an input moves within the step.

    A change of the velocity moves the end by 3/2 h: h, and half as much by the acceleration that follows from it. So does
    one of the reel-out speed change L.
    """
    host = Host(native_folder / "TetherStraight.fmu").start(initial_length=480.0, drag_coefficient=0.0)
    host.step(STEP)
    host.step(STEP)
    chord, length, stiffness = np.array([300.0, 0.0, 400.0]), 480.0, 614600.0
    e, c = chord / 500.0, 500.0
    along = np.outer(e, e)
    by_position = -(stiffness / length * along + stiffness * (c / length - 1.0) / c * (np.eye(3) - along))
    weight = line_density(Tether()) * 9.81
    by_length = stiffness * c / length**2 * e - (0.0, 0.0, 0.5 * weight)
    kite, moved = FORCES[3:], 1.5 * STEP
    found = jacobian(host, kite, [*MOTION, "reel_out_speed", *(f"ground_position[{i}]" for i in (1, 2, 3))])
    expected = np.column_stack([by_position, moved * by_position, moved * by_length, -by_position])
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-8 * stiffness / length)


@pytest.mark.parametrize("name", [name for name in SLAVES if not name.endswith("Free")])
@pytest.mark.parametrize("step", [0.02, 0.001, 0.0001])
@in_shared_process
def test_by_positions_from_which_velocities_are_derived(native_folder, name, step):
    """A kite at rest, whose position alone is known: a change is a jump. By save, restore and other positions, extrapolated.

    In flight the extrapolation has kinks where a change is more than the curvature of the path explains.
    """
    host = Host(native_folder / f"{name}.fmu")
    start = np.array([300.0, 0.0, 400.0])
    host.start(initial_length=499.0, end_velocities=2, kite_position=start, wind_velocity=[0.0, 8.0, 0.0])
    for _ in range(40):
        before = blob_of(host)
        host.step(step, kite_position=start)
    found = jacobian(host, FORCES, MOTION[:3])

    # the spring of a segment bends sooner than the drag: there is a kink, 2 mm of stretch away
    change = min(1e-5, 1e-3 * step) if name == "TetherDynamic" else min(1e-3, 0.02 * step)
    expected = differences(host, before, step, {"kite_position": start}, FORCES, dict.fromkeys(MOTION[:3], change))
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-5 * np.abs(expected).max())


@pytest.mark.parametrize("stretch", [-6e-3, -2e-3, -1e-6, 0.0, 1e-6, 2e-3, 6e-3])
@pytest.mark.parametrize("velocities", [1, 2])
@in_shared_process
def test_formula_of_a_straight_line_that_is_nearly_taut(native_folder, stretch, velocities):
    """K of the formula above on the taut side, also at its edge; 0 on the slack side. A jump of positions alone, too.

    A difference across the kink, of 5 mm to both sides, found half of K at the edge on either side.
    """
    length, stiffness = 500.0 - stretch, 614600.0
    host = Host(native_folder / "TetherStraight.fmu")
    host.start(initial_length=length, drag_coefficient=0.0, end_velocities=velocities)
    for _ in range(4):
        host.step(STEP)
    e = np.array([0.6, 0.0, 0.8])
    along = np.outer(e, e)
    tension = stiffness * max(stretch, 0.0) / length
    expected = -(stiffness / length * along + tension / 500.0 * (np.eye(3) - along)) * (stretch >= 0.0)
    # at the edge a one-sided difference of 5 mm across the line stretches it: EA/L 5 mm/(2 500 m) = 0.006 N/m
    atol = (1e-5 if abs(stretch) < 1e-5 else 1e-8) * stiffness / length
    np.testing.assert_allclose(jacobian(host, FORCES[3:], MOTION[:3]), expected, rtol=0.0, atol=atol)


@pytest.mark.parametrize("length", [500.01, 500.0, 499.99])
@in_shared_process
def test_a_stiff_catenary_that_becomes_taut(native_folder, length):
    """Its tension bends within centimetres: EA 1e9, so a difference over 10 mm was wrong by 2 to 10 %. Without a kink."""
    host = Host(native_folder / "TetherCatenary.fmu")
    kite = np.array([300.0, 0.0, 400.0])
    host.start(initial_length=length, axial_stiffness=1e9)
    host.step(STEP, kite_position=kite)
    before = blob_of(host)
    host.step(STEP, kite_position=kite)
    found = jacobian(host, FORCES, MOTION[:3])

    expected = differences(host, before, STEP, {"kite_position": kite}, FORCES, dict.fromkeys(MOTION[:3], 1e-4))
    # where all of the bend is on one side, the central difference has half of the 0.1 % by which both sides may differ
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=5e-4 * np.abs(expected).max())


@in_shared_process
def test_formula_of_one_segment(native_folder):
    """One spring and damper, F = -(k (l - l0) + c v.e) e: of the dynamic tether, whose inputs change velocities, too."""
    host = Host(native_folder / "TetherDynamic.fmu").start(segments=1, initial_length=480.0, drag_coefficient=0.0)
    velocity = np.array([1.0, -5.0, 3.0])
    for _ in range(3):
        host.step(STEP, kite_velocity=velocity, kite_position=np.array([300.0, 0.0, 400.0]))

    def force(position, velocity):
        length = np.linalg.norm(position)
        e = position / length
        return -(614600.0 / 480.0 * (length - 480.0) + 473.0 / 480.0 * (velocity @ e)) * e

    end = np.array([300.0, 0.0, 400.0]) + STEP * velocity
    tiny = 1e-4 * np.eye(3)
    by_position = np.stack([(force(end + d, velocity) - force(end - d, velocity)) / 2e-4 for d in tiny], axis=1)
    by_velocity = np.stack([(force(end, velocity + d) - force(end, velocity - d)) / 2e-4 for d in tiny], axis=1)
    expected = np.hstack([by_position, 1.5 * STEP * by_position + 2.0 * by_velocity])
    np.testing.assert_allclose(jacobian(host, FORCES[3:], MOTION), expected, rtol=0.0, atol=1e-6 * np.abs(expected).max())


def exact_kite_force(state, inputs, before, wind):
    """Force on the kite [N] after a step, by DOP853 and numpy: of the chain of 20 segments in a state array.

    inputs : position and velocity of the kite, array (6,).  before : its velocity one step ago.
    """
    from scipy.integrate import solve_ivp  # not in the process of each test of this file: it takes longer than most of them

    tether, air = Tether(initial_length=525.0), Environment()
    x0, v0 = state[at.STATE_HEADER : at.nodes_end(tether.segments)].reshape(2, -1, 3)
    mass, rest = node_masses(tether), tether.initial_length / tether.segments
    position, velocity = inputs[:3], inputs[3:]
    acceleration = (velocity - before) / STEP
    target, speed = position + STEP * velocity + 0.5 * STEP**2 * acceleration, velocity + STEP * acceleration
    mean = (target - x0[-1]) / STEP
    c2, c3 = (3.0 * mean - 2.0 * v0[-1] - speed) / STEP, (v0[-1] + speed - 2.0 * mean) / STEP**2

    def forces(x, v):
        r, u = np.diff(x, axis=0), np.diff(v, axis=0)
        length = np.linalg.norm(r, axis=1, keepdims=True)
        e = r / length
        spring = tether.axial_stiffness / rest * (length - rest) * np.where(length > rest, 1.0, tether.slack_stiffness_ratio)
        pull = (spring + tether.axial_damping / rest * np.sum(u * e, axis=1, keepdims=True)) * e
        half = 0.5 * drags(x, v, wind, tether, air)
        total = -mass[:, None] * (0.0, 0.0, 9.81)
        total[:-1] += pull + half
        total[1:] += half - pull
        return total

    def nodes(t, y):
        x, v = np.vstack([x0[0], y[:57].reshape(19, 3), x0[-1]]), np.vstack([v0[0], y[57:].reshape(19, 3), v0[-1]])
        x[-1] += t * v0[-1] + t * t * c2 + t**3 * c3
        v[-1] += 2.0 * t * c2 + 3.0 * t * t * c3
        return x, v

    def slope(t, y):
        return np.concatenate([y[57:], (forces(*nodes(t, y))[1:-1] / mass[1:-1, None]).ravel()])

    start = np.concatenate([x0[1:-1].ravel(), v0[1:-1].ravel()])
    done = solve_ivp(slope, (0.0, STEP), start, "DOP853", rtol=1e-13, atol=1e-13)
    return forces(*nodes(STEP, done.y[:, -1]))[-1]


@in_shared_process
def test_independent_solution_of_the_chain(native_folder):
    """Differences of DOP853's solutions; no code is shared with the kernels. Observed 5e-7, tolerance of the FMU 1e-8.

    Along the tether the last segment alone would be 19 times too stiff: within a step its inner end gives way. A change of
    the velocity input changes the velocity at the end of the step twice as much, and sends a wave into the tether: the force
    changes by its impedance sqrt(EA mu), but for the length of a segment.
    """
    host = Host(native_folder / "TetherDynamic.fmu")
    wind, velocity = np.array([6.0, 1.0, 0.0]), np.array([3.0, -20.0, 5.0])
    host.start(
        initial_length=525.0, wind_velocity=wind, kite_velocity=velocity, kite_position=[320.0, 0.0, 430.0], tolerance=1e-8
    )
    inputs = np.array([320.0, 0.0, 430.0, *velocity])
    for k in range(11):
        before, blob = host.get("kite_velocity"), blob_of(host)
        inputs[:3] += STEP * inputs[3:] if k else 0.0
        inputs[3:] += 0.1, 0.2, -0.3
        host.step(STEP, kite_position=inputs[:3], kite_velocity=inputs[3:])
    state = np.array(from_bytes(blob, "dynamic", 1 + max(host.reference.values())).state)
    found = jacobian(host, FORCES[3:], MOTION)
    assert host.get("kite_force") == pytest.approx(exact_kite_force(state, inputs, before, wind), abs=1e-3)
    for k, change in enumerate(np.diag([1e-3] * 3 + [0.05] * 3)):
        upper, lower = (exact_kite_force(state, inputs + sign * change, before, wind) for sign in (1.0, -1.0))
        expected = (upper - lower) / (2.0 * change[k])
        np.testing.assert_allclose(found[:, k], expected, rtol=0.0, atol=1e-5 * np.abs(expected).max(), err_msg=MOTION[k])
    e = np.array([320.0, 0.0, 430.0]) / np.linalg.norm([320.0, 0.0, 430.0])
    assert 614600.0 / (525.0 / 20) / -(e @ found[:, :3] @ e) == pytest.approx(19.0, abs=1.0)
    assert -(e @ found[:, 3:] @ e) == pytest.approx(2.0 * np.sqrt(614600.0 * line_density(Tether())), rel=0.05)


@every_fmu
@in_shared_process
def test_fmi3_finds_the_same(native_folder, fmi3_folder, name):
    """To the last bit, with vectors as unknowns and knowns."""
    host, blob = flown(native_folder / f"{name}.fmu")
    other = Host(fmi3_folder / f"{name}.fmu")
    restore(other, blob)
    other.time = host.time - STEP
    last = {
        each: host.get(each) for each in ("kite_position", "kite_velocity", "kite_load") if f"{each}[1]" in host.reference
    }
    settable = {each: value for each, value in last.items() if each in names_of(other, "input")}
    other.step(STEP, **settable, reel_out_speed=host.get("reel_out_speed"))
    known = list(settable)[-1]
    references = [[other.reference[each] for each in names] for names in (("ground_force", "kite_force"), (known,))]
    found = other.fmu.getDirectionalDerivative(*references, [1.0, -2.0, 0.5], 6)
    assert found == derivative(host, FORCES, [f"{known}[{i}]" for i in (1, 2, 3)], [1.0, -2.0, 0.5]).tolist()
    assert np.abs(found).max() > 0.01
    with pytest.raises(FMICallException):
        other.fmu.getDirectionalDerivative(*references, [1.0, -2.0, 0.5], 5)
    assert "5 values were passed for variables that have 6" in other.messages[-1]


@in_shared_process
def test_linear_in_the_seed_and_nothing_changes(native_folder):
    host, _ = flown(native_folder / "TetherDynamic.fmu")
    before = blob_of(host)
    one, other, both, none = (
        derivative(host, FORCES, MOTION[:2], seed) for seed in ((1.0, 0.0), (0.0, 2.0), (1.0, 2.0), (0.0, 0.0))
    )
    np.testing.assert_allclose(both, one + other, rtol=0.0, atol=1e-6 * np.abs(both).max())
    assert not none.any()
    assert blob_of(host) == before
    twin = started(native_folder / "TetherDynamic.fmu", initial_shape=1)
    assert fly(host, 30, 35) == fly(twin, 0, 35)[30:]


@in_shared_process
def test_inputs_that_were_set_since_do_not_count(native_folder):
    host, _ = flown(native_folder / "TetherDynamic.fmu")
    expected = jacobian(host, FORCES, MOTION)
    position = host.get("kite_position")
    host.set(kite_position=[0.0, 0.0, 100.0])
    np.testing.assert_array_equal(jacobian(host, FORCES, MOTION), expected)
    with pytest.raises(FMICallException):
        host.step(STEP, wind_velocity=[math.nan, 0.0, 0.0])
    np.testing.assert_array_equal(jacobian(host, FORCES, MOTION), expected)
    host.step(STEP, wind_velocity=[0.0, 0.0, 0.0], kite_position=position)
    assert not np.array_equal(jacobian(host, FORCES, MOTION), expected)


@every_fmu
@in_shared_process
def test_of_the_start_in_initialization_mode(native_folder, name):
    """By differences of starts; the catenary and the chains hang between the ends."""
    path = native_folder / f"{name}.fmu"
    known, position = ("ground_position[1]", "wind_velocity[2]"), (4.0, -3.0)

    def at_start(values):
        host = Host(path)
        host.fmu.setupExperiment(startTime=0.0)
        host.fmu.enterInitializationMode()
        host.set(initial_length=520.0, **dict(zip(known, values, strict=True)))
        return host

    host = at_start(position)
    for k, each in enumerate(known):
        change = np.where(np.arange(2) == k, 1e-2, 0.0)
        sides = [np.array([at_start(position + s * change).get(force) for force in FORCES]) for s in (1.0, -1.0)]
        expected = (sides[0] - sides[1]) / 2e-2
        found = derivative(host, FORCES, [each], [1.0])
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-3 * np.abs(expected).max(), err_msg=each)
    host.fmu.exitInitializationMode()
    host.step(STEP)


@in_shared_process
def test_refused_where_no_step_is_known(native_folder):
    words = "no step has been done since the start or since a state was set"
    host = started(native_folder / "TetherDynamic.fmu")
    host.refuses(lambda: derivative(host, FORCES, MOTION[:1], [1.0]), words)
    fly(host, 0, 2)
    derivative(host, FORCES, MOTION[:1], [1.0])
    restore(host, blob_of(host))
    host.refuses(lambda: derivative(host, FORCES, MOTION[:1], [1.0]), words)
    fly(host, 2, 3)
    host.fmu.terminate()
    derivative(host, FORCES, MOTION[:1], [1.0])


WRONG = (
    ("sag", "diameter", 1.0, "cannot be used here: it is not a continuous input"),
    ("slack_segments", "reel_out_speed", 1.0, "has no derivative: it is not a continuous output"),
    ("kite_position[1]", "reel_out_speed", 1.0, "has no derivative: it is not a continuous output"),
    ("sag", "reel_out_speed", math.inf, "the seed has inf; it must be a finite number of at most 1000000000.0 in magnitude"),
)


@pytest.mark.parametrize(("unknown", "known", "seed", "words"), WRONG)
@in_shared_process
def test_refused_in_words(native_folder, unknown, known, seed, words):
    host, _ = flown(native_folder / "TetherStraight.fmu", 2)
    host.refuses(lambda: derivative(host, [unknown], [known], [seed]), words)
