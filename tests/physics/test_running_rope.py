"""Rope that a winch pays out flows past the nodes and carries its momentum (docs/models/theory.md, "Rope that flows").

mass      a mass on a heavy, stiff rope whose winch pays out with the acceleration a: the rope pulls at the winch with
          (M + mu L)(g - a), whatever the number of segments
light     a drum lighter than the rope under constant forces: waves die out (it once fluttered: 64 to 2840 N in 0.4 s)

Energy: `test_sections.py`.  A moving observer: `test_invariance.py`.
"""

import numpy as np
import pytest

from tetherfmu import Line, Point, Tether, TetherDynamicFree, TetherSystem, Winch

G = 9.81
MASS, DENSITY, LENGTH, DIAMETER = 20.0, 1.0, 20.0, 0.02  # of the load [kg], of the rope [kg/m], [m], [m]
ROPE = {
    "initial_length": LENGTH,
    "diameter": DIAMETER,
    "density": DENSITY / (0.25 * np.pi * DIAMETER**2),
    "axial_stiffness": 1e6,
    "axial_damping": 5e3,
    "air_density": 0.0,
}
DRUM = 30.0  # [kg]
METHODS = {"adaptive": {}, "second_order": {"fixed_step": 0.005}}


def rise(time):
    """From 0 to 1 in 0.5 s without a kink, and its first and second integral over the time."""
    t = min(time, 0.5)
    after = time - t
    once, twice = 4.0 * t**3 - 4.0 * t**4 + after, t**4 - 0.8 * t**5 + 0.25 * after + 0.5 * after**2
    return 4.0 * t * t * (3.0 - 4.0 * t), once, twice


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("control", ["speed", "length", "force"])
@pytest.mark.parametrize("segments", [10, 40])
def test_the_whole_rope_is_accelerated(segments, control, method):
    """0.1 N: what is left of the waves. Without the momentum of the flow half of the rope's inertia is missing, 10.4 N."""
    options = {"winch_control": control, "kite_start": "equilibrium", **METHODS[method]}
    options |= {"winch_mass": DRUM} if control == "force" else {}
    tether = TetherDynamicFree(segments=segments, kite_mass=MASS, **ROPE, **options)
    step, weight = 0.005, (MASS + DENSITY * LENGTH) * G
    first = {"winch_length": LENGTH} if control == "length" else {}
    outputs = tether.initialize(kite_position=(0.0, 0.0, -LENGTH), ground_position=(0.0, 0.0, 0.0), **first)
    for k in range(300):
        part, speed, length = rise(k * step)
        inputs = {"speed": {"reel_out_speed": speed}, "length": {"winch_length": LENGTH + length}}
        inputs["force"] = {"winch_force": weight - part * (MASS + DENSITY * LENGTH + DRUM)}
        outputs = tether.step(step, **inputs[control])
    heavy = MASS + DENSITY * outputs.tether_length
    acceleration = 1.0
    if control == "force":  # T = W + m a
        acceleration = (heavy * G - inputs["force"]["winch_force"]) / (heavy + DRUM)
        assert outputs.ground_tension == pytest.approx(heavy * (G - acceleration), abs=0.1)
    assert outputs.winch_speed > 1.0
    assert -outputs.ground_force[2] == pytest.approx(heavy * (G - acceleration), abs=0.1)


def test_a_speed_that_is_held_from_step_to_step_accelerates_the_whole_rope():
    """Mean over 50 steps, within 1 N: the damper of 2.5 kN s/m feels each step of the speed; 10 N without the jumps."""
    options = {"kite_start": "equilibrium", "input_continuation": "held"}
    tether = TetherDynamicFree(segments=10, kite_mass=MASS, **ROPE, **options)
    outputs, step, found = tether.initialize(kite_position=(0.0, 0.0, -LENGTH), ground_position=(0.0, 0.0, 0.0)), 0.005, []
    for k in range(300):
        outputs = tether.step(step, reel_out_speed=rise((k + 0.5) * step)[1])
        found.append(-outputs.ground_force[2] - (MASS + DENSITY * outputs.tether_length) * (G - 1.0))
    assert np.mean(found[-50:]) == pytest.approx(0.0, abs=1.0)


def light_drum(drum, kite, segments=10, damping=0.01, **options):
    """Ranges of the tension [N] in eight windows of 50 ms after a push, and the energy [J] at their ends.

    Masses in those of the rope; 100 m upright. The energy is that of rope, kite, drum and of the constant forces on kite
    and drum; rope on the drum has none, so the strain T^2/(2 EA) per length that it leaves with counts, too.
    """
    length, density, stiffness = 100.0, 0.0125, 6e5
    rope, wave = density * length, np.sqrt(stiffness / density)
    force = max(1000.0, 2.0 * (1.0 + kite) * rope * G)
    tether = Tether(
        segments=segments,
        initial_length=length,
        diameter=0.004,
        density=density / (0.25 * np.pi * 0.004**2),
        axial_stiffness=stiffness,
        axial_damping=damping * stiffness * length / wave,
        drag_coefficient=0.0,
    )
    winch = Winch(winch_control="force", winch_start="equilibrium", winch_mass=drum * rope, winch_damping=20.0)
    points = [Point("ground", (0.0, 0.0, 0.0)), Point("kite", (0.0, 0.0, 1.0016 * length), mass=kite * rope)]
    system = TetherSystem(points, [Line("line", "ground", "kite", tether, winch=winch)], **options)
    load, weight = {"kite": (0.0, 0.0, force)}, force - (1.0 + kite) * rope * G
    system.initialize(loads=load, winch_forces={"line": weight})
    tensions, energies, strain = [], [], [0.0]
    for k in range(400):
        outputs = system.step(0.001, loads=load, winch_forces={"line": weight + (200.0 if k in (1, 2) else 0.0)})
        line = outputs.lines["line"]
        tensions.append(line.ground_tension)
        strain.append(line.winch_speed * line.ground_tension**2 / (2.0 * stiffness))
        if k % 50 == 49:
            found = system.energy().lines["line"]
            of_forces = weight * line.tether_length - force * outputs.points["kite"].position[2]
            energies.append(found.total + found.drum + of_forces + np.trapezoid(strain, dx=0.001))
    return np.ptp(np.reshape(tensions, (8, 50)), axis=1), np.array(energies)


@pytest.mark.parametrize(
    ("drum", "kite", "damping"), [(0.05, 0.2, 0.01), (0.05, 0.2, 0.05), (1.0, 0.2, 0.01), (0.0, 20.0, 0.01)]
)
def test_a_light_drum_does_not_flutter(drum, kite, damping):
    ranges, energies = light_drum(drum, kite, damping=damping)
    assert (np.diff(energies) < 0.0).all()
    assert ranges[-1] < 0.7 * ranges[1]
    assert ranges[-1] < 0.2 * ranges[0] or drum == 1.0
    assert ranges.max() < 2.0 * ranges[:2].max()


def random_drum(seed):
    """Arguments of `light_drum`."""
    random = np.random.default_rng(seed)
    masses = {"drum": 10.0 ** random.uniform(-2.0, 2.0), "kite": 10.0 ** random.uniform(-1.0, 2.0)}
    return masses | {"segments": int(random.integers(1, 12)), "damping": 10.0 ** random.uniform(-5.0, -1.5)}


@pytest.mark.parametrize("seed", range(4))
def test_no_random_drum_makes_waves(seed):
    ranges, energies = light_drum(**random_drum(seed))
    assert ranges[4:].max() < 1.5 * ranges[:4].max()
    assert (np.diff(energies) < 0.0).all()
