"""Lines over sheaves, and lines that drums turn by force, that let go at their last ends, with adaptive and fixed steps.

run off    a rope with a mass m at one end and none at the other: (m + mu L + J/r2) a = (mu (L2 - L1) - m) g, so that the
           payout grows as a hyperbolic cosine; T = mu l (g - a) beside the bare end at the sheave, m2 falls with g
held       a rope that friction holds at its sheave is two lines, of which the second one lets go, bit for bit
one line   on a drum that holds no other is the line with its own winch
stop       the bare end stops at the last sheave as a knot in it would
energy     what the powers do not explain falls with the square of the communication step, over the event, too
"""

import numpy as np
import pytest

from over_sheaves import DENSITY, HEAVY, LIGHT, Atwood, G, rope
from tetherfmu import Line, Point, SharedWinch, Solver, StepRefused, TetherSystem, Winch

ADAPTIVE, SECOND = Solver(), Solver(fixed_step=0.002)
EULER = Solver(fixed_step=0.002, fixed_step_method="backward_euler")
pytestmark = pytest.mark.filterwarnings("ignore:.*backward Euler", "ignore:.*the tension at a sheave")


class RunOff(Atwood):
    """Two equal masses, the second of which is let go at the start."""

    m2 = 20.0

    def __init__(self, sheave_mass):
        super().__init__(sheave_mass)
        self.m2 = 0.0
        whole = self.m1 + 2.0 * DENSITY * self.length + sheave_mass
        self.rate, self.first = np.sqrt(2.0 * DENSITY * G / whole), -self.m1 * G / whole

    def system(self, solver=ADAPTIVE):
        self.m2 = RunOff.m2
        found = super().system(solver)
        self.m2 = 0.0
        return found


@pytest.mark.parametrize(("solver", "within"), [(ADAPTIVE, 1e-4), (SECOND, 1e-4), (EULER, 1e-2)])
@pytest.mark.parametrize("sheave_mass", [0.0, 5.0])
def test_a_rope_runs_off(sheave_mass, solver, within):
    """Payout in m; what is left is the stretch by the lost mass, 0.2 mm at the end of the rope, and of Euler its order."""
    scene = RunOff(sheave_mass)
    system = scene.system(solver)
    low = system.outputs().points["b"].position[2]
    for k in range(50):
        outputs, time = system.step(0.02, releases={"rope": True}), 0.02 * (k + 1)
        assert outputs.portions["rope"].payout[0] == pytest.approx(scene.payout(time), abs=within)
    found, lost = outputs.portions["rope"], outputs.points["b"]
    assert abs(found.payout[0]) > 2.0
    behind, ahead = scene.tensions(1.0)
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


@pytest.mark.parametrize("solver", [ADAPTIVE, SECOND, EULER])
def test_a_rope_that_is_held_is_two_lines(solver):
    one, two = hung(True, solver), hung(False, solver)
    assert np.array_equal(one, two)
    assert np.all(one[12:, -3:] == 0.0)  # nothing pulls at the last point


@pytest.mark.parametrize(("solver", "within"), [(Solver(relative_tolerance=1e-6), 1e-8), (SECOND, 1e-4), (EULER, 1e-8)])
def test_a_line_of_a_drum_by_force(solver, within):
    """The drum reels in what is left; as the line with a winch of its own but for steps that backward Euler takes over."""
    of_drum, found = {"winch_mass": 20.0, "winch_friction": 20.0, "winch_damping": 30.0}, []
    for is_shared in (False, True):
        winch = Winch() if is_shared else Winch(winch_control="force", **of_drum)
        winches = [SharedWinch("drum", {"line": 1.0}, "force", **of_drum)] if is_shared else []
        points = [Point("top", (0.0, 0.0, 0.0)), Point("load", (0.0, 0.0, -10.0004), mass=30.0)]
        line = Line("line", "top", "load", rope(10.0, 5, **HEAVY), winch=winch)
        system = TetherSystem(points, [line], solver=solver, winches=winches)
        system.initialize()
        rows = []
        for k in range(60):
            force, release = {"drum" if is_shared else "line": 350.0}, {"line": k >= 20}
            outputs = system.step(0.02, winch_forces=force, releases=release)
            rows.append((outputs.lines["line"].tether_length, outputs.points["load"].position[2]))
        found.append(np.array(rows))
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


def with_drum(solver=ADAPTIVE):
    """A load on a rope over a driven sheave from a drum that is controlled by force."""
    points = [Point("a", (-6.0, 0.0, 0.0)), Point("s", (0.0, 0.0, 4.0)), Point("b", (2.0, 0.0, -6.0), mass=10.0)]
    of_rope = {"diameter": 0.01, "mass_per_length": 0.3, "axial_stiffness": 2e4, "axial_damping": 200.0, "drag": 1.0}
    drum = Winch(winch_control="force", winch_mass=10.0, winch_damping=20.0)
    sheave = {"initial_portions": [7.5, 12.5], "sheave_mass": 2.0, "winch": drum}
    system = TetherSystem(points, [Line("rope", "a", "b", rope(20.0, 5, **of_rope), through=["s"], **sheave)], solver=solver)
    system.initialize(winch_forces={"rope": 90.0})
    return system


def test_energy():
    """Over the event, and with a driven end that gives its half segment to the rope where it lets go."""
    residuals = []
    for step in (0.01, 0.005):
        system, work = with_drum(Solver(relative_tolerance=1e-7)), 0.0
        before = first = system.energy()
        for k in range(round(1.0 / step)):
            system.step(step, releases={"rope": k * step > 0.295})
            after = system.energy()
            work += 0.5 * step * (before.power + after.power)
            before = after
        residuals.append(after.total - first.total - work)
    assert abs(residuals[1]) < 2e-3 * abs(after.total - first.total)
    assert residuals[0] / residuals[1] == pytest.approx(4.0, rel=0.15)


@pytest.mark.parametrize("solver", [ADAPTIVE, SECOND, EULER])
def test_states_and_flights_over_the_event(solver):
    """Bit for bit: a state of before is restored and goes on; and `fly` is a loop of steps."""
    system = with_drum(solver)
    for _ in range(5):
        system.step(0.02)
    before, ends = system.get_state(), []
    for _ in range(2):
        system.set_state(before)
        for k in range(20):
            system.step(0.02, releases={"rope": k >= 3})
        ends.append(system.get_state())
    system.set_state(before)
    assert not system.outputs().lines["rope"].broken
    system.fly(20, 0.02, releases={"rope": np.arange(20) >= 3})
    ends.append(system.get_state())
    assert np.array_equal(ends[0], ends[1])
    assert np.array_equal(ends[0], ends[2])
