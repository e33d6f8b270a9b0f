"""Lines that break and let go.

A taut rope that parts: an elastic wave runs into it, behind which rope moves at T/sqrt(EA mu) and is free of tension, so the
end recoils at that speed until the wave comes back. The tension that stretched the rope did T^2 L/(2 EA) of work, which
becomes kinetic energy of that size.

momentum      of two masses that fly apart on a rope in empty space: constant, whatever breaks
energy        what a spring that breaks held is lost, all else is accounted for
free flight   x0 + v t + (g + P/m) t^2/2 of what a tether lets go
"""

import numpy as np
import pytest

from mechanics import line_density
from tetherfmu import (
    EnergyAudit,
    Environment,
    Ground,
    Line,
    Point,
    Solver,
    StepRefused,
    Tether,
    TetherDynamic,
    TetherDynamicFree,
    TetherStraight,
    TetherSystem,
)
from tetherfmu.runtime import layout as at

VOID = Environment(gravity=0.0, air_density=0.0)
LENGTH, FORCE = 100.0, 2000.0
WAVE = np.sqrt(Tether().axial_stiffness / line_density(Tether()))  # speed of elastic waves [m/s]
RECOIL = FORCE / np.sqrt(Tether().axial_stiffness * line_density(Tether()))  # T/sqrt(EA mu) [m/s]
pytestmark = pytest.mark.filterwarnings("ignore:.*presses its ends apart", "ignore:.*winch, broke")  # ropes recoil


def stretched(segments, model=TetherDynamic, **more):
    """A straight tether of LENGTH along x under FORCE, and where its kite end is [m]."""
    strain = FORCE / Tether().axial_stiffness
    kite = np.array((LENGTH * (1.0 + strain), 0.0, 0.0))
    tether = model(Tether(segments=segments, initial_length=LENGTH, **more), VOID)
    tether.initialize(kite_position=kite)
    return tether, kite


def test_recoil_of_a_released_end_is_that_of_the_elastic_wave():
    tether, kite = stretched(100)
    step = 0.02 * LENGTH / WAVE
    speeds = []
    for _ in range(50):  # then the wave is at the ground
        outputs = tether.step(step, kite_position=kite, release=True)
        speeds.append(-tether.velocities[-1, 0])
    # the damper makes the front a fifth of the rope wide; behind it nothing is left of it (1e-4)
    assert speeds[25:45] == pytest.approx(np.full(20, RECOIL), rel=1e-3)
    assert outputs.broken
    assert outputs.break_time == 0.0
    assert outputs.kite_force == pytest.approx(np.zeros(3))


def test_recoil_of_a_broken_end_is_that_of_the_elastic_wave():
    pulled, step = 0.05, 1e-4  # [m/s], so that the last segment has the largest tension; [s]
    tether, kite = stretched(100, breaking_force=FORCE * (1.0 + 1e-3))
    outputs, speeds = tether.outputs(), []
    for k in range(800):
        outputs = tether.step(
            step, kite_position=np.add(kite, (k * step * pulled, 0.0, 0.0)), kite_velocity=(pulled, 0.0, 0.0)
        )
        if outputs.broken:
            speeds.append(-tether.velocities[-2, 0])
    assert speeds[60:100] == pytest.approx(np.full(40, RECOIL), rel=0.01)  # the tension is not quite the same everywhere
    assert np.argmax(tether.segment_lengths) == 99


def test_a_segment_breaks_when_its_tension_is_reached():
    tether, kite = stretched(20, breaking_force=2500.0)
    velocity = np.array((3.0, 0.0, 0.0))
    for k in range(100):
        outputs = tether.step(0.001, kite_position=kite + 0.001 * k * velocity, kite_velocity=velocity)
        assert outputs.peak_tension <= 2500.0 * (1.0 + 1e-7)  # `drum_events.OVERLOAD`
        if outputs.broken:
            break
    assert outputs.broken
    assert 0.001 * k <= outputs.break_time <= 0.001 * (k + 1)
    assert outputs.peak_tension == pytest.approx(2500.0, rel=1e-7)
    (said,) = [each for each in tether.implausible if "broke" in each]
    assert f"{outputs.break_time:.6g} s after the start under 2500 N" in said


def two_masses(speed, **more):
    """Two masses in empty space on a rope, which fly apart."""
    points = [
        Point("a", (0.0, 0.0, 0.0), (-speed, 1.0, 0.0), mass=5.0),
        Point("b", (50.0, 0.0, 0.0), (speed, 0.5, 2.0), mass=8.0),
    ]
    line = Line("rope", "a", "b", Tether(segments=10, initial_length=50.2, breaking_force=2000.0, **more))
    system = TetherSystem(points, [line], VOID)
    system.initialize()
    return system


def momentum(system, masses):
    """Momentum of the nodes [N s] with the masses of the points."""
    mu = line_density(Tether())
    v = system.velocities["rope"]
    own = np.full(len(v), mu * 50.2 / (len(v) - 1))
    own[[0, -1]] *= 0.5
    outputs = system.outputs()
    return own @ v + sum(mass * outputs.points[name].velocity for name, mass in masses.items())


