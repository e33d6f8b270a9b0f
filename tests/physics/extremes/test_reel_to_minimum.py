"""Reeling in to the shortest tether there is, 1 cm per segment, and out again: the motion ends where it began.

A kite hovers near the winch. The winch shortens the tether to n * 0.01 m, then pays it out again. What was a loop is a
loop again: the static equilibrium of the first length. Momentum of what is pulled in at the speed u needs the force mu
u^2, so the tension stays at some newtons, with a spring of EA/l0 = 6e7 N/m. Shorter is refused (`test_guards.py`).

Thick drag brings the tether to rest within seconds. Energy: trapezoidal rule over communication steps, order 2.
"""

import numpy as np
import pytest

from audited import run
from mechanics import line_density
from solvers import MODELS
from tetherfmu import Solver, Tether, TetherDynamic, TetherQuasiSteady


def session(variant, n, length, speed, step):
    """A model, its kite, its shortest length, and inputs over time: in within `count` steps, out for as long, rest.

    The length follows a cosine of mean speed `speed` [m/s]; each step is given its mean speed, which is held.
    """
    held = Solver(input_continuation="held")
    model = variant(Tether(segments=n, initial_length=length, drag_coefficient=30.0), solver=held)
    shortest = 0.01 * (n if variant in (TetherDynamic, TetherQuasiSteady) else 1)
    count = round((length - shortest) / speed / step)
    kite = np.array([0.6, 0.0, 0.7]) * shortest

    def unstretched(k):
        return shortest * (1.0 + 1e-9) + (length - shortest) * np.cos(0.5 * np.pi * min(k, 2 * count) / count) ** 2

    def inputs(time):
        k = round(time / step)
        return {"kite_position": kite, "reel_out_speed": (unstretched(k + 1) - unstretched(k)) / step}

    model.initialize(kite)
    return model, kite, shortest, inputs, count


def in_and_out(n, length, speed, step):
    """A dynamic tether after its session and 10 s of rest, its start, the `Run` of the session."""
    model, kite, shortest, inputs, count = session(TetherDynamic, n, length, speed, step)
    start = model.outputs()
    result = run(model, inputs, step, 2 * count)
    assert result.outputs[count - 1].tether_length == pytest.approx(shortest, rel=1e-8)
    for _ in range(500):
        model.step(0.02, kite, reel_out_speed=0.0)
    return model, start, result


@pytest.mark.parametrize(("n", "length", "speed"), [(5, 5.0, 1.0), (20, 40.0, 10.0)])
def test_dynamic_in_and_out(n, length, speed):
    model, start, result = in_and_out(n, length, speed, 0.004)
    # the ends are some millimetres apart, so the loop may turn about the vertical: compare heights, of 20 m at most
    np.testing.assert_allclose(model.outputs().shape[:, 2], start.shape[:, 2], rtol=0, atol=2e-3 * length)
    # half of the tether hangs on either end, and that at the winch gains speed with it; a loop that is pulled in whips, the
    # faster the shorter it is: 2.2 times as fast as the winch, seen here
    mu, gained = line_density(Tether()), 0.5 * np.pi**2 * speed**2 / length
    largest = max(out.max_tension for out in result.outputs)
    assert largest < 0.5 * mu * length * (9.81 + gained) + mu * (3.0 * 0.5 * np.pi * speed) ** 2


def test_no_energy_is_left_over():
    left = []
    for step in (0.004, 0.001):
        model, _, _, inputs, count = session(TetherDynamic, 5, 5.0, 1.0, step)
        result = run(model, inputs, step, 2 * count)
        left.append(result.residual[-1] / result.turnover)
    # held reeling speeds jump between steps and the damper, 5e4 N s/m, with them, for microseconds: the trapezoidal rule
    # makes half a step of it. It comes in with the one sign and goes out with the other, so 16 is not reached
    assert left[0] / left[1] > 6.0
    assert abs(left[1]) < 0.1


@pytest.mark.parametrize("variant", MODELS[1:])
def test_others_in_and_out(variant):
    model, _, shortest, inputs, count = session(variant, 5, 5.0, 1.0, 0.02)
    start = model.outputs()
    for k in range(2 * count):
        out = model.step(0.02, **inputs(0.02 * k))
        if k + 1 == count:
            assert out.tether_length == pytest.approx(shortest, rel=1e-8)
    # no memory: rounding of the length, and the tolerance of the equilibrium
    np.testing.assert_allclose(out.shape, start.shape, rtol=0, atol=1e-6)
    np.testing.assert_allclose(out.kite_force, start.kite_force, rtol=0, atol=1e-6)
