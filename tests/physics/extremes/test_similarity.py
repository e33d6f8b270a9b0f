"""Symmetries hold for random extremes, not only for chosen scenes: physics knows no x, no left, no first end, and no metre.

turn, mirror    about z; in zero gravity about any axis
reversed ends   ground and kite change places
units           with lengths a x, times b t, masses c m every quantity grows by its unit: velocity a/b, force a c/b^2,
                EA a c/b^2, D a c/b, density c/a^3, gravity a/b^2; forces and nodes follow (non-dimensional similarity)
split steps     a step of h with ends of constant velocity is two steps of h/2

a, b, c are powers of two, so that units change no digit: only the guards (a coincident node, still air, velocities and
forces of nearly 0) and the limits of the parameters know a unit. With a = b = c speeds and forces stay, and every digit.
The other runs differ by rounding, split steps by the solver's tolerance. A slack or snapping tether is chaotic and may
make anything of that, rounding decides whether a step of the solver is accepted or not, and a slack stiff chain is in
equilibrium wherever its residual is the rounding of EA: an iteration more or less is another shape. So where two runs
differ by more than rounding, the scene says itself what it makes of it: it is flown again with all that moves 1e-15 to
1e-11 of its size elsewhere and up to ten times the tolerance, in both ways, for along an axis rounding is less than askew.
The two runs may differ by `SPREAD` times the largest change that one of them shows; what needs `MOST` disturbed runs and
shows less is wrong.
"""

from itertools import islice

import numpy as np
import pytest
from hypothesis import Phase, assume, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tetherfmu import Environment, Solver, StepRefused, Tether, TetherDynamic, TetherQuasiSteady

MOVING = ("kite", "velocity", "wind")
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
        "steps": 6,
        "tolerance": 1e-6,
        "variant": TetherDynamic,
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


def fly(scene, matrix=SAME, reverse=False, split=1):
    """Forces on both ends (2, 3) and node positions in the end, or None if it is refused."""
    tether = Tether(
        segments=scene["segments"],
        initial_length=scene["length"],
        axial_stiffness=scene["stiffness"],
        axial_damping=scene["damping"],
        diameter=scene["diameter"],
        density=scene["density"],
    )
    air = Environment(gravity=scene["gravity"], air_density=scene.get("air", 1.225))
    model = scene["variant"](tether, air, Solver(relative_tolerance=scene["tolerance"], initial_shape=1))
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
        for k in range(scene["steps"] * split):
            out = model.step(step, **inputs(k * step))
    except StepRefused:
        return None
    return np.array([out.ground_force, out.kite_force]), model.positions


ROUNDING = 1e-9  # of the size, without any chaos
FORCE_ROUNDING = 1e-5  # of the largest force: stiff springs and dampers make more of it
SPREAD = 3.0  # difference of two runs over the largest change that disturbances make of one
MOST = 200  # disturbed scenes
DENORMAL = 1e-300  # where a number of fewer digits begins


def disturbed(scene):
    """The scene with all that moves elsewhere, by next to nothing, and a looser tolerance; again and again.

    A quasi-steady tether has no history: other steps to the same end show how well its solver finds it.
    """
    random = np.random.default_rng(1)
    while True:
        part = 10.0 ** random.uniform(-15.0, -11.0)
        moved = {name: scene[name] + part * np.linalg.norm(scene[name]) * random.uniform(-1.0, 1.0, 3) for name in MOVING}
        each = scene | moved | {"tolerance": scene["tolerance"] * 10.0 ** random.uniform(0.0, 1.0)}
        if scene["variant"] is TetherQuasiSteady:
            each["steps"] = random.integers(1, 13)
            each["step"] = scene["step"] * scene["steps"] / each["steps"]
        yield each


