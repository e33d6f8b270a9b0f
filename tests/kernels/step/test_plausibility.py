"""What no tether and no kite does is noted in the state once, with its first value; what does happen is not.

Stretch l/l0 > 1.05; acceleration 2 |x1 - x0 - v0 h|/(h H) > 9810 m/s2; speed > 340 m/s; twice in a row, on 0.5 m of an end,
its velocities leave more than half of the way unexplained. A winch with mass that reels in a tether 1 % longer than the
distance of its ends, whose tension is below a tenth of what drives the winch; a length that a winch was told, more than 5 %
and 10 m above the distance of the ends. A tether without ground contact that hangs deeper under the ground than 1 % of its
length, both ends above it; a driven end more than 0.1 m under a ground with contact. The limits are those of
runtime/plausibility.py, written here once more.
"""

import numpy as np
import pytest

from scenes import circle
from solvers import MODELS, every_model
from tetherfmu import PlausibilityWarning, TetherDynamic, TetherQuasiSteady, TetherStraight
from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plausibility

STEP = 0.02
KITE = np.array([300.0, 0.0, 400.0])
ALONG = KITE / 500.0
every_end = pytest.mark.parametrize("end", ["kite", "ground"])
pytestmark = pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")  # tests read what is noted instead


def noted(model):
    """Values that were noted, by kind."""
    state = model.get_state()
    kinds = plausibility.kinds(state)
    # have tests of their own: the station is at z = 0, and slack tethers hang; ends that are faster than sound bend them
    kinds &= ~(1 << plausibility.GROUND_IGNORED | 1 << plausibility.LOAD_OFF_CHORD)
    return {k: state[at.WARNED_VALUES + k] for k in range(at.WARNING_KINDS) if kinds >> k & 1}


def kind(end, what):
    return getattr(plausibility, f"{end.upper()}_{what}")


def fly(model, positions, velocities, step=STEP, end="kite"):
    """Start at the first position and do a step from each; the ends that do not move are 500 m apart."""
    rest = {"kite_position": KITE} if end == "ground" else {}
    for k, (position, velocity) in enumerate(zip(positions, velocities, strict=True)):
        inputs = {f"{end}_position": position, f"{end}_velocity": velocity, **rest}
        if k == 0:
            model.initialize(**inputs)
        model.step(step, **inputs)
    return noted(model)


def on_circle(count, step=STEP, rate=0.05):
    pairs = [circle(k * step, rate) for k in range(count)]
    return np.array(pairs).swapaxes(0, 1)


@every_model
def test_stretch(model):
    """At the start: the chord is 500 m long. 1.049 times the length is allowed, 1.051 not; 5 times is five times."""
    for stretch, told in ((1.049, False), (1.051, True), (5.0, True)):
        tether = model(initial_length=500.0 / stretch)
        tether.initialize(KITE)
        found = noted(tether)
        assert set(found) == ({plausibility.STRETCH} if told else set())
        if told:  # the chain and the catenary sag: they are longer than their chord by less than 1e-4 of it
            assert found[plausibility.STRETCH] == pytest.approx(stretch, rel=1e-3)


@every_model
def test_stretch_in_flight(model):
    """Reeled in by 1 m/s for 35 s, 2 % slack at the start."""
    tether = model(initial_length=510.0)
    tether.initialize(KITE)
    for _ in range(350):
        tether.step(0.1, kite_position=KITE, reel_out_speed=-1.0)
    found = noted(tether)
    assert set(found) == {plausibility.STRETCH}
    assert found[plausibility.STRETCH] == pytest.approx(1.05, abs=2e-3)  # noted when it was passed: 0.02 % in a step


@every_model
@every_end
def test_speed_at_the_start_and_in_flight(model, end):
    across = np.array([0.0, 1.0, 0.0])
    for speed in (339.0, 341.0):
        found = fly(model(initial_length=520.0), [np.zeros(3) if end == "ground" else KITE], [speed * across], 1e-6, end)
        assert set(found) == ({kind(end, "SPEED")} if speed > 340.0 else set())
        start = KITE if end == "kite" else np.zeros(3)
        times, acceleration = 0.01 * np.arange(100), 1000.0  # [m/s2]: 340 m/s after 0.34 s
        positions = start + 0.5 * acceleration * times[:, None] ** 2 * across
        until = 30 if speed < 340.0 else 40
        found = fly(
            model(initial_length=620.0), positions[:until], (acceleration * times[:, None] * across)[:until], 0.01, end
        )
        assert set(found) == ({kind(end, "SPEED")} if speed > 340.0 else set())


