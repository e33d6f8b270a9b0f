"""Lines over sheaves, and lines that drums turn by force, that let go at their last ends, with adaptive and fixed steps.

run off    a rope with a mass m at one end and none at the other: (m + mu L + J/r2) a = (mu (L2 - L1) - m) g, so that the
           payout grows as a hyperbolic cosine; T = mu l (g - a) beside the bare end at the sheave, m2 falls with g
held       a rope that friction holds at its sheave is two lines, of which the second one lets go, bit for bit
one line   on a drum that holds no other is the line with its own winch
stop       the bare end stops at the last sheave as a knot in it would

Energy: `test_sheaves.py`.
"""

import numpy as np
import pytest

from of_systems import assert_continues
from over_sheaves import LIGHT, Atwood, G, driven, rope
from shared_winches import own_or_shared
from solvers import ADAPTIVE, METHODS, fixed, with_each_solver
from tetherfmu import Line, Point, Solver, StepRefused, TetherSystem, Winch

SECOND, EULER = (fixed(0.002, method) for method in METHODS)
DRUM = Winch(winch_control="force", winch_mass=10.0, winch_damping=20.0)
pytestmark = pytest.mark.filterwarnings("ignore:.*backward Euler", "ignore:.*the tension at a sheave")


@pytest.mark.parametrize(("solver", "within"), [(ADAPTIVE, 1e-4), (SECOND, 1e-4), (EULER, 1e-2)])
@pytest.mark.parametrize("sheave_mass", [0.0, 5.0])
def test_a_rope_runs_off(sheave_mass, solver, within):
    """Payout in m; what is left is the stretch by the lost mass, 0.2 mm at the end of the rope, and of Euler its order."""
    scene = Atwood(sheave_mass, 20.0, 20.0)
    system = scene.system(solver)
    scene.right = 0.0
    low = system.outputs().points["b"].position[2]
    for k in range(50):
        outputs, time = system.step(0.02, releases={"rope": True}), 0.02 * (k + 1)
        assert outputs.portions["rope"].payout[0] == pytest.approx(scene.payout(time), abs=within)
    found, lost = outputs.portions["rope"], outputs.points["b"]
    assert abs(found.payout[0]) > 2.0
    behind, ahead, _ = scene.tensions(1.0)
    if solver is not EULER:
        assert (found.tension_to[0], found.tension_from[1]) == pytest.approx((behind, ahead), abs=0.02)
        assert lost.position[2] == pytest.approx(low - 0.5 * G, abs=1e-6)
    assert lost.velocity[2] == pytest.approx(-G, abs=1e-6)
    assert found.tension_to[1] == outputs.lines["rope"].kite_tension == 0.0
    assert outputs.lines["rope"].broken
    assert outputs.lines["rope"].break_time == 0.0


def hung(through, solver):
    """Nodes and forces of a rope from a winch over a sheave to an end below, which it lets go at 0.2 s; on one line or two.

    The tail carries more than the tension at its end, so that it stays taut.
    """
    points = [Point("a", (-7.0, 0.0, 0.0)), Point("s", (0.0, 0.0, 0.0)), Point("b", (0.0, 0.0, -10.0012))]
    of_rope = {**LIGHT, "axial_damping": 300.0, "drag": 1.0}
    if through:
        sheave = {"through": ["s"], "initial_portions": [7.0, 10.0], "sheave_friction": 5.0}
        lines = [Line("one", "a", "b", rope(17.0, **of_rope), **sheave)]
    else:
        lines = [Line("one", "a", "s", rope(7.0, **of_rope)), Line("two", "s", "b", rope(10.0, **of_rope))]
    system = TetherSystem(points, lines, solver=solver)
    system.initialize()
    found = []
    for k in range(50):
        moved = {"positions": {"b": (0.002 * k, 0.0, -10.0012)}, "velocities": {"b": (0.1, 0.0, 0.0)}}
        given = {"reel_out_speeds": {"one": 0.1 * np.sin(0.05 * k)}, "releases": {lines[-1].name: k >= 10}}
        outputs = system.step(0.02, **moved, **given)
        nodes = list(system.positions.values())
        nodes = nodes[0] if through else np.vstack([nodes[0], nodes[1][1:]])
        found.append(np.concatenate([nodes.ravel(), *(outputs.points[name].force for name in "asb")]))
    assert outputs.lines[lines[-1].name].broken
    return np.array(found)


@with_each_solver(0.002)
def test_a_rope_that_is_held_is_two_lines(solver):
    one, two = hung(True, solver), hung(False, solver)
    assert np.array_equal(one, two)
    assert np.all(one[12:, -3:] == 0.0)  # nothing pulls at the last point


@pytest.mark.parametrize(("solver", "within"), [(Solver(relative_tolerance=1e-6), 1e-8), (SECOND, 1e-4), (EULER, 1e-8)])
def test_a_line_of_a_drum_by_force(solver, within):
    """The drum reels in what is left; as the line with a winch of its own but for steps that backward Euler takes over."""
    found = [own_or_shared(is_shared, 20.0, solver, lets_go=True) for is_shared in (False, True)]
    assert found[0][20, 0] - found[0][-1, 0] > 1.5
    assert found[0] == pytest.approx(found[1], abs=within)


def test_releases_that_are_no_numbers():
    """They are refused as such, also where nothing could be let go of."""
    points = [Point("a", (0.0, 0.0, 0.0)), Point("s", (1.0, 0.0, 0.0)), Point("b", (3.0, 0.0, -4.0), mass=0.0)]
    system = TetherSystem(points, [Line("rope", "a", "b", rope(5.05, 4), through=["s"], initial_portions=[1.0, 4.05])])
    system.initialize()
    for value, said in (
        (np.nan, "rope.release is nan"),
        (np.inf, "rope.release is inf"),
        (True, "released end has no mass"),
    ):
        before = system.get_state()
        with pytest.raises(StepRefused, match=said):
            system.step(0.02, releases={"rope": value})
        assert np.array_equal(system.get_state(), before)


@with_each_solver(0.002)
def test_states_and_flights_over_the_event(solver):
    outputs = assert_continues(driven(2.0, solver, DRUM), lambda k: {"releases": {"rope": k >= 8}}, 5, 20)
    assert not outputs[7].lines["rope"].broken
    assert outputs[-1].lines["rope"].broken
