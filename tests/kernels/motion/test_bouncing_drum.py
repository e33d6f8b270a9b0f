"""A drum on one segment between driven ends goes slack and snaps taut many times, as accurately as the tolerance promises.

No node moves freely, so all that the transition can get wrong is the drum:

    m du/dt = T - W - c u,   dL/dt = u,   k = EA/L taut, r EA/L slack
    T + T^2/(2 EA) (T alone below 0) = k (l^2 - L^2)/(2 L) + D/L (dl/dt - u l/L) l/L

Reference: scipy's DOP853 at 1e-11, from one transition to the next, on the equations above.
"""

from typing import NamedTuple

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from networks import rope_tension
from tetherfmu import Line, Point, Solver, Tether, TetherDynamic, TetherSystem, Winch

TIMES = 0.02 * np.arange(251)  # of communication [s]
# A step may err by the tolerance times the length, which is `tolerance` times EA in the tension. Observed is 0.007
# to 0.024 of it; with transitions that nothing judges it is 16 to 37 times that much at 1e-4, 1000 to 5000 times at 1e-6.
ALLOWED = 0.1


class Scene(NamedTuple):
    """Start of the kite x [m] and its constant velocity [m/s], the tether and its drum, W [N], how often it goes over."""

    kite: tuple
    velocity: tuple
    tether: Tether
    drum: Winch
    force: float
    transitions: int


SCENES = {
    "undamped": Scene(
        (60.0, 0.0, 80.0),
        (0.0, 0.0, 0.0),
        Tether(segments=1, initial_length=101.0, density=1e-3, axial_damping=0.0, slack_stiffness_ratio=0.0),
        Winch(winch_control="force", winch_mass=10.0),
        300.0,
        16,
    ),
    "damped, with a kite that flies": Scene(
        (60.0, 0.0, 80.0),
        (0.9, 0.5, -0.4),
        Tether(segments=1, initial_length=99.3, density=1e-3),
        Winch(winch_control="force", winch_mass=2.0, winch_damping=3.0),
        100.0,
        20,
    ),
}


def exact(scene):
    """Tension [N] and length [m] at `TIMES`, two arrays, and the number of transitions."""
    tether, drum = scene.tether, scene.drum

    def kite(time):
        x, v = np.add(scene.kite, np.multiply(time, scene.velocity)), np.array(scene.velocity)
        distance = np.sqrt(x @ x)
        return distance, x @ v / distance

    def tension(time, length, speed, is_taut):
        distance, rate = kite(time)
        stiffness = tether.axial_stiffness / length * (1.0 if is_taut else tether.slack_stiffness_ratio)
        damper = tether.axial_damping / length * (rate - speed * distance / length)
        along = stiffness * (distance**2 - length**2) / (2.0 * length) + damper * distance / length
        return rope_tension(tether.axial_stiffness, along)

    def slope(time, state, is_taut):
        pull = tension(time, *state, is_taut)
        return state[1], (pull - scene.force - drum.winch_damping * state[1]) / drum.winch_mass

    def stretch(time, state, is_taut):
        return kite(time)[0] - state[0]

    stretch.terminal = True
    time, state, rows, transitions = 0.0, np.array([tether.initial_length, 0.0]), [], -1
    is_taut = stretch(time, state, None) > 0.0
    while len(rows) < len(TIMES):
        stretch.direction = -1.0 if is_taut else 1.0
        options = {"rtol": 1e-11, "atol": 1e-12, "events": stretch, "args": (is_taut,), "t_eval": TIMES[len(rows) :]}
        part = solve_ivp(slope, (time, TIMES[-1]), state, "DOP853", **options)
        rows += [(tension(t, *y, is_taut), y[0]) for t, y in zip(part.t, part.y.T, strict=True)]
        if part.status == 1:
            time, state = part.t_events[0][0], part.y_events[0][0]
        is_taut, transitions = not is_taut, transitions + 1
    return np.array(rows).T, transitions


def single(scene, tolerance):
    """Rows (tension, length) of a TetherDynamic at `TIMES`, and its counters."""
    solver = Solver(relative_tolerance=tolerance, initial_shape="static_equilibrium")  # so no end turns in the first step
    tether = TetherDynamic(scene.tether, solver=solver, winch=scene.drum)
    rows = [tether.initialize(scene.kite, scene.velocity, winch_force=scene.force)]
    for time in TIMES[:-1]:
        x = np.add(scene.kite, np.multiply(time, scene.velocity))
        rows.append(tether.step(0.02, x, scene.velocity, winch_force=scene.force))
    return [(row.ground_tension, row.tether_length) for row in rows], tether.counters


def system(scene, tolerance):
    """As `single`, of a system of one line."""
    points = [Point("ground", (0.0, 0.0, 0.0)), Point("kite", scene.kite, scene.velocity)]
    lines, told = [Line("line", "ground", "kite", scene.tether, 0.0, scene.drum)], {"winch_forces": {"line": scene.force}}
    tethers = TetherSystem(points, lines, solver=Solver(relative_tolerance=tolerance, initial_shape="static_equilibrium"))
    rows = [tethers.initialize(**told)]
    for time in TIMES[:-1]:
        x = np.add(scene.kite, np.multiply(time, scene.velocity))
        rows.append(tethers.step(0.02, {"kite": x}, {"kite": scene.velocity}, **told))
    lines = [row.lines["line"] for row in rows]
    return [(line.ground_tension, line.tether_length) for line in lines], tethers.counters


@pytest.mark.parametrize("name", SCENES)
def test_accurate_at_every_tolerance(name):
    scene = SCENES[name]
    wanted, transitions = exact(scene)
    assert transitions == scene.transitions
    for tolerance, flown in ((1e-4, single), (1e-6, single), (1e-6, system)):
        rows, work = flown(scene, tolerance)
        wrong = np.abs(np.transpose(rows) - wanted).max(axis=1)
        assert wrong[0] < ALLOWED * tolerance * scene.tether.axial_stiffness
        assert wrong[1] < ALLOWED * tolerance * scene.tether.initial_length
        assert work["rejections"] < 4 * transitions
        assert work["steps"] < len(TIMES) + 50 * transitions
