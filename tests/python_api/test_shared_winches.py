"""Winches that hold several lines: the numbers of lines that are told the same, states, refusals in words."""

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest

from tetherfmu import Line, Point, SharedWinch, StepRefused, Tether, TetherSystem, Winch

STEP = 0.02
TAPE = Tether(segments=3, initial_length=10.0)
POINTS = (Point("pod", (0.0, 0.0, 0.0)), Point("left", (-2.0, 0.0, 10.0)), Point("right", mass=20.0))
RATIOS = {"steering": {"a": 1.0, "b": -1.0}, "depower": {"a": 1.0, "b": 0.5}}


def lines_with(winch=None, **speeds):
    winch = winch or Winch()
    return tuple(
        Line(name, "pod", end, TAPE, winch=winch, reel_out_speed=speeds.get(name, 0.0))
        for name, end in zip("ab", ("left", "right"), strict=True)
    )


def shared(control="speed", **more):
    return TetherSystem(
        POINTS, lines_with(), winches=[SharedWinch(name, held, control, **more) for name, held in RATIOS.items()]
    )


def told(k):
    """What `steering` and `depower` are told before step k."""
    return 0.05 * np.sin(0.3 * k), 0.02 * k * STEP


def same(one, other):
    for name, outputs in one.lines.items():
        assert all(np.array_equal(a, b) for a, b in zip(outputs, other.lines[name], strict=True))


@pytest.mark.parametrize("control", ["speed", "length"])
def test_lines_move_as_with_winches_of_their_own(control):
    """Bit for bit, and the outputs of the winches are what they were told, as lines have followed."""
    system = shared(control)
    alone = TetherSystem(POINTS, lines_with(Winch(winch_control=control)))
    same(system.initialize(), alone.initialize())
    argument, base = ("reel_out_speeds", 0.0) if control == "speed" else ("winch_lengths", TAPE.initial_length)
    for k in range(40):
        s, d = told(k)
        outputs = system.step(STEP, **{argument: {"steering": s, "depower": d}})
        same(outputs, alone.step(STEP, **{argument: {"a": base + s + d, "b": base - s + 0.5 * d}}))
    lengths = np.array([outputs.lines[name].tether_length for name in "ab"]) - TAPE.initial_length
    speeds = np.array([outputs.lines[name].winch_speed for name in "ab"])
    by_winch = np.linalg.inv([[1.0, 1.0], [-1.0, 0.5]])  # lines a and b as the ratios say, solved for the winches
    for j, name in enumerate(RATIOS):
        assert outputs.winches[name].payout == pytest.approx((by_winch @ lengths)[j], abs=1e-12)
        assert outputs.winches[name].winch_speed == pytest.approx((by_winch @ speeds)[j], abs=1e-12)
    assert outputs.winches["depower"].payout != 0.0


def test_what_is_not_told_stays_and_a_flight_is_a_loop():
    """Bit for bit; so do a copy, and a state that is restored."""
    loop, flight = shared(), shared()
    for each in (loop, flight):
        each.initialize(reel_out_speeds={"depower": 0.3})
    speeds = np.array([told(k)[0] for k in range(30)])
    for speed in speeds:
        loop.step(STEP, reel_out_speeds={"steering": speed})
    flown = flight.fly(30, STEP, reel_out_speeds={"steering": speeds})
    copies = [flight, copy.deepcopy(flight), pickle.loads(pickle.dumps(flight))]
    state = flight.get_state()
    last = [loop.step(STEP, reel_out_speeds={"steering": 0.1})]
    last += [each.step(STEP, reel_out_speeds={"steering": 0.1}) for each in copies]
    flight.step(STEP, reel_out_speeds={"depower": -0.2})
    flight.set_state(state)
    last.append(flight.step(STEP, reel_out_speeds={"steering": 0.1}))
    for each in last[1:]:
        same(last[0], each)
    assert flown.winches["depower"].winch_speed[-1] == pytest.approx(0.3, abs=1e-12)
    assert flown.winches["steering"].payout.shape == (30,)