@every_model
@every_end
def test_acceleration(model, end):
    """A jump by d at rest is 2 d/h^2: 9810 m/s2 for 1.96 mm in 0.632 ms; in the first step it is told by its way."""
    start = KITE if end == "kite" else np.zeros(3)
    step, still = 6.32e-4, np.zeros((4, 3))
    for jump, told in ((1.9e-3, False), (2.0e-3, True)):
        positions = start - np.array([0.0, 0.0, 1.0, 1.0])[:, None] * jump * ALONG
        found = fly(model(initial_length=510.0), positions, still, step, end)
        assert set(found) == ({kind(end, "ACCELERATION")} if told else set())
        if told:
            assert found[kind(end, "ACCELERATION")] == pytest.approx(2.0 * jump / step**2, rel=1e-9)  # 500 m in doubles
    tether = model(initial_length=510.0)
    tether.initialize(KITE)
    tether.step(STEP, **{f"{end}_position": start - 3.0 * ALONG})
    found = noted(tether)
    found.pop(plausibility.SLACK_PRESSES, None)
    assert found == {kind(end, "JUMP"): pytest.approx(3.0 * np.linalg.norm(ALONG))}


@every_model
def test_acceleration_after_a_change_of_the_step(model):
    """Smooth flight: a step of 20 ms leads the end 5/12 jerk h^3 beside its way; the next, of 0.1 ms, begins to correct it.

    y = A sin(w t), jerk = -A w^3 cos(w t). Within the short step alone the correction would be 5e4 m/s2: no motion of the
    kite, so no warning. A jump d of the position in such a step counts as 2 d/(h H): 1e6 m/s2 for 1 m, with H = 20 ms.
    """
    swing, rate, short = 10.0, 2.0, 1e-4  # m, rad/s, s
    across = np.array([0.0, 1.0, 0.0])
    for jump in (0.0, 1.0):
        tether = model(initial_length=510.0)
        tether.initialize(KITE, swing * rate * across)
        for k in range(11):
            time = k * STEP
            assert noted(tether) == {}
            way, speed = swing * np.sin(rate * time), swing * rate * np.cos(rate * time)
            tether.step(STEP if k < 10 else short, KITE + (way + (jump if k == 10 else 0.0)) * across, speed * across)
        jerk = swing * rate**3 * np.cos(rate * 9 * STEP)
        assert 2.0 * 5.0 / 12.0 * jerk * STEP**3 / short**2 > 2.0 * plausibility.LARGEST_ACCELERATION
        found = noted(tether)
        if jump == 0.0 or model is TetherDynamic:  # whose curve does only 3 (h/H)^2 of the jump in this step
            assert found == {}
        else:
            assert set(found) == {plausibility.KITE_ACCELERATION}
            assert found[plausibility.KITE_ACCELERATION] == pytest.approx(2.0 * jump / (short * STEP), rel=0.01)


@every_model
@pytest.mark.parametrize(
    ("given", "way"),
    [(0.0, 1.0), (-1.0, 2.0), (0.4, 0.6), (1.6, 0.6 / 1.6), (2.5, 0.6)],
    ids=["zero", "back", "slow", "fast", "faster"],
)
def test_contradiction_on_the_circle(model, given, way):
    """Velocities are a factor `given` of the right ones: 1 - given of the way is left, over the longer of both ways."""
    positions, velocities = on_circle(20)
    found = fly(model(initial_length=525.0), positions, given * velocities)
    told = abs(1.0 - given) / max(1.0, given) > 0.5
    assert set(found) - {plausibility.SLACK_PRESSES} == ({plausibility.KITE_RESIDUE} if told else set())
    if told:  # the circle is a line here but for its curvature, 0.01 rad
        assert found[plausibility.KITE_RESIDUE] == pytest.approx(way, rel=1e-3)


