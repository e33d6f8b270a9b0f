"""Examples of systems: each against the statics, the formula or the triangle that it names; what they print and draw."""

import re
from functools import cache

import numpy as np
import pytest

from manual import page
from running import assert_is_drawn
from systems import four_drones, hoist, sheaves, steered_kite, two_kites, y_bridle
from tetherfmu import TetherSystem
from tetherfmu.runtime.layout import SLACK_SEGMENTS

for each in (four_drones, hoist, steered_kite, y_bridle):
    each.fly = cache(each.fly)  # once for what is tested and what is printed
two_kites.fly_together, two_kites.fly_alone = cache(two_kites.fly_together), cache(two_kites.fly_alone)


@pytest.mark.filterwarnings("error")
def test_atwood_runs_as_the_formula_says():
    """The rope stretches by 0.03 %."""
    time, payout, tensions = sheaves.fly_atwood()
    np.testing.assert_allclose(payout, sheaves.payout_of_atwood(time), rtol=0, atol=2e-3)
    assert np.all(tensions[-1] < 9.81 * (sheaves.HEAVY + 2.0 * sheaves.SIDE))


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("falls", [2, 4])
def test_a_block_rises_by_its_part_of_the_rope(falls):
    """Within 1 %: the falls stretch by 0.1 % of 20 m, and the block swings on them. Each sheave loses 2 %."""
    _, rise, hauled, tensions = sheaves.fly_hoist(falls)
    assert rise[-1] == pytest.approx(hauled[-1] / falls, rel=0.01)
    mean = tensions[-100:].mean(axis=0)
    assert mean.sum() == pytest.approx(2000.0 * 9.81, rel=0.01)
    np.testing.assert_allclose(mean[1] / mean[0], 0.98, rtol=1e-3)


@pytest.mark.filterwarnings("error")
def test_the_clothes_line_is_in_balance():
    place, pulls = sheaves.hang()
    assert pulls[0] == pytest.approx(pulls[1], rel=1e-9)
    assert 0.0 < place[0] < 6.0  # nearer to the lower end


@pytest.mark.filterwarnings("error")
def test_ropes_over_sheaves_are_printed_and_drawn(tmp_path, capsys):
    sheaves.main(["--out", str(tmp_path)])
    assert_is_drawn(tmp_path / "sheaves.png")
    assert "by the formula 2.852 m" in capsys.readouterr().out


def test_the_load_tilts_as_four_bars_do(tmp_path, capsys):
    time, ends, tensions = hoist.fly()
    settled = time > hoist.DURATION - hoist.SETTLED
    mean = ends[settled].mean(axis=0)
    bars = hoist.hanging(*hoist.lengths(hoist.DURATION))
    np.testing.assert_allclose(np.linalg.norm(bars[1] - bars[0]), hoist.BEAM, rtol=1e-12)
    assert hoist.tilt_of(mean) == pytest.approx(hoist.tilt_of(bars), abs=np.radians(0.05))
    # the ropes stretch by 2 kN/4 MN of 20 m, 1 cm; they weigh 8 kg each, and pull the ends together by some mm
    np.testing.assert_allclose(mean, bars, rtol=0, atol=0.02)
    weight = 9.81 * (400.0 + 0.399 * sum(hoist.lengths(hoist.DURATION)))  # of the load and the ropes
    ropes = np.diff(np.vstack([hoist.LEFT, mean, hoist.RIGHT]), axis=0)[[0, 2]]
    upwards = tensions[settled].mean(axis=0) @ np.abs(ropes[:, 1] / np.linalg.norm(ropes, axis=1))
    assert upwards == pytest.approx(weight, rel=5e-3)
    hoist.main(["--out", str(tmp_path)])
    assert_is_drawn(tmp_path / "hoist.png")
    assert "four bars: tilt 29.44 deg, middle at x = 0.404 m" in capsys.readouterr().out


def test_ropes_pull_as_statics_say_until_they_go_slack(tmp_path, capsys):
    four_drones.main(["--out", str(tmp_path)])
    assert "a rope goes slack at 3.71 m/s2" in capsys.readouterr().out
    assert_is_drawn(tmp_path / "four_drones_7s.png")
    time, flown = four_drones.fly(14.0)
    flies = time < 14.0
    acceleration = four_drones.motion(time, 14.0)[2]
    more = [
        (four_drones.tension(flown, ropes) - four_drones.tension_by_statics(acceleration, side))[flies]
        for ropes, side in ((four_drones.AHEAD, 1), (four_drones.BEHIND, -1))
    ]
    # the ropes weigh something; the air holds them and they bounce, which adds to those ahead what it takes from the others
    assert np.mean(more) == pytest.approx(weight_in_rope(), rel=0.02)
    assert np.std(more) < 1.0
    assert not any(flown.outputs[name][:, SLACK_SEGMENTS].any() for name in four_drones.AHEAD + four_drones.BEHIND)
    _, fast = four_drones.fly(7.0)
    assert any(fast.outputs[name][:, SLACK_SEGMENTS].any() for name in four_drones.BEHIND)


