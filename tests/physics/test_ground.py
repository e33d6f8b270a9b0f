"""Chains on a flat ground: against an independent solver, closed forms, and what must hold at any step.

A node on the ground: N = m w2 d (1 - a v_z), friction mu N v_t/sqrt(v_t^2 + v_r^2); see kernels/equations/ground.py. All
scenes are without air.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

from grounds import Chain, scene
from mechanics import line_density
from tetherfmu import (
    EnergyAudit,
    Ground,
    Solver,
    Tether,
    TetherCatenary,
    TetherDynamic,
    TetherDynamicFree,
    TetherQuasiSteady,
)
from tetherfmu.runtime import layout as at

G, SINK, FRICTION, CREEP = 9.81, 0.002, 0.5, 2e-4
STRAIGHT = Solver(initial_shape=3)
FREE = {"free_ends": (True, True)}


def ground(**changes):
    """Still air without drag above a flat ground."""
    return {"air_density": 0.0, "ground_contact": "flat", **changes}


@pytest.mark.parametrize("seed", [1, 5, 8, 9, 11])
def test_against_an_independent_solver(seed):
    """Impacts, sliding, both friction and none, free ends and held ones. Its own tolerance is 1e-9; ours of a step 1e-8."""
    other, duration = scene(seed), 0.4
    place = ground(ground_friction=other.friction, ground_sink=other.sink)
    tether = Tether(segments=other.n, initial_length=other.length)
    masses = {other.n: other.kite_mass} if other.kite_mass else None
    solver = Solver(initial_shape=3, relative_tolerance=1e-8)
    model = TetherDynamic(tether, solver=solver, **place, free_ends=other.free, point_masses=masses)
    ends = {"kite_position": other.x[-1], "ground_position": other.x[0]}
    model.initialize(**ends, kite_velocity=other.v[-1], ground_velocity=other.v[0])
    for _ in range(20):
        model.step(duration / 20, **ends, kite_velocity=other.v[-1], ground_velocity=other.v[0])
    x, v = other.advance(duration)
    assert x[:, 2].min() < 0.0  # something lies on the ground
    np.testing.assert_allclose(model.positions, x, rtol=0, atol=1e-6)
    np.testing.assert_allclose(model.velocities, v, rtol=0, atol=1e-5)


def fallen_chain(segments=80, length=10.0, tolerance=1e-6):
    """A chain that is let go upright, its lower end on the ground, and that does not hold compression."""
    tether = Tether(
        segments=segments, initial_length=length, diameter=0.01, slack_stiffness_ratio=0.0, slack_damping_ratio=0.0
    )
    model = TetherDynamic(tether, solver=Solver(initial_shape=3, relative_tolerance=tolerance), **ground(), **FREE)
    model.initialize((0.0, 0.0, length), ground_position=(0.0, 0.0, 0.0))
    weight = line_density(tether) * length * G
    mass = np.full(segments + 1, weight / G / segments)
    mass[[0, -1]] *= 0.5
    return model, mass, weight


def test_falling_chain_presses_with_three_times_what_lies():
    """F = 3 mu g s, s = g t^2/2 fallen: weight 1, stopping the rest 2. Mean over the arrival of 8 of 80 nodes: 2 %.

    Nodes arrive when s = (j + 1/2) l0: between two such times the impulse is that of the continuous chain.
    """
    segments, length = 80, 10.0
    model, mass, weight = fallen_chain(segments, length)
    arrivals = np.sqrt(2.0 * (np.arange(segments) + 0.5) * length / segments / G)
    impulses, before = [], 0.0
    for time in arrivals:
        model.step(time - before)
        before = time
        impulses.append(mass @ model.velocities[:, 2] + weight * time)  # of the ground
    mean = np.diff(impulses[::8]) / np.diff(arrivals[::8])
    lying = weight / length * 0.5 * G * np.diff(arrivals[::8] ** 3) / 3.0 / np.diff(arrivals[::8])
    np.testing.assert_allclose(mean[1:], 3.0 * lying[1:], rtol=0.02)


def test_nothing_bounces_and_no_energy_comes_from_nowhere():
    """The trapezoidal rule of the audit needs steps far below the time of an impact, 1 ms."""
    model, mass, _ = fallen_chain(segments=10, length=2.0)
    audit = EnergyAudit(model)
    fallen = mass.sum() * G * 1.0  # its centre falls by 1 m
    met = np.zeros(11, bool)
    for _ in range(24_000):
        audit.step(5e-5)
        z = model.positions[:, 2]
        met |= z < 0.0
        assert z[met].max() < SINK
    assert met.all()
    assert abs(audit.residual) < 1e-4 * fallen
    assert audit.work["contact_loss"] == pytest.approx(fallen, rel=0.01)  # it sinks by 2 mm more, of 1 m
    assert audit.now.potential == pytest.approx(-0.5 * mass.sum() * G * SINK, rel=1e-3)  # weight and ground at rest


@pytest.mark.parametrize("fixed_step", [0.0, 0.001, 0.02, 0.3])
def test_a_mass_lands_slides_and_lies(fixed_step):
    """25 kg from 2 m, in any step: never pushed up again, at rest ground_sink deep."""
    tether = Tether(segments=4, initial_length=8.0)
    model = TetherDynamic(
        tether, solver=Solver(initial_shape=3, fixed_step=fixed_step), point_masses={4: 25.0}, **ground(), **FREE
    )
    start = {"kite_velocity": (3.0, 0.0, 0.0), "ground_velocity": (3.0, 0.0, 0.0)}
    model.initialize((8.0, 0.0, 2.0), ground_position=(0.0, 0.0, 2.0), **start)
    highest = []
    for _ in range(240):
        out = model.step(max(0.02, fixed_step))
        highest.append(model.positions[:, 2].max())
    assert max(highest[60:]) < SINK
    np.testing.assert_allclose(model.positions[:, 2], -SINK, rtol=1e-6)
    assert np.abs(model.velocities).max() < 1e-9
    assert out.grounded_length == pytest.approx(8.0)
    if fixed_step == 0.0:  # its fall takes sqrt(2 h/g); the impact takes mu sqrt(2 g h) = 3.13 m/s, so nothing slides on
        assert model.positions[0, 0] == pytest.approx(3.0 * np.sqrt(2.0 * 2.0 / G), abs=0.02)


@pytest.mark.parametrize("speed", [1.0, 30.0, 300.0])
def test_short_segments_do_not_tunnel(speed):
    """Segments of 5 cm, driven down at 300 m/s: 6 m in a communication step."""
    model = TetherDynamic(Tether(segments=20, initial_length=1.0), solver=STRAIGHT, **ground(), **FREE)
    down = (0.0, 0.0, -speed)
    model.initialize((1.0, 0.0, 3.0), down, ground_position=(0.0, 0.0, 3.0), ground_velocity=down)
    for _ in range(round(3.0 / speed / 0.02) + 100):
        model.step(0.02)
    np.testing.assert_allclose(model.positions[:, 2], -SINK, atol=1e-6)


def lying(segments=20, length=20.0, **changes):
    tether = Tether(segments=segments, initial_length=length, diameter=0.01)
    model = TetherDynamic(tether, solver=STRAIGHT, **ground(**changes), free_ends=(True, False))
    model.initialize((length, 0.0, -SINK), ground_position=(0.0, 0.0, -SINK))
    return model, line_density(tether) * G


def test_a_lying_chain_is_pulled():
    """Tension: friction times the weight that is dragged behind, within 0.1 %; let go, it stays."""
    model, weight = lying()
    ramp, speed, time, reached = 5.0, 0.5, 0.0, 20.0
    for _ in range(800):
        time += 0.02
        now = speed * min(1.0, time / ramp)
        reached = 20.0 + (0.5 * speed * time**2 / ramp if time < ramp else speed * (time - 0.5 * ramp))
        model.step(0.02, (reached, 0.0, -SINK), (now, 0.0, 0.0))
    dragged = np.arange(20) + 0.5  # segments' lengths of 1 m behind the middle of each one
    np.testing.assert_allclose(model.segment_tensions, FRICTION * weight * dragged, rtol=1e-3)
    stretch = FRICTION * weight * 20.0**2 / 2.0 / 614600.0  # 0.1 mm, which is let go
    for _ in range(100):
        model.step(0.02, (reached - stretch, 0.0, -SINK), (0.0, 0.0, 0.0))
    there, steps = model.positions, model.outputs().solver_steps
    for _ in range(100):
        model.step(0.02, (reached - stretch, 0.0, -SINK), (0.0, 0.0, 0.0))
    assert np.abs(model.positions - there).max() < 2.0 * 1e-3  # m in 2 s: creep below 1 mm/s
    assert model.outputs().solver_steps - steps == 100  # one in each communication step


@pytest.mark.parametrize("part", [0.5, 0.9, 0.98])
def test_what_lies_under_less_than_its_friction_hardly_creeps(part):
    """v_r part/sqrt(1 - part^2), below 1 mm/s."""
    tether = Tether(segments=1, initial_length=1.0, diameter=0.001)
    model = TetherDynamic(tether, solver=STRAIGHT, point_masses={1: 10.0}, **ground(), **FREE)
    model.initialize((1.0, 0.0, -SINK), ground_position=(0.0, 0.0, -SINK))
    friction = FRICTION * G * (10.0 + line_density(tether))
    for _ in range(50):
        model.step(0.02, kite_load=(part * friction, 0.0, 0.0))
    speed = model.velocities[1, 0]
    assert speed == pytest.approx(2e-4 * part / np.sqrt(1.0 - part**2), rel=1e-3)
    assert speed < 1e-3


def touchdown(span, rise, length, load, stiffness):
    """Tension at the touchdown [N] and length on the ground [m] of an elastic catenary that lies on a rigid ground.

    span = b + H L/EA + H/w asinh(w s/H),   rise = (sqrt(H^2 + w^2 s^2) - H)/w + w s^2/(2 EA),   s = L - b
    Jonkman, NREL/TP-500-41958 (2007), eq. 2-37, without friction.
    """

    def gap(unknown):
        h, b = np.exp(unknown[0]), unknown[1]
        s = length - b
        across = b + h * length / stiffness + h / load * np.arcsinh(load * s / h)
        return across - span, (np.hypot(h, load * s) - h) / load + load * s * s / 2.0 / stiffness - rise

    (log_h, b), _, found, message = fsolve(gap, (np.log(load * length * 0.3), 0.3 * length), xtol=1e-13, full_output=True)
    assert found == 1, message
    return np.exp(log_h), b


@pytest.mark.parametrize("model", [TetherQuasiSteady, TetherDynamic], ids=lambda model: model.variant)
def test_chain_with_touchdown_is_second_order(model):
    """Horizontal and vertical force at the kite; the ground is 2e-5 m soft, 1e-6 of the length, so as good as rigid."""
    span, rise, length, stiffness = 40.0, 15.0, 45.0, 6e5
    tether = Tether(initial_length=length, diameter=0.01, axial_stiffness=stiffness)
    load = line_density(tether) * G
    horizontal, lies = touchdown(span, rise, length, load, stiffness)
    errors = []
    for n in (20, 40, 80):
        chain = model(tether, **ground(ground_sink=2e-5), segments=n)
        out = chain.initialize((span, 0.0, rise))
        expected = -horizontal, -load * (length - lies)
        errors.append(np.abs((out.kite_force[[0, 2]] - expected) / expected))
        assert out.grounded_length == pytest.approx(lies, abs=length / n)
        assert chain.positions[1:-1, 2].min() > -3e-5
    # the touchdown lies anywhere within a segment, so the ratio of two errors is not 4 each time: mean order at least 1.7
    order = np.log2(np.array(errors[0]) / errors[-1]) / 2.0
    assert order.min() > 1.7
    assert np.max(errors[-1]) < 2e-3


def test_what_a_winch_pushes_along_the_ground_rests():
    """Paid out at 5 m/s, it lies with less tension than friction takes: refused once, now as without friction.

    Closed form: 0.7 % with the 20 segments of 2.4 m, whose touchdown lies within one.
    """
    span, rise, length, stiffness = 40.0, 15.0, 48.0, 6e5
    tether = Tether(initial_length=length, diameter=0.01, axial_stiffness=stiffness)
    load = line_density(tether) * G
    horizontal, lies = touchdown(span, rise, length, load, stiffness)
    assert load * lies > horizontal
    kite = np.array((span, 0.0, rise))
    chain = TetherQuasiSteady(tether, **ground(ground_sink=2e-5, ground_friction=1.0), segments=20)
    out = chain.initialize(kite, 5.0 * kite / np.hypot(span, rise), reel_out_speed=5.0)
    np.testing.assert_allclose(out.kite_force[[0, 2]], (-horizontal, -load * (length - lies)), rtol=0.01)
    assert out.ground_force[0] == pytest.approx(horizontal, rel=0.01)
    chain.step(0.02, kite, 5.0 * kite / np.hypot(span, rise), reel_out_speed=5.0)  # and goes on


@pytest.mark.parametrize("excess", [0.5, 5.0, 40.0])
@pytest.mark.parametrize("kite", [(30.0, 0.0, 10.0), (0.0, 0.0, 12.0), (20.0, 5.0, 0.0)], ids=str)
def test_a_pile_hangs_straight_and_lies_without_tension(kite, excess):
    """More length than heights and distance: the kite carries what hangs below it, the ground the rest."""
    length = np.hypot(*kite[:2]) + kite[2] + excess
    tether = Tether(segments=40, initial_length=length, diameter=0.01)
    model = TetherQuasiSteady(tether, **ground())
    out = model.initialize(kite)
    weight = line_density(tether) * G
    almost_none = 1e-3 * weight * length  # up to which the equilibrium may hold compression, `lying_chain.MOST_COMPRESSION`
    assert np.abs(out.kite_force[:2]).max() < almost_none
    assert -out.kite_force[2] == pytest.approx(weight * kite[2], abs=weight * length / 40)  # whole nodes hang
    assert np.abs(out.ground_force[:2]).max() < almost_none
    assert out.grounded_length == pytest.approx(length - kite[2], abs=2.0 * length / 40)
    assert model.positions[:, 2].min() > -1.5 * SINK  # the foot carries up to half a segment that hangs
    assert np.abs(model.segment_lengths / (length / 40) - 1.0).max() < 1e-4  # nothing is compressed


def test_friction_of_a_steady_turn_holds_against_the_sliding():
    """A tether that lies all along and turns about its ground end: the tensions rise by mu m g against each node's motion.

    At rest there is none.
    """
    tether = Tether(segments=20, initial_length=20.0, diameter=0.01)
    weight = line_density(tether) * G
    for friction, speed in ((0.5, 1.0), (0.0, 1.0), (0.5, 0.0)):
        model = TetherQuasiSteady(tether, **ground(ground_friction=friction))
        out = model.initialize((19.9, 0.0, -SINK), (0.0, speed, 0.0))
        side = -out.kite_force[1] - out.ground_force[1]  # what pulls the tether around, less what holds its end
        torque = -19.9 * out.kite_force[1]
        if friction * speed == 0.0:
            assert abs(side) < 1e-9
        else:  # about the ground end: friction at each node times its distance, v_r = 0.1 m/s smooths it near the end
            r = model.positions[1:-1, :2]
            slides = speed * np.hypot(*r.T) / 19.9
            expected = friction * weight * np.sum(np.hypot(*r.T) * slides / np.hypot(slides, 0.1))
            assert torque == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("model", [TetherQuasiSteady, TetherDynamic, TetherCatenary], ids=lambda model: model.variant)
def test_a_ground_that_nothing_touches_changes_no_bit(model):
    """Shapes, a swing, and reeling 100 m above the ground."""
    found = []
    for contact in ("none", "flat"):
        tether = model(initial_length=60.0, ground_contact=contact, ground_height=-100.0)
        out = tether.initialize((30.0, 0.0, 40.0), (0.0, 5.0, 0.0))
        for k in range(20):
            out = tether.step(0.02, (30.0, 0.1 * (k + 1), 40.0), (0.0, 5.0, 0.0), reel_out_speed=0.3)
        found.append(np.concatenate([np.ravel(each) for each in out]))
    np.testing.assert_array_equal(*found)


def test_a_winch_that_holds_a_force_drags_a_lying_tether():
    """T = winch_force at every instant; beyond friction the tether comes home."""
    tether = Tether(segments=10, initial_length=20.0, diameter=0.01)
    winch = {"winch_control": "force", "input_continuation": "held", "initial_shape": "straight"}
    model = TetherDynamic(tether, **ground(), **winch, free_ends=(False, True), point_masses={10: 1.0})
    model.initialize((20.0, 0.0, -SINK), ground_position=(0.0, 0.0, -SINK))
    friction = FRICTION * G * (1.0 + line_density(tether) * 19.0)
    for part, comes in ((0.8, False), (1.2, True)):
        before = model.positions[-1, 0]
        for _ in range(100):
            out = model.step(0.02, winch_force=part * friction)
            assert out.ground_tension == pytest.approx(part * friction, rel=1e-9)
        assert (before - model.positions[-1, 0] > 0.5) == comes


def test_powers_of_the_ground_are_the_rates_of_its_energy():
    """At any instant, with the accelerations of the independent chain: E(t + dt) - E(t - dt) = 2 dt (power - losses)."""
    random = np.random.default_rng(4)
    nodes = np.linspace((0.0, 0.0, 0.0), (9.0, 0.0, 0.0), 7) + random.normal(size=(7, 3)) * (0.2, 0.2, 0.003)
    soft = {"axial_stiffness": 1e3, "axial_damping": 0.0}
    velocities = random.normal(size=(7, 3)) * (1.0, 1.0, 0.05)
    other = Chain(nodes, velocities, 9.0, (True, True), stiffness=1e3, material=0.0)
    model = TetherDynamic(Tether(segments=6, initial_length=9.0, **soft), solver=STRAIGHT, **ground(), **FREE)
    model.initialize((9.0, 0.0, 0.0))

    def energy(x, v):
        state = model.get_state()
        state[at.STATE_HEADER : at.nodes_end(6)] = np.concatenate((x.ravel(), v.ravel()))
        model.set_state(state)
        return model.energy()

    x, v = other.x, other.v
    assert 0 < np.sum(x[:, 2] < 0.0) < 7
    a = other.rates(0.0, np.concatenate((x.ravel(), v.ravel())))[21:].reshape(-1, 3)
    dt = 1e-6
    before, now, after = (energy(x + v * t + 0.5 * a * t * t, v + a * t) for t in (-dt, 0.0, dt))
    assert min(now.contact_loss, now.sliding_loss) > 1e-3
    # third derivatives: E omega^2 a with omega = 1e3 1/s, and rounding of 100 J is 1e-14 J/(2 dt) = 1e-8 W
    assert (after.total - before.total) / (2.0 * dt) == pytest.approx(now.power, abs=1e-3 * now.contact_loss)


def test_a_rope_that_is_pulled_below_its_friction_creeps():
    """A net pull P moves a node at v_r P/sqrt(F^2 - P^2): after 10 s friction holds 1 N of 80. scipy solves the springs."""
    n, length, stiffness, pull, sliding = 10, 50.0, 6e6, 80.0, 1.0
    rope = Tether(segments=n, initial_length=length, diameter=0.02, axial_stiffness=stiffness, drag_coefficient=0.0)
    tether = TetherDynamicFree(rope, kite_mass=0.0, ground=Ground(ground_contact="flat", ground_friction=sliding))
    weight = line_density(rope) * length * 9.81

    def creep(time, moved):
        below = np.concatenate(([0.0], moved))
        tension = np.maximum(stiffness * n / length * np.diff(below), 0.0)
        net = np.append(tension[1:], pull * min(1.0, time / 2.0)) - tension
        friction = sliding * weight / n * np.append(np.ones(n - 1), 0.5)
        part = np.clip(net / friction, -0.999999, 0.999999)
        return CREEP * part / np.sqrt(1.0 - part**2)

    own = solve_ivp(creep, (0.0, 12.0), np.zeros(n), "LSODA", rtol=1e-8, atol=1e-10, t_eval=[4.0, 12.0])
    expected = stiffness * n / length * own.y[0]
    tether.initialize(ground_position=(0.0, 0.0, 0.0), kite_position=(length, 0.0, -0.002))
    held = [tether.step(0.02, kite_load=(pull * min(1.0, k / 100), 0.0, 0.0)).ground_force[0] for k in range(600)]
    assert held[199] == pytest.approx(expected[0], abs=1.0)
    assert held[599] == pytest.approx(expected[1], abs=0.3)
    assert expected[0] < 65.0 < 78.0 < expected[1]
