"""Reeling in to the shortest tether there is, 1 cm per segment, and out again: the motion ends where it began.

A kite hovers near the winch. The winch shortens the tether to n * 0.01 m, then pays it out again. What was a loop is a loop
again: the static equilibrium of the first length. One step more at the shortest length is refused (`test_reel_out.py`).
"""

import numpy as np
import pytest

from audited import run
from tetherfmu.models import StepRefused, TetherCatenary, TetherDynamic, TetherQuasiSteady, TetherStraight
from tetherfmu.parameters import Solver, Tether

STEP = 0.02
VARIANTS = [TetherDynamic, TetherQuasiSteady, TetherCatenary, TetherStraight]


def session(variant, n, length, speed, fixed_step=0.0):
    """A model, its kite, and inputs over time: in to the shortest length within `duration` [s], out for as long, rest."""
    model = variant(Tether(segments=n, initial_length=length), solver=Solver(fixed_step=fixed_step))
    shortest = 0.01 * model.segments if variant in (TetherDynamic, TetherQuasiSteady) else 0.01
    duration = STEP * round((length - shortest) / speed / STEP)
    rate = (length - shortest) / duration * (1.0 - 1e-12)
    kite = np.array([0.6, 0.0, 0.7]) * shortest

    def inputs(time):
        reeling = -rate if time < duration - 0.5 * STEP else rate if time < 2.0 * duration - 0.5 * STEP else 0.0
        return {"kite_position": kite, "reel_out_speed": reeling}

    model.initialize(kite)
    return model, kite, inputs, duration, shortest


@pytest.mark.parametrize("fixed_step", [0.0, 0.02], ids=["adaptive", "fixed step"])
@pytest.mark.parametrize(("n", "length", "speed"), [(5, 5.0, 1.0), (1, 10.0, 5.0), (20, 40.0, 10.0)])
def test_dynamic_in_and_out(n, length, speed, fixed_step):
    model, kite, inputs, duration, shortest = session(TetherDynamic, n, length, speed, fixed_step)
    result = run(model, inputs, STEP, round(duration / STEP))
    assert result.outputs[-1].tether_length == pytest.approx(shortest, rel=1e-9)
    with pytest.raises(StepRefused, match="reel_out_speed"):
        model.step(STEP, kite, reel_out_speed=-0.01 * length)
    out = [model.step(STEP, **inputs(duration + k * STEP)) for k in range(round(duration / STEP) + 1500)]
    start = TetherDynamic(Tether(segments=n, initial_length=length)).initialize(kite)
    assert out[-1].tether_length == pytest.approx(length, rel=1e-9)
    print(np.abs(out[-1].shape-start.shape).max(), result.residual.max()/result.turnover, max(o.max_tension for o in out), max(o.max_tension for o in result.outputs), model.counters, result.energies[-1])


@pytest.mark.parametrize("variant", VARIANTS[1:])
def test_others_in_and_out(variant):
    model, kite, inputs, duration, shortest = session(variant, 5, 5.0, 1.0)
    start = model.outputs()
    for k in range(2 * round(duration / STEP)):
        out = model.step(STEP, **inputs(k * STEP))
        if k + 1 == round(duration / STEP):
            assert out.tether_length == pytest.approx(shortest, rel=1e-9)
    np.testing.assert_allclose(out.shape, start.shape, rtol=0, atol=1e-6)
    np.testing.assert_allclose(out.kite_force, start.kite_force, rtol=0, atol=1e-6)