@every_model
def test_contradiction_comes_after_a_metre(model):
    """Twice half a metre in a row, 87 mm in a step: the thirteenth input ends the second one."""
    positions, velocities = on_circle(13)
    assert fly(model(initial_length=525.0), positions[:12], 0.0 * velocities[:12]) == {}
    assert set(fly(model(initial_length=525.0), positions, 0.0 * velocities)) == {plausibility.KITE_RESIDUE}


def test_no_contradiction_of_a_single_jump():
    """One position that is wrong by metres is an acceleration."""
    positions, velocities = on_circle(40)
    positions[20:] += 5.0
    assert set(fly(TetherStraight(initial_length=525.0), positions, velocities)) == {plausibility.KITE_ACCELERATION}


@every_model
@every_end
def test_contradiction_of_a_straight_flight(model, end):
    start, speed = (KITE if end == "kite" else np.zeros(3)), np.array([1.0, -6.0, 2.0])
    positions = start + STEP * np.arange(20)[:, None] * speed
    tether = model(initial_length=520.0)
    assert fly(tether, positions, np.tile(speed, (20, 1)), end=end) == {}
    assert set(fly(tether, positions, np.zeros((20, 3)), end=end)) == {kind(end, "RESIDUE")}
    held = np.tile(start, (20, 1))  # the other way round: velocities without positions
    assert set(fly(tether, held, np.tile(speed, (20, 1)), end=end)) == {kind(end, "RESIDUE")}


@pytest.mark.parametrize("angle", [0.5, 1.0, 2.0])
def test_no_contradiction_in_coarse_steps(angle):
    """A step over an angle t: the way is 2 r sin(t/2), the mean velocity explains r t cos(t/2) of it: 64 % for 2 rad."""
    positions, velocities = on_circle(60, angle / 0.05)
    assert plausibility.KITE_RESIDUE not in fly(TetherStraight(initial_length=525.0), positions, velocities, angle / 0.05)


@every_end
@pytest.mark.parametrize("step", [0.02, 0.1])
def test_no_contradiction_of_noise_at_rest(end, step):
    """1 mm of noise, 20 000 steps: the way adds up to 40 m, what it leaves does not."""
    start = KITE if end == "kite" else np.zeros(3)
    noise = 1e-3 * np.random.default_rng(3).normal(size=(20_000, 3))
    assert fly(TetherStraight(initial_length=510.0), start + noise, np.zeros_like(noise), step, end) == {}
    velocities = 0.2 * np.random.default_rng(4).normal(size=noise.shape)  # [m/s]
    assert fly(TetherStraight(initial_length=510.0), start + noise, velocities, step, end) == {}


@pytest.mark.parametrize("step", [0.1, 0.02, 0.005])
@pytest.mark.parametrize("speeds", [(0.0, 30.0), (30.0, 0.0), (10.0, -10.0), (-20.0, 5.0)])
def test_no_contradiction_of_jumps_of_the_velocity(step, speeds):
    """The velocity jumps every 0.5 s between two, at a communication point or between two of them."""
    for late in (0.0, 0.3, 0.7):
        times = step * np.arange(400)
        turns = np.floor((times + late * step) / 0.5 + 1e-9).astype(int)
        within = times + late * step - 0.5 * turns
        whole = 0.5 * (np.array(speeds)[np.arange(turns.max() + 1) % 2]).cumsum()
        way = np.concatenate(([0.0], whole))[turns] + within * np.array(speeds)[turns % 2]
        velocity = np.array(speeds)[turns % 2][:, None] * np.array([0.0, 1.0, 0.0])
        positions = KITE + (way - way[0])[:, None] * np.array([0.0, 1.0, 0.0])
        found = fly(TetherStraight(initial_length=1e4), positions, velocity, step)
        assert plausibility.KITE_RESIDUE not in found


def test_a_free_end_moves_as_it_must():
    """Nobody gives its motion, so nothing contradicts, and no jump of an input is behind its acceleration."""
    tether = TetherDynamic(initial_length=50.0, segments=5, free_ends=(False, True))
    tether.initialize((30.0, 0.0, 40.0))
    for _ in range(200):
        tether.step(STEP)
    assert set(noted(tether)) == {plausibility.SLACK_PRESSES}  # it folds as it falls


