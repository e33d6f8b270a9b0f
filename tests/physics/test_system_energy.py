"""The energy account of a system: what lines gain is what ends, loads, winches and wind bring, less what is lost.

Integrated by the trapezoidal rule, whose error falls with the square of the communication step.
"""

import numpy as np
import pytest

from tetherfmu import Environment, Ground, Line, Point, Solver, Tether, TetherSystem, Winch

EXACT = Solver(relative_tolerance=1e-8)
ARM = Tether(segments=3, initial_length=50.2, axial_stiffness=2e4, axial_damping=40.0)
MAIN = Tether(segments=5, initial_length=100.5, axial_stiffness=2e4, axial_damping=40.0)
DRUM = Winch(winch_control="force", winch_mass=20.0, winch_damping=5.0)


def two_kites(winch):
    points = [
        Point("ground", (0.0, 0.0, 0.0)),
        Point("knot", (0.0, 0.0, 100.0), mass=2.0),
        Point("left", (-40.0, 0.0, 130.0)),
        Point("right", (40.0, 0.0, 130.0), mass=3.0),
    ]
    lines = [
        Line("main", "ground", "knot", MAIN, winch=winch),
        Line("a", "knot", "left", ARM),
        Line("b", "knot", "right", ARM),
    ]
    return TetherSystem(points, lines, Environment(), EXACT, Ground())


def residual(step, winch, end=1.0):
    """Energy that comes from nowhere in a flight, over all that is exchanged."""
    system, load = two_kites(winch), (60.0, 10.0, 120.0)
    start = {"positions": {"left": (-40.0, 0.0, 130.0)}, "loads": {"right": load}}
    system.initialize((8.0, 1.0, 0.0), **start, winch_forces={"main": 200.0} if winch is DRUM else None)
    speed, found = np.array((0.5, 3.0, 1.0)), [system.energy()]
    for k in range(round(end / step)):
        place = np.array((-40.0, 0.0, 130.0)) + k * step * speed
        system.step(step, {"left": place}, {"left": speed}, {"right": load})
        found.append(system.energy())
    powers = np.array([each.power for each in found[1:]])  # that of the start belongs to ends at rest
    gained = np.trapezoid(powers, dx=step)
    exchanged = sum(abs(each.lines["main"].total) + abs(sum(each.loads.values())) * end for each in found) / len(found)
    return abs(found[-1].total - found[1].total - gained) / exchanged


@pytest.mark.parametrize("winch", [Winch(), DRUM], ids=["reels at a speed", "has a drum"])
def test_energy_comes_from_what_is_accounted_for(winch):
    coarse, fine = residual(0.004, winch), residual(0.002, winch)
    assert fine < 2e-4
    assert fine < 0.35 * coarse  # a quarter, and what the tolerance leaves
