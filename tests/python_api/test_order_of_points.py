"""Free points are numbered so that the matrix of the points has a narrow band, whatever the order in which they are given.

Points of neighbours have numbers that differ by 1 on a chain and by 2 on a ladder; three numbers for each point.
"""

import numpy as np
import pytest

from tetherfmu import Line
from tetherfmu.wiring.ordering import ordered


def chain(count):
    return [(k, k + 1) for k in range(count - 1)]


def ladder(count):
    """Two chains, of the even and of the odd points, with rungs."""
    return [(k, k + 2) for k in range(count - 2)] + [(k, k + 1) for k in range(0, count, 2)]


@pytest.mark.parametrize(("pairs", "apart"), [(chain, 1), (ladder, 2)])
def test_band(pairs, apart):
    lines = [Line(f"l{k}", f"p{a}", f"p{b}") for k, (a, b) in enumerate(pairs(40))]
    given = [f"p{k}" for k in np.random.default_rng(1).permutation(40)]
    found, band = ordered(given, lines)
    numbers = {name: k for k, name in enumerate(found)}
    assert sorted(found) == sorted(given)
    assert max(abs(numbers[line.start] - numbers[line.end]) for line in lines) == apart
    assert band == apart