@pytest.mark.parametrize("released", [False, True])
def test_momentum_is_kept(released):
    system = two_masses(8.0)
    before, broken = momentum(system, {"a": 5.0, "b": 8.0}), False
    for k in range(60):
        outputs = system.step(0.005, releases={"rope": released and k == 30})
        broken = broken or outputs.lines["rope"].broken
    assert broken
    # linear invariants are kept by each step to rounding, of which there are some thousands
    assert momentum(system, {"a": 5.0, "b": 8.0}) == pytest.approx(before, abs=1e-10 * np.abs(before).max())


# --- energy


@pytest.mark.parametrize("damping", [0.0, 473.0])
def test_the_energy_of_a_broken_spring_is_a_loss_with_a_name(damping):
    tether, kite = stretched(10, breaking_force=2200.0, axial_damping=damping)
    audit, pulled, step = EnergyAudit(tether), np.array((2.0, 0.0, 0.0)), 2e-5
    outputs = tether.outputs()
    for _k in range(6000):
        moving = not outputs.broken
        kite = kite + moving * step * pulled
        outputs = audit.step(step, kite_position=kite, kite_velocity=moving * pulled)
    rest = LENGTH / 10
    assert outputs.broken
    in_damper = 0.15 if damping else 0.0  # part of the tension, at most
    assert (1.0 - in_damper) ** 2 < audit.now.broken / (2200.0**2 * rest / (2.0 * 614600.0)) < 1.0 + 1e-6
    assert abs(audit.residual) < 0.01 * audit.now.broken  # the rule of the audit sees a jump of powers within a step


# --- letting go


def flying(**more):
    """A kite on a tether in wind, with a load."""
    kite = TetherDynamicFree(segments=8, initial_length=300.0, kite_mass=20.0, **more)
    kite.initialize((200.0, 0.0, 240.0), (0.0, 15.0, 3.0), wind_velocity=(8.0, 0.0, 0.0), kite_load=(50.0, 0.0, 900.0))
    return kite


@pytest.mark.parametrize("solver", [{}, {"fixed_step": 0.005}, {"fixed_step": 0.005, "fixed_step_method": "backward_euler"}])
def test_a_kite_that_is_released_flies_a_parabola(solver):
    kite, load = flying(**solver), np.array((30.0, -10.0, 150.0))
    for _ in range(10):
        outputs = kite.step(0.02)
    x, v = outputs.kite_position, outputs.kite_velocity
    kite.step(0.02, release=True, kite_load=load)  # which changes from the load before within this step
    start = kite.outputs()
    assert np.linalg.norm(start.kite_position - x - 0.02 * v) < 0.02
    for _ in range(50):
        outputs = kite.step(0.02, release=False)  # it stays free
    acceleration, time = load / 20.0 - (0.0, 0.0, 9.81), 1.0
    expected = start.kite_position + time * start.kite_velocity + 0.5 * time**2 * acceleration
    order_one = 0.5 * time * 0.005 * np.linalg.norm(acceleration)  # of backward Euler
    iterated = 1e-6 if solver else 1e-9  # in fixed steps, see `backward_euler.CLOSE_IN_STAGE`
    assert outputs.kite_position == pytest.approx(expected, abs=order_one + 1e-3 if len(solver) > 1 else iterated)
    assert outputs.kite_velocity == pytest.approx(start.kite_velocity + time * acceleration, abs=iterated)
    assert outputs.broken
    assert outputs.break_time == pytest.approx(0.2)
    assert outputs.kite_tension == 0.0
    assert outputs.kite_end_mass == 0.0
    assert np.linalg.norm(kite.positions[-1] - outputs.kite_position) > 1.0


def test_a_kite_without_mass_cannot_be_released():
    kite = TetherDynamicFree(segments=4, initial_length=50.0, kite_mass=0.0)
    kite.initialize((30.0, 0.0, 39.0))
    state = kite.get_state()
    with pytest.raises(StepRefused, match="the released end has no mass"):
        kite.step(0.02, release=True)
    assert np.array_equal(kite.get_state(), state)
    kite.step(0.02)


def test_what_is_released_falls_onto_the_ground():
    tether = TetherDynamic(
        Tether(segments=10, initial_length=30.0, density=7000.0), ground=Ground(ground_contact="flat", ground_height=0.0)
    )
    tether.initialize((0.0, 0.0, 29.0), ground_position=(0.0, 0.0, 1.0), wind_velocity=(4.0, 0.0, 0.0))
    for k in range(600):
        outputs = tether.step(0.02, kite_position=(0.0, 0.0, 29.0 + 0.1 * k), release=True, wind_velocity=(0.0, 0.0, 0.0))
    # all lies but the first segment, which hangs from the ground end 1 m above the ground
    assert np.all(tether.positions[2:, 2] < 0.01)
    assert np.all(tether.positions[1:, 2] > -0.05)
    assert np.abs(tether.velocities[2:]).max() < 0.02
    assert outputs.grounded_length > 20.0