def assert_same(plain, other, scene, same_refusals=True):
    """Both ways to fly a scene give the same, up to rounding and `SPREAD` times what disturbances make of either.

    plain, other : functions of a scene; forces and positions in the same axes and units, or None if it is refused.
    """
    expected, found = plain(scene), other(scene)
    assume((expected or found) if same_refusals else (expected and found))  # else the shape is hard to find
    allowed = rounding(scene, expected or found)
    refused, changes = not (expected and found), np.zeros(2)
    for each in islice(disturbed(scene), MOST):
        if not refused and (difference(found, expected) <= allowed + SPREAD * changes).all():
            return
        for way, result in ((plain, expected), (other, found)):
            again = way(each)
            if refused and (again is None) != (result is None):
                return  # so little decides whether a shape is found
            if again and result:
                changes = np.maximum(changes, difference(again, result))
    assert not refused, "refused one way, and not the other"
    for k, what in enumerate(("forces", "positions")):
        np.testing.assert_allclose(found[k], expected[k], rtol=0, atol=allowed[k] + SPREAD * changes[k], err_msg=what)


def difference(a, b):
    """The largest of two runs: of forces [N] and of positions [m]."""
    return np.array([np.abs(a[k] - b[k]).max() for k in (0, 1)])


def rounding(scene, result):
    """What rounding may make of forces, also that of positions in EA/l0 and D/(l0 h), and of positions."""
    force, size = (np.abs(each).max() for each in result)
    stretch = (scene["stiffness"] + scene["damping"] / scene["step"]) * scene["segments"] / scene["length"] * 1e-14 * size
    return np.array([FORCE_ROUNDING * force + 10.0 * stretch, ROUNDING * size])


def moved(result, matrix, order=1, force=1.0, length=1.0):
    """Forces and positions of a run after a turn, a reversal (order -1), a change of units; a refusal as it is."""
    return result and ((result[0][::order] @ matrix.T) * force, (result[1][::order] @ matrix.T) * length)


def in_other_units(a, b, c):
    """Function that flies a scene in units of length, time and mass that are a, b, c times smaller, and gives SI units."""
    return lambda scene: moved(fly(in_units(scene, a, b, c)), SAME, force=b**2 / (a * c), length=1.0 / a)


@RUNS
@given(scenes(), st.floats(-np.pi, np.pi), st.booleans())
@pytest.mark.parametrize("variant", [TetherDynamic, TetherQuasiSteady])
def test_turn_and_mirror(variant, scene, angle, mirrored):
    c, s = np.cos(angle), np.sin(angle)
    scene = scene | {"variant": variant, "damping": scene["damping"] + 1.0}  # without any, turned rounding grows from noise
    matrix = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ np.diag([1.0, -1.0 if mirrored else 1.0, 1.0])
    assert_same(fly, lambda each: moved(fly(each, matrix), matrix.T), scene)


@RUNS
@given(scenes(), vectors(3.0))
def test_any_turn_without_gravity(scene, axis):
    matrix = Rotation.from_rotvec(axis).as_matrix()
    scene = scene | {"gravity": 0.0, "damping": scene["damping"] + 1.0}
    assert_same(fly, lambda each: moved(fly(each, matrix), matrix.T), scene)


@RUNS
@given(scenes())
def test_reversed_ends(scene):
    """Without reeling: rope comes from the winch, at one end."""
    assert_same(fly, lambda each: moved(fly(each, reverse=True), SAME, order=-1), scene | {"reel": 0.0})


@RUNS
@given(scenes(), st.integers(-1, 1), st.integers(-2, 2), st.integers(-2, 2))
def test_units(scene, length, time, mass):
    assert_same(fly, in_other_units(2.0**length, 2.0**time, 2.0**mass), scene)


@RUNS
@given(scenes(), st.sampled_from([0.25, 0.5, 2.0, 4.0]))
def test_units_that_change_no_digit(scene, factor):
    """Speeds, forces and EA keep their numbers: where no guard knows a unit, not even chaos makes a difference."""
    expected, found = fly(scene), in_other_units(factor, factor, factor)(scene)
    assume(expected or found)
    np.testing.assert_allclose(found[0], expected[0], rtol=0, atol=DENORMAL)
    np.testing.assert_allclose(found[1], expected[1], rtol=0, atol=DENORMAL)


@RUNS
@given(scenes(), st.sampled_from([2, 3, 5]))
def test_split_steps(scene, split):
    """A step may be refused for its number of internal steps, of which its parts have so many each."""
    assert_same(fly, lambda each: fly(each, split=split), scene | {"tolerance": 1e-8}, same_refusals=False)
