"""Winches of the lines of a system: told a speed, a length or a force.

one line between driven points:   the winch of TetherDynamic
"""

import numpy as np
import pytest

from tetherfmu import Line, Point, Solver, StepRefused, Tether, TetherDynamic, TetherSystem, Winch

STEP = 0.02
WIND = (8.0, 1.0, 0.0)
POINTS = [Point("ground", (0.0, 0.0, 0.0)), Point("kite", (60.0, 0.0, 80.0), (1.0, 2.0, 0.0))]
TETHER = Tether(segments=6, initial_length=100.2)
LENGTH = {"winch_control": "length"}


def started(winch, tether=TETHER, speed=0.3, **solver):
    """The same line as a system and as a TetherDynamic, started."""
    options = Solver(**solver)
    single = TetherDynamic(tether, solver=options, winch=winch)
    system = TetherSystem(POINTS, [Line("line", "ground", "kite", tether, speed, winch)], solver=options)
    motion = {"kite_position": POINTS[1].position, "kite_velocity": POINTS[1].velocity}
    single.initialize(**motion, reel_out_speed=speed, wind_velocity=WIND)
    system.initialize(WIND)
    return system, single


def step_both(system, single, k, **told):
    """Outputs of both after step k; told : input of the winch."""
    x, v = np.add(POINTS[1].position, np.multiply(k * STEP, POINTS[1].velocity)), POINTS[1].velocity
    wanted = single.step(STEP, kite_position=x, kite_velocity=v, **told)
    plural = {f"{name}s": {"line": value} for name, value in told.items()}
    return system.step(STEP, positions={"kite": x}, velocities={"kite": v}, **plural).lines["line"], wanted


def test_a_length_is_followed_as_by_a_single_tether():
    system, single = started(Winch(**LENGTH))
    for k in range(60):
        found, wanted = step_both(system, single, k, winch_length=100.2 + 0.4 * np.sin(k * STEP))
    assert abs(wanted.winch_speed - 0.3) > 0.05
    # the same arithmetic in other arrays; the bar is that of the issue
    np.testing.assert_allclose(system.positions["line"], single.positions, rtol=0, atol=1e-10)
    for name in ("tether_length", "winch_speed", "ground_force", "kite_force"):
        np.testing.assert_allclose(getattr(found, name), getattr(wanted, name), rtol=1e-10)
    assert system.counters == single.counters


def test_what_a_winch_cannot_do_is_refused_by_its_line():
    system, single = started(Winch(**LENGTH))
    step_both(system, single, 0, winch_length=100.2)
    before = system.get_state()
    with pytest.raises(StepRefused, match=r"the line line: .*winch_length"):
        system.step(STEP, winch_lengths={"line": -5.0})
    with pytest.raises(StepRefused, match=r"line\.winch_force is nan"):
        system.step(STEP, winch_forces={"line": np.nan})
    with pytest.raises(ValueError, match="no winch_length of a line with the name 'rope'"):
        system.step(STEP, winch_lengths={"rope": 5.0})
    assert np.array_equal(system.get_state(), before)
