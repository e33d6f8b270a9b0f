"""A step depends on nothing but the state, the inputs and the parameters: not on what is left in the workspace.

So a state goes on bit for bit in another instance, and after a step in which numbers overflowed.
"""

from dataclasses import replace

import numpy as np
import pytest

from over_sheaves import Atwood, rope
from solvers import ADAPTIVE, fixed
from tetherfmu import Line, Point, SharedWinch, Tether, TetherDynamic, TetherSystem

pytestmark = pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")  # broken ropes, in steps of all kinds
SOLVERS = [ADAPTIVE, fixed(0.01, "second_order"), fixed(0.01, "backward_euler")]


def whipped(solver):
    """A tether in wind, of which the kite end is driven aside."""
    model = TetherDynamic(Tether(segments=5), solver=solver)
    model.initialize(wind_velocity=(8.0, 1.0, 0.0))
    return model, {"kite_velocity": (1.0, 2.0, 0.0), "reel_out_speed": 0.5}


def atwood(solver):
    return Atwood(5.0).system(solver), {}


def broken(solver):
    """Two drums that hold three loads; the line of one breaks, and the others slow the drums down and turn them round."""
    places = {"b": (2.0, 60.0), "a": (0.0, 20.0), "c": (-2.0, 40.0)}
    points = [Point("top", (0.0, 0.0, 0.0)), *(Point(name, (x, 0.0, -10.0), mass=m) for name, (x, m) in places.items())]
    lines = [Line(f"to_{name}", "top", name, rope(10.2 if name != "a" else 10.0, 3)) for name in places]
    lines[0] = replace(lines[0], tether=replace(lines[0].tether, breaking_force=300.0))
    held = ((2.0, -1.0, -1.0), (0.5, -1.0, 0.5))
    ratios = [{line.name: ratio for line, ratio in zip(lines, each, strict=True)} for each in held]
    drums = [SharedWinch(f"drum{k}", each, "force", winch_mass=5.0, winch_friction=40.0) for k, each in enumerate(ratios)]
    system = TetherSystem(points, lines, solver=solver, winches=drums)
    system.initialize()
    return system, {}


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("scene", [whipped, atwood, broken])
def test_what_is_left_in_the_workspace_has_no_effect(scene, solver):
    system, given = scene(solver)
    for _ in range(60):
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