def weight_in_rope():
    """What its own weight w adds to the tension of the first segment of four [N].

    The chord leans by an angle from the vertical, and the lower end leans more than it by w sin/(2 T), so T there is
    (m g/4 + w sin^2/2)/cos; all the weight but that of half a segment comes on top of it.
    """
    weight = TetherSystem.from_file(four_drones.FILE).lines[0].tether.mass_per_length * four_drones.ROPE * 9.81
    cos = four_drones.BELOW / four_drones.ROPE
    return weight * (0.5 * (1.0 - cos**2) / cos + (1.0 - 1.0 / 8.0) * cos)


def test_a_kite_pulls_its_arm_only():
    """The formula is that of a straight tether about a knot that rests; both are so to some per cent."""
    _, flown = two_kites.fly_together()
    alone = two_kites.fly_alone()
    left = flown.points["left"]
    settled = slice(500, None)
    assert two_kites.drag(left.force[settled], left.velocity[settled]) == pytest.approx(two_kites.formula(60.0), rel=0.05)
    length = np.hypot(two_kites.AWAY, two_kites.RADIUS)
    by_itself = two_kites.drag(alone.kite_force[settled], left.velocity[settled])
    assert by_itself == pytest.approx(two_kites.formula(length), rel=0.03)
    knot = flown.points["knot"].position[settled]
    assert np.ptp(knot, axis=0).max() < 0.6  # m, of circles of 80 m


def test_what_two_kites_print_is_on_the_page(tmp_path, capsys):
    two_kites.main(["--out", str(tmp_path)])
    assert_is_drawn(tmp_path / "two_kites.png")
    said = capsys.readouterr().out
    own = np.hypot(two_kites.AWAY, two_kites.RADIUS)
    for where, length in (("the shared tether", two_kites.ARM), ("one of its own", own)):
        found, formula = map(float, re.search(rf"held back by (\S+) N on {where} \(formula (\S+) N\)", said).groups())
        assert formula == pytest.approx(two_kites.formula(length), abs=0.05)  # no more digits are printed
        assert found == pytest.approx(formula, rel=0.05)
        assert f" by {found:.0f} N" in page("use/gallery").replace("\n", " ")


def test_the_kite_rolls_as_statics_say(tmp_path, capsys):
    y_bridle.main(["--out", str(tmp_path)])
    assert "(at rest 4.92 deg)" in capsys.readouterr().out
    assert_is_drawn(tmp_path / "y_bridle.png")
    time, flown = y_bridle.fly()
    roll, at_rest = y_bridle.roll_of(flown, time), y_bridle.roll_at_rest(time)
    # the tips weigh 2 % of the lift, and the roll swings with some 1.5 Hz: the frequency of the steering over that, squared,
    # is 1 %; at first it also swings because the steering begins abruptly, with 5 % and for some seconds
    error = np.abs(roll - at_rest) / np.abs(at_rest).max()
    assert error.max() < 0.06
    assert error[time > 10.0].max() < 0.025
    tension = {name: flown.outputs[name][:, y_bridle.GROUND_TENSION] for name in y_bridle.COLOURS}
    # moments about the other tip: what the right line carries over what the left one does, at the largest shift
    row = np.argmax(y_bridle.shift(time))
    more, less = 1.0 + y_bridle.SHIFT, 1.0 - y_bridle.SHIFT
    sides = tension["bridle_right"][row] / tension["bridle_left"][row]
    assert sides == pytest.approx(bridle_ratio(more, less, at_rest[row]), rel=0.02)


def bridle_ratio(more, less, roll):
    """Tension of the right line over that of the left one, from the forces across the wing on tips that roll [rad]."""
    height = np.sqrt(y_bridle.BRIDLE**2 - 0.25 * y_bridle.WIDTH**2)
    lean = np.arctan2(0.5 * y_bridle.WIDTH, height)  # of a line against the normal of the wing
    half, spread = 0.5 * y_bridle.LIFT, y_bridle.SPREAD
    right, left = (part * half * np.cos(roll) - side * spread * np.sin(roll) for part, side in ((more, 1.0), (less, -1.0)))
    return (right / np.cos(lean)) / (left / np.cos(lean))


def test_the_wing_rolls_as_a_triangle_does(tmp_path, capsys):
    steered_kite.main(["--out", str(tmp_path)])
    said = capsys.readouterr().out
    assert "after 14 s: roll 9.4" in said
    assert_is_drawn(tmp_path / "steered_kite.png")
    time, roll, paid_out, tensions = steered_kite.fly()
    given = steered_kite.payouts(time)
    # an input is extrapolated over a step, and followed in the next one
    np.testing.assert_allclose(paid_out, given, atol=2e-4)
    # tapes stretch by 0.5 %, which changes the roll by as much; it swings by as little, as the winch is slow
    np.testing.assert_allclose(roll, steered_kite.roll_of(*given), atol=np.radians(0.15))
    still = (time > 37.0) & (time < 41.0)
    # both tapes meet the wing's middle line at angles whose sines are as 1 to 1 over their lengths, see the triangle
    long, short = steered_kite.TAPE - steered_kite.STEERED, steered_kite.TAPE + steered_kite.STEERED
    left, right = tensions[:, still].mean(axis=1)
    assert abs(left / right / (long / short) - 1.0) < 5e-3
