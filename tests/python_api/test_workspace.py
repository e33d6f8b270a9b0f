"""A step depends on nothing but the state, the inputs and the parameters: not on what is left in the workspace.

So a state goes on bit for bit in another instance, and after a step in which numbers overflowed.
"""

import numpy as np
import pytest

from over_sheaves import Atwood, rope
from solvers import ADAPTIVE, fixed
from tetherfmu import Line, Point, SharedWinch, Tether, TetherDynamic, TetherSystem

pytestmark = pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")
SOLVERS = [ADAPTIVE, fixed(0.01, "second_order"), fixed(0.01, "backward_euler")]


def whipped(solver):
    """A tether in wind, of which the kite end is driven aside."""
    model = TetherDynamic(Tether(segments=5), solver=solver)
    model.initialize(wind_velocity=(8.0, 1.0, 0.0))
    return model, {"kite_velocity": (1.0, 2.0, 0.0), "reel_out_speed": 0.5}


def atwood(solver):
    return Atwood(5.0).system(solver), {}


def broken(solver):
    """A drum that holds two loads; the line of one breaks, and the other one slows it down and turns it round."""
    points = [Point("top", (0.0, 0.0, 0.0)), Point("a", (0.0, 0.0, -10.0), mass=20.0)]
    points.append(Point("b", (2.0, 0.0, -10.0), mass=60.0))
    lines = [Line("to_a", "top", "a", rope(10.0, 3)), Line("to_b", "top", "b", rope(10.2, 3, breaking_force=300.0))]
    drum = SharedWinch("drum", {"to_b": 1.0, "to_a": -1.0}, "force", winch_mass=5.0, winch_friction=40.0)
    system = TetherSystem(points, lines, solver=solver, winches=[drum])
    system.initialize()
    return system, {}


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("scene", [whipped, atwood, broken])
def test_what_is_left_in_the_workspace_has_no_effect(scene, solver):
    system, given = scene(solver)
    for _ in range(40):
        before, found = system.get_state(), []
        for left in (0.0, 7.0, np.nan):
            system.set_state(before)
            np.frombuffer(system._instance.work)[:] = left
            system.step(0.02, **given)
            found.append(system.get_state())
        assert np.array_equal(found[0], found[1])
        assert np.array_equal(found[0], found[2])
    if scene is broken:
        assert system.outputs().lines["to_b"].broken
