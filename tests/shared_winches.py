"""Scenes of winches that hold several lines by force, for adaptive and for fixed steps."""

import numpy as np

from over_sheaves import HEAVY, LIGHT
from solvers import ADAPTIVE
from tetherfmu import Line, Point, SharedWinch, Tether, TetherSystem, Winch


def rope(length, segments=6, **of_rope):
    """Rope of a length [m]."""
    return Tether(segments=segments, initial_length=length, **{"drag_coefficient": 0.0, **HEAVY, **of_rope})


def moved(rate, payout, speed, h):
    """Payout [m] and speed [m/s] after a step of the classical Runge-Kutta method; rate : u' of both."""
    k = []
    for part in (0.0, 0.5, 0.5, 1.0):
        p, u = (payout, speed) if not k else (payout + part * h * k[-1][0], speed + part * h * k[-1][1])
        k.append((u, rate(p, u)))
    return tuple(y + h / 6.0 * (a + 2.0 * b + 2.0 * c + d) for y, a, b, c, d in zip((payout, speed), *k, strict=True))


ONE = (rope(10.0, 5),)
SERIES = rope(5.0, 3, **LIGHT), rope(5.0, 2, **{**LIGHT, "mass_per_length": 0.05, "axial_stiffness": 4e4})


def own_or_shared(is_shared, friction, solver, start="top", tethers=ONE, lets_go=False):
    """Lengths [m] of a line and heights [m] of its load, from its own drum or from a shared one that holds it alone."""
    of_drum = {"winch_mass": 20.0, "winch_friction": friction, "winch_damping": 3.0}
    first = Point("top", (0.0, 0.0, 0.0)) if start == "top" else Point("body", (0.0, 0.0, 0.0), mass=60.0)
    winch = Winch() if is_shared else Winch(winch_control="force", **of_drum)
    winches = [SharedWinch("drum", {"line": 1.0}, "force", **of_drum)] if is_shared else []
    lines = [Line("line", start, "load", tethers, winch=winch)]
    system = TetherSystem([first, Point("load", (0.0, 0.0, -10.0004), mass=30.0)], lines, solver=solver, winches=winches)
    system.initialize(loads={} if start == "top" else {"body": (5.0, 0.0, 1000.0)})
    rows = []
    for k in range(60):
        force = 350.0 if lets_go else 300.0 + 150.0 * np.sin(k / 6.0)
        told = {"winch_forces": {"drum" if is_shared else "line": force}, "releases": {"line": lets_go and k >= 20}}
        outputs = system.step(0.02, **told)
        rows.append((outputs.lines["line"].tether_length, outputs.points["load"].position[2]))
    return np.array(rows)


def between(winches=(), solver=ADAPTIVE):
    """A mass that hangs on two lines from two points."""
    points = [Point("a", (-6.0, 0.0, 0.0)), Point("mass", (0.0, 0.0, -6.0), mass=40.0), Point("b", (6.0, 0.0, 0.0))]
    lines = [Line(name, name[-1], "mass", rope(8.47, **{"segments": 4, **LIGHT})) for name in ("from_a", "from_b")]
    system = TetherSystem(points, lines, solver=solver, winches=winches)
    system.initialize()
    return system


STEERING = {"winch_mass": 5.0, "winch_friction": 15.0, "winch_damping": 5.0}
POWER = {"winch_mass": 8.0, "winch_friction": 15.0}


def steered(velocity=(0.0, 0.0, 0.0), pod=None, solver=ADAPTIVE, steering=STEERING, power=POWER, **of_rope):
    """A kite mass on a line, and another line, from a pod where two drums, `steering` and `power`, hold both of them."""
    points = [Point("pod", (0.0, 0.0, 0.0), velocity, pod), Point("kite", (0.0, 0.0, 19.0), velocity, 30.0)]
    points.append(Point("far", (-8.0, 0.0, 22.0), velocity))
    own = {"segments": 5, "drag_coefficient": 0.5, **LIGHT, **of_rope}
    lines = [Line("a", "pod", "kite", rope(18.9, **own)), Line("b", "pod", "far", rope(23.3, **own))]
    winches = [SharedWinch("steering", {"a": 1.0, "b": -1.0}, "force", **steering)]
    winches.append(SharedWinch("power", {"a": 1.0, "b": 0.5}, "force", **power))
    return TetherSystem(points, lines, solver=solver, winches=winches)


def told(k):
    """Inputs of `steered` in step k."""
    return {
        "loads": {"kite": (100.0 * np.sin(k / 7.0), 0.0, 600.0)},
        "winch_forces": {"steering": 20.0 + 80.0 * np.sin(k / 9.0), "power": 300.0 + 100.0 * np.cos(k / 11.0)},
    }


def block_on_falls(solver, friction=0.0, sheave_friction=0.0):
    """A block on two falls and on a line of its own, each from a drum."""
    points = [Point("top", (0.0, 0.0, 0.0)), Point("block", (0.5, 0.0, -10.0), mass=50.0), Point("end", (1.0, 0.0, 0.0))]
    points.append(Point("side", (8.0, 0.0, -4.0)))
    of_rope = {"drag_coefficient": 0.3, **LIGHT, "segments": 4}
    drum = Winch(winch_control="force", winch_mass=10.0, winch_friction=friction)
    fall = {"through": ["block"], "sheave_friction": sheave_friction, "sheave_mass": 1.0}
    lines = [Line("falls", "top", "end", rope(20.1, **of_rope), winch=drum, **fall)]
    lines.append(Line("guy", "side", "block", rope(9.7, **of_rope), winch=drum))
    system = TetherSystem(points, lines, solver=solver)
    system.initialize(winch_forces={"falls": 180.0, "guy": 150.0})
    return system
