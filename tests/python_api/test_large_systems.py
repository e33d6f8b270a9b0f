"""The work of describing a system grows in proportion to its lines: function calls are counted, not seconds."""

import sys

import pytest

from tetherfmu import Line, Point, Tether
from tetherfmu.records.systems import checked_system
from tetherfmu.wiring.fmu import of_system
from tetherfmu.wiring.system import System

FEW, FACTOR = 20, 4


def apart(count):
    """Lines between two driven points each."""
    points = [Point(f"{end}{k}", (x, float(k), 10.0)) for k in range(count) for end, x in (("a", 0.0), ("b", 20.0))]
    return points, [Line(f"line{k}", f"a{k}", f"b{k}", Tether(initial_length=21.0, segments=2)) for k in range(count)]


def star(count):
    """Lines from driven points to one free point."""
    points = [Point(f"a{k}", (float(k), 0.0, 30.0)) for k in range(count)] + [Point("hook", (0.0, 0.0, 10.0), mass=100.0)]
    return points, [Line(f"line{k}", f"a{k}", "hook", Tether(initial_length=25.0, segments=2)) for k in range(count)]


def row(count):
    """Lines in a row, with free points between them."""
    points = [Point(f"p{k}", (10.0 * k, 0.0, 0.0), **({"mass": 0.1} if 0 < k < count else {})) for k in range(count + 1)]
    return points, [Line(f"line{k}", f"p{k}", f"p{k + 1}", Tether(initial_length=10.5, segments=2)) for k in range(count)]


def calls(function, *arguments):
    """How often Python functions and generators are entered while a function runs."""
    count = 0

    def note(frame, event, argument):
        nonlocal count
        count += event == "call"

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        function(*arguments)
    finally:
        sys.setprofile(before)
    return count


@pytest.mark.parametrize("kind", [apart, star, row])
def test_tables_of_an_fmu_grow_with_the_lines(kind):
    """A fifth more than in proportion is for what is sorted."""
    systems = [checked_system(System("large", *map(tuple, kind(count)))) for count in (FEW, FACTOR * FEW)]
    few, many = (calls(of_system, system) for system in systems)
    assert many < 1.2 * FACTOR * few
