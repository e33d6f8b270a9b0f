"""Steps from 1 ns to 1 s in any order: what is known by positions only moves as its input does, also within a step.

Constant speed has to be exact, so a motion that stops comes too far once, by what its last rate explains: no rule that sees
the past alone can avoid both. All else is strict: with `input_continuation = held`, and where an input jumps and rests, the
motion stays within its range and never turns back.
"""

from types import SimpleNamespace

import numpy as np
import pytest

from kernels.packed import packed
from tetherfmu import Solver, Tether, TetherDynamic, TetherQuasiSteady
from tetherfmu.kernels.equations import boundary, end_motion, winch
from tetherfmu.kernels.step import transaction
from tetherfmu.runtime import layout as at

START, ROUNDING = 505.0, 1e-9  # [m]; of 505 m, times the number of pieces of a motion
FOLLOWED = {"length": at.WINCH_LENGTH, "kite": at.KITE_POSITION, "ground": at.GROUND_POSITION}
LINEAR, HELD = 1, 2
every_input = pytest.mark.parametrize("what", FOLLOWED)


def motion(what, inputs, steps, continuation=LINEAR, parts=16):
    """Where a winch by length or an end is, which follow these inputs [m]: at the end of each step, and within all [m]."""
    solver = Solver(input_continuation=continuation, end_velocities="derived")
    parameters = packed(Tether(segments=1, initial_length=START), solver=solver)
    parameters[at.WINCH_CONTROL] = at.WINCH_BY_LENGTH
    values, state = np.zeros(at.INPUTS), np.zeros(at.state_size(1))
    values[at.WINCH_LENGTH], values[at.KITE_POSITION], place = START, START, FOLLOWED[what]
    values[place] = START
    transaction.start(1, parameters, values, state)
    ends, within = [], []
    for value, step in zip(inputs, steps, strict=True):
        values[place] = value
        nodes = state[at.STATE_HEADER : at.STATE_HEADER + 12].copy()
        status, given = transaction.begin(1, parameters, values, step, True, state)
        assert status == 0
        conditions = boundary.conditions_of_chain(
            1, parameters, float(at.STATIC_EQUILIBRIUM), given, state, nodes[:6], nodes[6:]
        )
        until = min(step, given.corrections[list(FOLLOWED).index(what) - 3])
        times = np.union1d(np.linspace(0.0, step, parts), np.linspace(0.0, until, parts))
        if what == "length":
            within += [winch.length_at(given.reeling, time) for time in times]
        else:
            within += [end_motion.position_at(getattr(conditions, what), time)[0] for time in times]
        boundary.place_ends(conditions, step, nodes[:6], nodes[6:])
        state[at.STATE_HEADER : at.STATE_HEADER + 12] = nodes
        ends.append(within[-1])
    return SimpleNamespace(ends=np.array(ends), within=np.array(within))


def random_steps(random, count):
    """Of all sizes between 1 ns and 1 s, or between 1 ms and 1 s [s]."""
    return 10.0 ** random.uniform(random.choice([-9.0, -3.0]), 0.0, count)


@every_input
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_held_inputs_that_only_rise_or_only_fall_give_a_motion_that_does(what, sign):
    random = np.random.default_rng(5)
    for _ in range(60):
        steps = random_steps(random, 30)
        inputs = START + sign * np.cumsum(random.exponential(0.3, 30) * random.integers(0, 2, 30))
        found = sign * (motion(what, inputs, steps, HELD).within - START)
        assert np.all(np.diff(found) >= -ROUNDING)
        assert found[-1] <= sign * (inputs[-1] - START) + ROUNDING


@every_input
def test_a_jump_among_steps_of_any_size_is_no_way_beyond_it(what):
    random = np.random.default_rng(6)
    for at_step in range(30):
        for _ in range(4):
            steps, inputs = random_steps(random, 30), np.full(30, START)
            inputs[at_step:] -= 0.2
            found = motion(what, inputs, steps).within
            assert np.all(np.diff(found) <= ROUNDING)
            assert found[-1] >= START - 0.2 - ROUNDING