def test_a_refused_step_leaves_what_winches_were_told():
    system, other = shared(), shared()
    for each in (system, other):
        each.initialize(reel_out_speeds={"depower": 0.1})
    with pytest.raises(
        StepRefused, match=r"the line a: the input steering\.reel_out_speed and depower\.reel_out_speed is nan"
    ):
        system.step(STEP, reel_out_speeds={"steering": np.nan})
    same(system.step(STEP), other.step(STEP))


def test_a_start_speed_and_a_winch_of_one_line():
    """A single line with the ratio 1 is a winch of its own, bit for bit; the speed of the record is that of the start."""
    system = TetherSystem(POINTS, lines_with(), winches=[SharedWinch("drum", {"a": 1}, reel_out_speed=0.2)])
    alone = TetherSystem(POINTS, lines_with(a=0.2))
    same(system.initialize(), alone.initialize())
    same(system.step(STEP), alone.step(STEP))
    same(system.step(STEP, reel_out_speeds={"drum": 0.3, "b": 0.1}), alone.step(STEP, reel_out_speeds={"a": 0.3, "b": 0.1}))


WRONG = {
    "an unknown control": (lambda: SharedWinch("drum", {"a": 1}, control="torque"),
        r"drum\.control is 'torque'; it must be 'speed' or 'force' or 'length'"),
    "no lines": (lambda: SharedWinch("drum", {}), r"drum\.lines is \{\}; it must have names of lines"),
    "a ratio of 0": (lambda: SharedWinch("drum", {"a": 0}),
        r"drum\.lines\.a is 0; it must be a number between 0\.001 and 1000"),
    "a ratio that is no number": (lambda: SharedWinch("drum", {"a": "1"}), r"drum\.lines\.a is '1'"),
    "a force without effect": (lambda: SharedWinch("drum", {"a": 1}, "length", winch_force=0.5),
        r"drum\.winch_force is 0\.5 and has no effect: control is 'length'"),
    "a drum that all lines turn the other way": (lambda: SharedWinch("drum", {"a": -1, "b": -0.5}, "force"),
        r"drum\.lines has the ratios \[-1, -0\.5\]; with the control 'force' one of them must be above 0"),
    "a mass without effect": (lambda: SharedWinch("drum", {"a": 1}, winch_mass=2.0),
        r"drum\.winch_mass is 2\.0 and has no effect: control is 'speed'"),
    "a start without effect": (lambda: SharedWinch("drum", {"a": 1}, "length", winch_start="equilibrium"),
        r"drum\.winch_start is 2 and has no effect: control is 'length'"),
    "a start that is none": (lambda: SharedWinch("drum", {"a": 1}, "force", winch_start="rest"),
        r"drum\.winch_start is 'rest'; it must be one of 1 \(given\), 2 \(equilibrium\)"),
    "a mass below 0": (lambda: SharedWinch("drum", {"a": 1}, "force", winch_mass=-1.0), r"drum\.winch_mass is -1\.0"),
    "a force that is none": (lambda: SharedWinch("drum", {"a": 1}, "force", winch_force=np.inf),
        r"drum\.winch_force is inf"),
    "a speed that is none": (lambda: SharedWinch("drum", {"a": 1}, "speed", np.nan), r"drum\.reel_out_speed is nan"),
    "a wrong name": (lambda: SharedWinch("a drum", {"a": 1}), "the name of a winch is 'a drum'"),
    "an unknown argument": (lambda: SharedWinch("drum", {"a": 1}, ratio=1), "SharedWinch has no argument 'ratio'"),
}  # fmt: skip
FITTING = {
    "an unknown line": ([SharedWinch("drum", {"c": 1})],
        "the winch drum holds the line c, which does not exist; there are a, b"),
    "a taken name": ([SharedWinch("pod", {"a": 1})], "the name pod is given twice"),
    "other controls": ([SharedWinch("one", {"a": 1}), SharedWinch("two", {"a": 1, "b": 1}, "length")],
        r"the line a is held by winches with different controls, one \(speed\), two \(length\)"),
    "force and speed": ([SharedWinch("one", {"a": 1}, "force"), SharedWinch("two", {"a": 1, "b": 1})],
        r"the line a is held by winches with different controls, one \(force\), two \(speed\)"),
    "the same ratios": ([SharedWinch("one", {"a": 1, "b": 2}), SharedWinch("two", {"a": 2, "b": 4})],
        "the winches one, two hold the same lines in the same ratios"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_winch_is_refused(case):
    make, said = WRONG[case]
    with pytest.raises((ValueError, TypeError), match=said):
        make()


@pytest.mark.parametrize("case", FITTING)
def test_winches_that_do_not_fit_are_refused(case):
    winches, said = FITTING[case]
    with pytest.raises(ValueError, match=said):
        TetherSystem(POINTS, lines_with(), winches=winches)


def test_what_a_winch_cannot_do_by_force():
    lines = [replace(line, tether=replace(TAPE, damping_law="stretch_rate")) for line in lines_with()]
    with pytest.raises(ValueError, match=r"a\.damping_law is stretch_rate, and drum holds it by force"):
        TetherSystem(POINTS, lines, winches=[SharedWinch("drum", {"a": 1.0}, "force")])


def test_inputs_of_a_winch_by_force_that_cannot_be():
    """A drum without mass cannot push at lines that it only pays out."""
    system = TetherSystem(POINTS, lines_with(), winches=[SharedWinch("drum", {"a": 1.0}, "force", winch_force=50.0)])
    system.initialize(loads={"right": (0.0, 0.0, 300.0)})
    with pytest.raises(StepRefused, match=r"the line a: .*winch_force"):
        system.step(STEP, winch_forces={"drum": -100.0})
    with pytest.raises(ValueError, match="there is no winch_force of a line or a winch with the name 'a'"):
        system.step(STEP, winch_forces={"a": 1.0})
    system.step(STEP)


def test_a_line_has_no_other_winch():
    for lines in (lines_with(Winch(winch_control="length")), lines_with(a=1.0)):
        with pytest.raises(ValueError, match="the line a is held by the winch drum; it can have no winch of its own"):
            TetherSystem(POINTS, lines, winches=[SharedWinch("drum", {"a": 1})])
    with pytest.raises(TypeError, match=r"winches is .*; it must be a sequence of SharedWinch"):
        TetherSystem(POINTS, lines_with(), winches=[Winch()])


def test_inputs_that_do_not_exist_are_refused():
    system = shared("length")
    system.initialize()
    for given, said in (
        ({"reel_out_speeds": {"a": 1.0}}, "there is no reel_out_speed of a line or a winch with the name 'a'"),
        ({"reel_out_speeds": {"steering": 1.0}}, "there is no reel_out_speed of a line or a winch with the name 'steering'"),
        ({"winch_lengths": {"steerin": 1.0}}, "did you mean steering?"),
    ):
        with pytest.raises(ValueError, match=said.replace("?", r"\?")):
            system.step(STEP, **given)


def test_a_line_of_a_winch_lets_go():
    """And reels on, as its winch does; the same line with a winch of its own moves alike, bit for bit."""
    system, alone = shared(), TetherSystem(POINTS, lines_with())
    for each in (system, alone):
        each.initialize()
    for k in range(20):
        outputs = system.step(STEP, reel_out_speeds={"steering": 0.1}, releases={"a": k >= 5})
        same(outputs, alone.step(STEP, reel_out_speeds={"a": 0.1, "b": -0.1}, releases={"a": k >= 5}))
    assert outputs.lines["a"].broken
    assert outputs.lines["a"].tether_length > TAPE.initial_length
    with pytest.raises(ValueError, match="there is no release of a line with the name 'steering'"):
        system.step(STEP, releases={"steering": True})
