"""Symmetries hold for random extremes, not only for chosen scenes: physics knows no x, no left, no first end, and no metre.

turn, mirror    about z; in zero gravity about any axis
reversed ends   ground and kite change places
units           with lengths a x, times b t, masses c m every quantity grows by its unit: velocity a/b, force a c/b^2,
                EA a c/b^2, D a c/b, density c/a^3, gravity a/b^2; forces and nodes follow (non-dimensional similarity)
split steps     a step of h with ends of constant velocity is two steps of h/2

a, b, c are powers of two, so that units change no digit: only the guards in metres (a coincident node, still air) and the
limits of the parameters know a unit. The other runs differ by rounding, split steps by the solver's tolerance. A slack or
snapping tether is chaotic and may make anything of that, and rounding decides whether a step of the solver is accepted or
not; so each scene says itself what it makes of a kite that starts 1e-11 of its distance elsewhere, to either side, and of
ten times the tolerance, and a symmetric run may differ by ten times as much.
One side alone may end near the scene by luck.
"""

import numpy as np
import pytest
from hypothesis import Phase, assume, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tetherfmu import StepRefused, TetherDynamic, TetherQuasiSteady
from tetherfmu.runtime.parameters import Environment, Solver, Tether

COUNT = 6
SAME = np.eye(3)
RUNS = settings(max_examples=30, deadline=None, derandomize=True, phases=(Phase.explicit, Phase.generate))


def vectors(size):
    return st.tuples(*[st.floats(-size, size)] * 3).map(np.array)


@st.composite
def scenes(draw):
    """A dict of a tether, its surroundings and its motion, from everyday to extreme, in SI units."""
    length = 10.0 ** draw(st.floats(0.0, 4.0))
    slack = draw(st.floats(-0.01, 0.5))
    direction = draw(vectors(1.0).filter(lambda a: np.linalg.norm(a) > 0.1))
    return {
        "segments": draw(st.integers(1, 12)),
        "length": length,
        "stiffness": 10.0 ** draw(st.floats(3.0, 8.0)),
        "damping": draw(st.sampled_from([0.0, 1.0, 473.0, 1e4])),
        "diameter": draw(st.sampled_from([0.001, 0.004, 0.03])),
        "density": draw(st.sampled_from([200.0, 724.0, 3000.0])),
        "gravity": draw(st.sampled_from([0.1, 9.81, 25.0])),
        "kite": direction / np.linalg.norm(direction) * length * (1.0 - slack),
        "velocity": draw(vectors(60.0)),
        "wind": draw(vectors(40.0)) + np.array([1.0, 2.0, 0.5]),
        "reel": draw(st.floats(-0.01, 0.02)) * length,
        "step": 10.0 ** draw(st.floats(-4.0, -1.7)),
    }


def in_units(scene, a, b, c):
    """The same scene in units of length, time and mass that are a, b, c times smaller."""
    factors = {
        "length": a,
        "stiffness": a * c / b**2,
        "damping": a * c / b,
        "diameter": a,
        "density": c / a**3,
        "air": c / a**3,
        "gravity": a / b**2,
        "kite": a,
        "velocity": a / b,
        "wind": a / b,
        "reel": a / b,
        "step": b,
    }
    return {"air": 1.225, **scene} | {name: ({"air": 1.225, **scene})[name] * factor for name, factor in factors.items()}


def fly(scene, matrix=SAME, reverse=False, split=1, variant=TetherDynamic, tolerance=1e-6):
    """Forces on both ends (2, 3) and node positions after COUNT steps, or (None, None) if it is refused."""
    tether = Tether(
        segments=scene["segments"],
        initial_length=scene["length"],
        axial_stiffness=scene["stiffness"],
        axial_damping=scene["damping"],
        diameter=scene["diameter"],
        density=scene["density"],
    )
    air = Environment(gravity=scene["gravity"], air_density=scene.get("air", 1.225))
    model = variant(tether, air, Solver(relative_tolerance=scene.get("tolerance", tolerance), initial_shape=1))
    ends = ("ground", "kite") if reverse else ("kite", "ground")
    velocity = matrix @ scene["velocity"]

    def inputs(time):
        return {
            f"{ends[0]}_position": matrix @ scene["kite"] + velocity * time,
            f"{ends[0]}_velocity": velocity,
            f"{ends[1]}_position": np.zeros(3),
            "wind_velocity": matrix @ scene["wind"],
            "reel_out_speed": scene["reel"],
        }

    step = scene["step"] / split
    try:
        model.initialize(**inputs(0.0))
        for k in range(COUNT * split):
            out = model.step(step, **inputs(k * step))
    except StepRefused:
        return None, None
    return np.array([out.ground_force, out.kite_force]), model.positions


