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
    PlausibilityWarning,
    Point,
    Solver,
    StepRefused,
    Tether,
    TetherDynamic,
    TetherDynamicFree,
    TetherStraight,
    TetherSystem,
    Winch,
)

VOID = Environment(gravity=0.0, air_density=0.0)
LENGTH, FORCE = 100.0, 2000.0
WAVE = np.sqrt(Tether().axial_stiffness / line_density(Tether()))  # speed of elastic waves [m/s]
RECOIL = FORCE / np.sqrt(Tether().axial_stiffness * line_density(Tether()))  # T/sqrt(EA mu) [m/s]
pytestmark = pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")


def stretched(segments, model=TetherDynamic, **more):
    """A straight tether of LENGTH along x under FORCE, and where its kite end is [m]."""
    strain = FORCE / Tether().axial_stiffness
    kite = np.array((LENGTH * (1.0 + strain), 0.0, 0.0))
    tether = model(Tether(segments=segments, initial_length=LENGTH, **more), VOID)
    tether.initialize(kite_position=kite)
    return tether, kite


def test_recoil_of_a_released_end_is_that_of_the_elastic_wave():
    tether, kite = stretched(100)
    time, count = LENGTH / WAVE, 50  # the wave is then at the ground
    for _ in range(count):
        tether.step(time / count, kite_position=kite, release=True)
    moved = kite[0] - tether.positions[-1, 0]
    # the front is a few segments wide, see `test_vibration.py`: below 1 % of the way at 100 segments
    assert moved == pytest.approx(RECOIL * time, rel=0.01)
    assert tether.outputs().broken and tether.outputs().break_time == 0.0
    assert tether.outputs().kite_force == pytest.approx(np.zeros(3))


def test_recoil_of_a_broken_end_is_that_of_the_elastic_wave():
    pulled = 0.05  # [m/s], so that the last segment has the largest tension
    tether, kite = stretched(100, breaking_force=FORCE * (1.0 + 1e-3))
    step, torn = 1e-4, None
    for k in range(400):
        outputs = tether.step(step, kite_position=kite + (k * step * pulled, 0.0, 0.0), kite_velocity=(pulled, 0.0, 0.0))
        if outputs.broken and torn is None:
            torn = k, tether.positions[-2, 0]
        if torn and k == torn[0] + 250:
            assert torn[1] - tether.positions[-2, 0] == pytest.approx(RECOIL * 250 * step, rel=0.01)
            assert outputs.max_tension <= FORCE * 1.01
            return
    pytest.fail("it did not break")


def test_a_segment_breaks_when_its_tension_is_reached():
    tether, kite = stretched(20, breaking_force=2500.0)
    velocity = np.array((3.0, 0.0, 0.0))
    for k in range(100):
        outputs = tether.step(0.001, kite_position=kite + 0.001 * k * velocity, kite_velocity=velocity)
        assert outputs.peak_tension <= 2500.0 * (1.0 + 1e-7)  # `drum_events.OVERLOAD`
        if outputs.broken:
            break
    assert outputs.broken and 0.001 * k <= outputs.break_time <= 0.001 * (k + 1)
    assert outputs.peak_tension == pytest.approx(2500.0, rel=1e-7)
    (said,) = [each for each in tether.implausible if "broke" in each]
    assert f"{outputs.break_time:.6g} s after the start under 2500 N" in said


def two_masses(speed, **more):
    """Two masses in empty space on a rope, which fly apart."""
    points = [Point("a", (0.0, 0.0, 0.0), (-speed, 1.0, 0.0), mass=5.0), Point("b", (50.0, 0.0, 0.0), (speed, 0.5, 2.0), mass=8.0)]
    line = Line("rope", "a", "b", Tether(segments=10, initial_length=50.2, breaking_force=3000.0, **more))
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
