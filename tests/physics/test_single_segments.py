"""Single segments between driven ends whose rope runs, while they go slack and taut: no node moves, all is in the rope.

energy    two springs without damping, of which only taut ones pull, and a sheave of 2 kg keep their energy
one line  on a drum that holds no other is the line with its own winch: the error of each step is that at the transition, too
"""

import numpy as np
import pytest

from tetherfmu import Environment, Line, Point, SharedWinch, Solver, Tether, TetherSystem, Winch

pytestmark = pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")  # random lines, and a winch that races
UNDAMPED = {"segments": 1, "axial_damping": 0.0, "drag_coefficient": 0.0}


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_energy(tolerance):
    """Within 1 % of that at the start, and never more, in 80 swings of the rope; its own mass has the rest."""
    light = {"mass_per_length": 1e-3, "slack_stiffness_ratio": 0.0, "slack_damping_ratio": 0.0}
    rope = Tether(initial_length=20.0, diameter=0.005, axial_stiffness=1e5, **UNDAMPED, **light)
    points = [Point(name, (x, 0.0, 0.0)) for name, x in (("a", -10.0), ("s", 0.0), ("b", 10.0))]
    line = Line("rope", "a", "b", rope, through=["s"], initial_portions=[9.9, 10.1], sheave_mass=2.0)
    system = TetherSystem(points, [line], Environment(gravity=0.0), Solver(relative_tolerance=tolerance))
    system.initialize()
    start, energies, payouts = system.energy().total, [], []
    for _ in range(200):
        payouts.append(system.step(0.02).portions["rope"].payout[0])
        energies.append(system.energy().total)
    assert start == pytest.approx(0.5 * 1e5 * 0.1**2 / 9.9, rel=1e-9)
    assert start * 0.99 < min(energies) < max(energies) <= start * (1.0 + 1e-9)
    assert np.ptp(payouts) == pytest.approx(0.2, rel=1e-3)


@pytest.mark.parametrize(("force", "friction"), [(0.0, 0.0), (10.0, 0.0), (0.0, 1.0)])
def test_one_line_of_a_drum(force, friction):
    """Length after a second of snaps within 2 mm of several metres; the drum has no mass."""
    rope = Tether(initial_length=31.5, diameter=0.0048, axial_stiffness=8e5, **UNDAMPED)
    points = [Point("a", (-8.9, -3.9, 13.8)), Point("b", (10.3, 8.9, 35.9))]
    lengths = []
    for is_shared in (False, True):
        own = Winch() if is_shared else Winch(winch_control="force", winch_friction=friction)
        drums = [SharedWinch("drum", {"line": 1.0}, "force", winch_friction=friction)] if is_shared else []
        system = TetherSystem(points, [Line("line", "a", "b", rope, winch=own)], winches=drums)
        system.initialize(winch_forces={"drum" if is_shared else "line": force})
        for _ in range(10):
            outputs = system.step(0.1)
        lengths.append(outputs.lines["line"].tether_length)
    assert lengths[0] > 35.0
    assert lengths[1] == pytest.approx(lengths[0], abs=2e-3)