ROUNDING = 1e-9  # of the size, without any chaos
FORCE_ROUNDING = 1e-5  # of the largest force: stiff springs and dampers make more of it


def assert_same(found, expected, disturbed, scene):
    """Equal up to 10 times what a disturbance does, and rounding; of forces also that of positions in EA/l0 and D/(l0 h)."""
    force, x = expected
    assume(not any(positions is None for _, positions in (found, expected, *disturbed)))  # shapes that are hard to find
    size = np.abs(x).max()
    force_change, change = (max(np.abs(each[k] - expected[k]).max() for each in disturbed) for k in (0, 1))
    allowed = 10.0 * change + ROUNDING * size
    np.testing.assert_allclose(found[1], x, rtol=0, atol=allowed)
    stretch = (scene["stiffness"] + scene["damping"] / scene["step"]) * scene["segments"] / scene["length"] * 1e-14 * size
    allowed = 10.0 * force_change + FORCE_ROUNDING * np.abs(force).max() + 10.0 * stretch
    np.testing.assert_allclose(found[0], force, rtol=0, atol=allowed)


def and_elsewhere(scene):
    """The scene, and with ten times the tolerance two with their kite moved by 1e-11 of its distance."""
    move = 1e-11 * np.linalg.norm(scene["kite"]) * np.array([0.3, 0.5, -0.8])
    return scene, *(scene | {"tolerance": 1e-5, "kite": scene["kite"] + side * move} for side in (1.0, -1.0))


def moved(result, matrix, order=1, force=1.0, length=1.0):
    """Forces and positions of a run after a turn, a reversal (order -1), a change of units; a refusal as it is."""
    if result[1] is None:
        return result
    return (result[0][::order] @ matrix.T) * force, (result[1][::order] @ matrix.T) * length


@RUNS
@given(scenes(), st.floats(-np.pi, np.pi), st.booleans())
@pytest.mark.parametrize("variant", [TetherDynamic, TetherQuasiSteady])
def test_turn_and_mirror(variant, scene, angle, mirrored):
    c, s = np.cos(angle), np.sin(angle)
    scene = scene | {"damping": scene["damping"] + 1.0}  # without any, turned rounding grows from noise
    matrix = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ np.diag([1.0, -1.0 if mirrored else 1.0, 1.0])
    expected, *disturbed = (moved(fly(each, variant=variant), matrix) for each in and_elsewhere(scene))
    assert_same(fly(scene, matrix, variant=variant), expected, disturbed, scene)


@RUNS
@given(scenes(), vectors(3.0))
def test_any_turn_without_gravity(scene, axis):
    matrix = Rotation.from_rotvec(axis).as_matrix()
    scene = scene | {"gravity": 0.0, "damping": scene["damping"] + 1.0}
    expected, *disturbed = (moved(fly(each), matrix) for each in and_elsewhere(scene))
    assert_same(fly(scene, matrix), expected, disturbed, scene)


@RUNS
@given(scenes())
def test_reversed_ends(scene):
    expected, *disturbed = (moved(fly(each), SAME, order=-1) for each in and_elsewhere(scene))
    assert_same(fly(scene, reverse=True), expected, disturbed, scene)


@RUNS
@given(scenes(), st.integers(-1, 1), st.integers(-2, 2), st.integers(-2, 2))
def test_units(scene, length, time, mass):
    a, b, c = 2.0**length, 2.0**time, 2.0**mass
    units = {"force": a * c / b**2, "length": a}
    expected, *disturbed = (moved(fly(each), SAME, **units) for each in and_elsewhere(scene))
    other = in_units(scene, a, b, c)
    assert_same(fly(other), expected, disturbed, other)


@RUNS
@given(scenes(), st.sampled_from([2, 3, 5]))
def test_split_steps(scene, split):
    expected, *disturbed = (fly(scene, tolerance=tolerance) for tolerance in (1e-8, 1e-7))
    assert_same(fly(scene, split=split, tolerance=1e-8), expected, disturbed, scene)