def test_a_tether_that_cannot_let_go_says_so():
    straight = TetherStraight()
    straight.initialize()
    with pytest.raises(ValueError, match="and has no effect: a TetherStraight cannot let go"):
        straight.step(0.02, release=True)


@pytest.mark.parametrize("control", ["speed", "force"])
def test_a_step_that_is_given_up_after_a_break_begins_with_the_whole_line(control):
    """It has the numbers of those fixed steps that do it anew; the recoil needs more internal steps than there may be."""
    step, segments, found = 2.0, 80, []
    drum = {"winch_mass": 30.0} if control == "force" else {}
    given = {"winch_force": 2500.0} if control == "force" else {"reel_out_speed": 1.0}
    strong = Tether(segments=segments, initial_length=LENGTH, breaking_force=3000.0, slack_stiffness_ratio=0.0)
    for solver in (Solver(relative_tolerance=1e-7), Solver(fixed_step=step * segments / at.COARSE_WORK)):
        tether = TetherDynamic(strong, solver=solver, winch_control=control, **drum)
        tether.initialize((0.0, 0.0, 100.45), kite_velocity=(0.0, 0.0, 2.0), reel_out_speed=1.0)
        found.append(tether.step(step, (0.0, 0.0, 100.45 + 3.0 * step), (0.0, 0.0, 3.0), **given))
    assert found[0].break_time > 0.0
    for name in ("break_time", "tether_length", "winch_speed", "ground_tension", "kite_tension"):
        assert getattr(found[0], name) == getattr(found[1], name), name


def test_a_refused_step_undoes_a_release():
    tether = TetherDynamic(segments=5, initial_length=100.0)
    tether.initialize((60.0, 0.0, 78.0))
    other = TetherDynamic(segments=5, initial_length=100.0)
    other.initialize((60.0, 0.0, 78.0))
    with pytest.raises(StepRefused):
        tether.step(0.02, release=True, kite_position=(np.nan, 0.0, 0.0))
    assert not tether.outputs().broken
    for _ in range(3):
        mine, theirs = tether.step(0.02, kite_position=(60.0, 0.0, 78.1)), other.step(0.02, kite_position=(60.0, 0.0, 78.1))
    assert np.array_equal(mine.kite_force, theirs.kite_force)
    assert np.array_equal(tether.positions, other.positions)


# --- what is in series, wind at points, energies of what is left


def test_a_weak_link_breaks():
    rope = {"density": 724.0, "initial_length": 40.0, "segments": 4}
    weak = Tether(**rope | {"initial_length": 2.0, "segments": 1}, breaking_force=1000.0)
    tether = TetherDynamic([Tether(**rope, breaking_force=5000.0), weak, Tether(**rope)])
    tether.initialize((81.0, 0.0, 2.0))
    for k in range(50):
        outputs = tether.step(0.02, kite_position=(81.0 + 0.1 * k, 0.0, 2.0), kite_velocity=(5.0, 0.0, 0.0))
    assert outputs.broken
    assert tether.segment_lengths[4] > 3.0
    assert any("segment 5, counted" in each for each in tether.implausible)


def test_the_energy_of_a_tether_that_is_released():
    tether = TetherDynamic(segments=6, initial_length=82.0)  # slack: the rule of the audit sees no jump of powers
    velocity = np.array((0.0, 6.0, 1.0))
    tether.initialize((40.0, 0.0, 70.0), velocity)
    audit, step = EnergyAudit(tether), 5e-4
    for k in range(2000):
        kite = np.array((40.0, 0.0, 70.0)) + k * step * velocity
        audit.step(step, kite_position=kite, kite_velocity=velocity, release=k == 1000)
    assert audit.now.broken < 0.0  # the half particle at the end had been that of the driver
    assert abs(audit.residual) < 0.02 * abs(audit.now.broken)


@pytest.mark.parametrize("event", ["break", "release"])
@pytest.mark.parametrize("at_nodes", [False, True])
def test_wind_blows_on_what_is_left(event, at_nodes):
    force = 1e-3 if event == "break" else 0.0  # it breaks at once
    tether = TetherDynamic(segments=6, initial_length=60.0, breaking_force=force, wind_points=0 if at_nodes else 4)
    tether.initialize((0.0, 0.0, 59.0))
    for _ in range(100):
        if at_nodes:
            winds = {"wind_velocity": np.tile((0.0, 20.0, 0.0), (7, 1))}
        else:
            winds = {"wind_at": np.tile((0.0, 20.0, 0.0), (4, 1))}
        outputs = tether.step(0.01, kite_position=(0.0, 0.0, 59.0), release=event == "release", **winds)
    assert outputs.broken
    assert tether.positions[3, 1] > 5.0
    assert outputs.shape[:, 1].max() == pytest.approx(tether.positions[:, 1].max())