@every_model
def test_once_since_the_start(model):
    """The first value stays; a new start begins anew."""
    positions, velocities = on_circle(60)
    tether = model(initial_length=525.0)
    first = fly(tether, positions[:20], 0.0 * velocities[:20])
    assert fly(tether, positions, 0.0 * velocities) == first
    assert fly(tether, positions, velocities) == {}


@every_model
def test_numbers_are_the_same(model):
    """What is noted changes nothing: a state in which all was noted goes on with the same numbers."""
    positions, velocities = on_circle(40)
    clean, noisy = (model(initial_length=525.0) for _ in range(2))
    for tether in (clean, noisy):
        fly(tether, positions[:5], velocities[:5])
    state = noisy.get_state()
    state[at.WARNINGS] = (1 << at.WARNING_KINDS) - 1
    state[at.WARNED_VALUES : at.WARNED_VALUES + at.WARNING_KINDS] = 1e9
    noisy.set_state(state)
    for position, velocity in zip(positions[5:], velocities[5:], strict=True):
        outputs = [tether.step(STEP, kite_position=position, kite_velocity=velocity) for tether in (clean, noisy)]
        assert all(np.array_equal(one, other) for one, other in zip(*outputs, strict=True))


def test_category():
    with pytest.warns(PlausibilityWarning, match=r"^a segment is stretched by 400 %; from 5 % on"):
        TetherStraight(initial_length=100.0).initialize(KITE)


@pytest.mark.parametrize(
    ("fixed", "told"),
    [
        ({"fixed_step_method": "backward_euler"}, True),
        ({"fixed_step_method": "second_order"}, False),
        ({"fixed_step_method": "backward_euler", "axial_damping": 6200.0}, False),  # less than a tenth
    ],
)
def test_backward_euler_that_damps_more_than_a_tenth_of_the_damping(fixed, told):
    """E A h at the start: 614600 N and a fixed step of 1 ms are 614.6 N s beside 473 N s."""
    tether = TetherDynamic(**{"fixed_step": 1e-3, **fixed})
    tether.initialize(KITE)
    assert noted(tether) == ({plausibility.FIXED_STEP_DAMPS: pytest.approx(614.6)} if told else {})
    assert ["additional axial_damping of 615 N.s, more than 10 % of" in each for each in tether.implausible] == [True] * told


def pulled(model, force, length, steps=20, **winch):
    """What is noted of a winch that pulls with a force [N] at a tether of some length [m]; the ends are 500 m apart."""
    tether = model(segments=6, initial_length=length, winch_control="force", **winch)
    tether.initialize(KITE)
    for _ in range(steps):
        tether.step(STEP, kite_position=KITE, winch_force=force)
    return noted(tether), tether


@every_model
def test_a_winch_that_reels_in_a_slack_tether(model):
    """It has a mass, and nothing holds it: told once, with its force. The tether weighs 292 N."""
    found, tether = pulled(model, 4e3, 510.0, winch_mass=200.0, winch_friction=100.0)
    assert found == {plausibility.WINCH_REELS_IN_SLACK: 4e3}
    assert tether.step(STEP, winch_force=4e3).winch_speed < -5.0
    assert "pulls with 4e+03 N at a slack tether" in tether.implausible[0]


@every_model
@pytest.mark.parametrize(
    ("force", "length", "winch"),
    [
        (4e3, 499.0, {}),  # taut
        (4e3, 504.0, {}),  # nearly so
        (4e3, 510.0, {"winch_friction": 5e3}),  # it is held
        (4e3, 510.0, {"shortest_length": 510.0}),  # a stop holds it
        (-4e3, 510.0, {}),  # it pays out
        (4e3, 510.0, {"winch_mass": 0.0}),  # the length follows at once
    ],
)
def test_a_winch_that_does_not(model, force, length, winch):
    assert (
        plausibility.WINCH_REELS_IN_SLACK not in pulled(model, force, length, steps=3, **{"winch_mass": 200.0, **winch})[0]
    )