@every_input
def test_stairs_that_rest_for_five_of_the_longest_steps(what):
    random = np.random.default_rng(7)
    for _ in range(40):
        steps = random_steps(random, 60)
        time, last, inputs = np.cumsum(steps), 0.0, []
        value = START
        for now in time:
            if now - last > 5.0 * steps.max() and random.integers(0, 2):
                value, last = value + random.exponential(0.3), now
            inputs.append(value)
        found = motion(what, inputs, steps).within
        assert np.all(np.diff(found) >= -ROUNDING)
        assert found[-1] <= inputs[-1] + ROUNDING


@every_input
def test_no_further_beyond_an_input_than_its_own_way_explains(what):
    """Rates u, u/2, 0 over periods of 3/4 H: at most H (u/2 + 39/32 u) beyond a way of 9/8 H u, 1.53 times that way."""
    random = np.random.default_rng(8)
    for k in range(120):
        steps = random_steps(random, 40)
        ways = random.exponential(0.3, 40) * random.integers(0, 2, 40) if k % 2 else steps * random.exponential(1.0, 40)
        ways[25:] = 0.0
        inputs = START + np.cumsum(ways)
        found = motion(what, inputs, steps)
        assert np.all(found.ends - inputs <= 1.53 * (inputs - START) + ROUNDING)
        assert found.within.min() >= START - ROUNDING


@every_input
def test_a_motion_that_stops_comes_to_rest_where_its_input_is(what):
    random = np.random.default_rng(9)
    for _ in range(40):
        steps = np.concatenate((random_steps(random, 30), np.full(12, 1.0)))
        inputs = START + 0.5 * np.minimum(np.cumsum(steps), np.sum(steps[:30]))
        assert motion(what, inputs, steps).ends[-1] == pytest.approx(inputs[-1], abs=ROUNDING)


MS = 1e-3
EVENT = [*[20 * MS] * 6, *[MS] * 3, *[20 * MS] * 2]
CASES = {
    "three short steps": (EVENT, [START] * 7 + [504.8] * 4),
    "the second step": ([20 * MS] * 4, [START] + [504.8] * 3),
    "after a first step of 1 ms": ([MS, 20 * MS, 20 * MS], [START, 504.8, 504.8]),
    "steps of any size": ([0.2, 1e-9, 1e-6, 0.02, 0.2, 0.2], [START, 504.94, 504.88, 504.82, 504.82, 504.82]),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("model", [TetherDynamic, TetherQuasiSteady])
def test_a_winch_that_follows_its_length(model, case):
    """Within its range; the tension is at most that of `held`, which goes straight to the value (985 N, see the issue)."""
    peaks = []
    for continuation in (LINEAR, HELD):
        tether = model(winch_control="length", initial_length=START, input_continuation=continuation)
        tether.initialize(winch_length=START)
        found = [tether.step(step, winch_length=value) for step, value in zip(*CASES[case], strict=True)]
        lengths = np.array([each.tether_length for each in found])
        assert lengths.min() >= CASES[case][1][-1] - ROUNDING
        assert np.all(np.diff(lengths) <= ROUNDING)
        assert not tether.implausible
        peaks.append(max(each.peak_tension for each in found))
    assert peaks[0] == pytest.approx(peaks[1], rel=0.05)


@pytest.mark.parametrize("model", [TetherDynamic, TetherQuasiSteady])
def test_an_end_whose_velocity_is_derived(model):
    """0.2 m further in the second of three short steps: never beyond; the tension is that of `held`."""
    peaks = []
    for continuation in (LINEAR, HELD):
        tether = model(initial_length=START, end_velocities="derived", input_continuation=continuation)
        tether.initialize(kite_position=(300.0, 0.0, 400.0))
        found = []
        for step, length in zip(*CASES["three short steps"], strict=True):
            found.append(tether.step(step, kite_position=(300.0 + START - length, 0.0, 400.0)).peak_tension)
            assert -ROUNDING <= tether.positions[-1][0] - 300.0 <= 0.2 + ROUNDING
        peaks.append(max(found))
    assert peaks[0] == pytest.approx(peaks[1], rel=0.05)
