"""Internal steps that a hoist over a sheave takes: a winch whose speed jumps at communication points costs no order.

Steps of order 4 grow by 10^(1/4) a tenth of the tolerance: from 1e-4 to 1e-8 by 10 at most, beside what the communication
steps of 20 ms, 100 of them, ask for. Bounds: 1.1 times the steps of a prototype that solves the same equations otherwise.
"""

import numpy as np
import pytest

from over_sheaves import STIFF, rope
from tetherfmu import Line, Point, Solver, TetherSystem

COUNT, STEP = 100, 0.02
TIMES = STEP * np.arange(COUNT)
SPEEDS = {
    "sine": (-0.3 * np.sin(2.0 * TIMES), {1e-4: 100, 1e-6: 392, 1e-8: 3086}),
    "constant": (np.full(COUNT, -0.25), {1e-4: 142, 1e-6: 319, 1e-8: 733}),
    "ramp": (-0.5 * np.minimum(1.0, TIMES), {1e-4: 100, 1e-6: 247, 1e-8: 643}),
}


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("speed", SPEEDS)
def test_a_hoist_of_two_falls(speed, tolerance):
    points = [Point("winch", (0.0, 0.0, 30.0)), Point("anchor", (1.0, 0.0, 30.0)), Point("block", mass=2000.0)]
    line = Line("hoist", "winch", "anchor", rope(40.0, **STIFF), through=["block"], sheave_mass=3.0)
    system = TetherSystem(points, [line], solver=Solver(relative_tolerance=tolerance))
    system.initialize()
    speeds, steps = SPEEDS[speed]
    before = system.counters["steps"]
    system.fly(COUNT, STEP, reel_out_speeds={"hoist": speeds}, every=0)
    assert system.counters["steps"] - before <= 1.1 * steps[tolerance]