@pytest.mark.parametrize("model", MODELS[:-1], ids=lambda model: model.variant)
def test_a_tether_that_hangs_is_not_slack(model):
    """20 m more than the distance of the ends: its weight pulls at the winch with 17 N, 17 % of the force, or 9 %."""
    assert pulled(model, 100.0, 520.0, winch_mass=50.0)[0] == {}
    assert pulled(model, 200.0, 520.0, winch_mass=200.0)[0] == {plausibility.WINCH_REELS_IN_SLACK: 200.0}


@every_model
@pytest.mark.parametrize(
    ("length", "kinds"),
    [
        (470.0, {"STRETCH"}),  # too short, told once and not twice
        (477.0, set()),
        (524.0, set()),
        (526.0, {"WINCH_TOO_LONG"}),
        (1640.0, {"WINCH_TOO_LONG"}),  # 500 m in feet
    ],
)
def test_a_length_that_contradicts_the_distance(model, length, kinds):
    """500 m, at the start and in flight; the excess is noted. With speed control a tether may be as long as it likes."""
    expected = {getattr(plausibility, each) for each in kinds}
    tether = model(winch_control="length")
    tether.initialize(KITE, winch_length=length)
    assert set(noted(tether)) == expected
    if "WINCH_TOO_LONG" in kinds:
        assert noted(tether)[plausibility.WINCH_TOO_LONG] == pytest.approx(length - 500.0)
        assert f"{length - 500.0:.3g} m longer than the distance of the ends, by more than 5 %" in tether.implausible[0]
        other = model(initial_length=length)
        other.initialize(KITE)
        assert noted(other) == {}


@every_model
def test_a_length_that_grows_too_long_in_flight(model):
    tether = model(winch_control="length")
    tether.initialize(KITE, winch_length=520.0, reel_out_speed=10.0)
    for k in range(60):
        tether.step(STEP, kite_position=KITE, winch_length=520.0 + 10.0 * k * STEP)
        assert (plausibility.WINCH_TOO_LONG in noted(tether)) == (tether.outputs().tether_length > 525.0)


@every_model
def test_a_few_metres_to_spare_near_the_winch(model):
    """A drone that lands, a load that is set down: 9 m of tether to a place 2 m away."""
    tether = model(winch_control="length", segments=4)
    tether.initialize((0.0, 0.0, 2.0), winch_length=11.0)
    assert noted(tether) == {}
    tether = model(winch_control="length", segments=4)
    tether.initialize((0.0, 0.0, 2.0), winch_length=12.5)
    assert set(noted(tether)) == {plausibility.WINCH_TOO_LONG}


def hanging(state):
    kind = plausibility.GROUND_IGNORED
    return state[at.WARNED_VALUES + kind] if plausibility.kinds(state) >> kind & 1 else None


@pytest.mark.parametrize("model", [TetherQuasiSteady, TetherDynamic], ids=lambda model: model.variant)
def test_a_tether_that_hangs_below_the_ground(model):
    """Not above it, not if an end is below it, not with ground contact; with the depth that it was noted with."""
    ends = {"kite_position": (60.0, 0.0, 30.0), "ground_position": (0.0, 0.0, 0.0)}
    for changes, told in (
        ({}, True),
        ({"ground_height": -15.0}, True),
        ({"ground_height": -60.0}, False),
        ({"ground_height": 1.0}, False),
        ({"ground_contact": "flat"}, False),
    ):
        tether = model(initial_length=100.0, **changes)
        tether.initialize(**ends)
        depth = changes.get("ground_height", 0.0) - tether.positions[:, 2].min()
        assert hanging(tether.get_state()) == (pytest.approx(depth) if told else None), changes
        assert noted(tether) == {}


@every_model
def test_a_driven_end_under_the_ground(model):
    """0.1 m is allowed: logged positions are not exact. A line without ground says nothing of it."""
    for depth, told in ((0.09, False), (0.5, True)):
        for end in ("kite", "ground"):
            ends = {"kite_position": (30.0, 0.0, 0.0), "ground_position": (0.0, 0.0, 0.0)}
            ends[f"{end}_position"] = (ends[f"{end}_position"][0], 0.0, -depth)
            tether = model(initial_length=30.1, ground_contact="flat")
            tether.initialize(**ends)
            expected = {plausibility.END_UNDER_GROUND: pytest.approx(depth)} if told else {}
            assert noted(tether) == expected
