"""Claims that hold for any system: a state and a flight continue it bit for bit, and its powers explain its energy."""

import numpy as np
import pytest

from tetherfmu import StepRefused


def assert_continues(system, inputs, first, then, step=0.02):
    """After `first` steps [s] a state continues bit for bit, in `then` steps and as a flight; a refused step leaves it.

    inputs : keyword arguments of step k.  Returns the outputs after each step.
    """
    outputs = [system.step(step, **inputs(k)) for k in range(first)]
    before, rows, ends = system.get_state(), [inputs(k) for k in range(first, first + then)], []
    driven = next(point.name for point in system.points if point.is_driven)
    with pytest.raises(StepRefused, match="nan"):
        system.step(step, **{**rows[0], "positions": {driven: (np.nan, 0.0, 0.0)}})
    assert np.array_equal(system.get_state(), before)
    for _ in range(2):
        system.set_state(before)
        outputs[first:] = [system.step(step, **row) for row in rows]
        ends.append(system.get_state())
    system.set_state(before)
    system.fly(then, step, every=0, **{
        what: {name: np.array([row[what][name] for row in rows]) for name in rows[0][what]} for what in rows[0]
    })  # fmt: skip
    assert np.array_equal(ends[0], ends[1])
    assert np.array_equal(ends[0], system.get_state())
    return outputs


def unexplained(system, step, steps, inputs=lambda time: {}, account=lambda energy: (energy.total, energy.power)):
    """Energy [J] that no power explains in so many steps [s], by the trapezoidal rule, and what was exchanged [J].

    inputs : keyword arguments of a step by its time [s].  account : energy [J] and power [W], or several, of `SystemEnergy`.
    """
    stored, power = map(np.asarray, account(system.energy()))
    first, work = stored, 0.0
    for k in range(steps):
        system.step(step, **inputs(k * step))
        before = power
        stored, power = map(np.asarray, account(system.energy()))
        work += 0.5 * step * (before + power)
    return stored - first - work, np.abs(stored - first)
