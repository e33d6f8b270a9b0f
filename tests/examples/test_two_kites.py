"""Two kites on one tether: the drag on them against the formula of a tether that turns, and what the example prints."""

import re
import sys

import numpy as np
import pytest

from running import EXAMPLES, assert_is_drawn, run_python

sys.path.append(str(EXAMPLES))

from systems import two_kites


def test_a_kite_pulls_its_arm_only(tmp_path):
    """The formula is that of a straight tether about a knot that rests; both are so to some per cent."""
    _, flown = two_kites.fly_together()
    alone = two_kites.fly_alone()
    left = flown.points["left"]
    settled = slice(500, None)
    assert two_kites.drag(left.force[settled], left.velocity[settled]) == pytest.approx(two_kites.formula(60.0), rel=0.05)
    length = np.hypot(two_kites.AWAY, two_kites.RADIUS)
    assert two_kites.drag(alone.kite_force[settled], left.velocity[settled]) == pytest.approx(
        two_kites.formula(length), rel=0.03
    )
    knot = flown.points["knot"].position[settled]
    assert np.ptp(knot, axis=0).max() < 0.6  # m, of circles of 80 m
    two_kites.draw(flown, alone, tmp_path / "two_kites.png")
    assert_is_drawn(tmp_path / "two_kites.png")


def test_prints_what_the_page_says(tmp_path):
    said = run_python(EXAMPLES / "systems" / "two_kites.py", "--out", tmp_path).stdout
    page = (EXAMPLES.parent / "docs" / "use" / "gallery.md").read_text(encoding="utf-8").replace("\n", " ")
    own = np.hypot(two_kites.AWAY, two_kites.RADIUS)
    for where, length in (("the shared tether", two_kites.ARM), ("one of its own", own)):
        found, formula = map(float, re.search(rf"held back by (\S+) N on {where} \(formula (\S+) N\)", said).groups())
        assert formula == pytest.approx(two_kites.formula(length), abs=0.05)  # no more digits are printed
        assert found == pytest.approx(formula, rel=0.05)
        assert f" by {found:.0f} N" in page
