"""The work around the kernels grows with the number of lines, not with its square: counted lines of Python, no times."""

import sys

import numpy as np
import pytest

from tetherfmu import Line, Point, Tether, TetherSystem
from tetherfmu.wiring.fmu import of_system
from tetherfmu.wiring.ordering import ordered
from tetherfmu.wiring.system import System
from tetherfmu.wiring.system_variables import table_of

FEW, TIMES = 6, 4


def rope(length):
    return Tether(initial_length=length, segments=1)


def apart(count):
    """Lines between two driven points each."""
    points = [Point(f"{end}{k}", (x, float(k), 10.0)) for k in range(count) for end, x in (("a", 0.0), ("b", 20.0))]
    return points, [Line(f"line{k}", f"a{k}", f"b{k}", rope(21.0)) for k in range(count)]


def star(count):
    """Lines from driven points to one free point."""
    points = [Point(f"a{k}", (float(k), 0.0, 30.0)) for k in range(count)] + [Point("hook", (0.0, 0.0, 10.0), mass=100.0)]
    return points, [Line(f"line{k}", f"a{k}", "hook", rope(25.0)) for k in range(count)]


def chain(count):
    """Lines in a row, with free points between them."""
    points = [Point(f"p{k}", (10.0 * k, 0.0, 0.0), mass=None if k in (0, count) else 1.0) for k in range(count + 1)]
    return points, [Line(f"line{k}", f"p{k}", f"p{k + 1}", rope(10.0)) for k in range(count)]


def stepped(points, lines):
    """All that a step can be given, to a system that has started."""
    system = TetherSystem(points, lines)
    system.initialize()
    driven = {point.name: point.position for point in points if point.is_driven}
    loads = {point.name: (0.0, 0.0, 1.0) for point in points if not point.is_driven}
    speeds = {line.name: 0.0 for line in lines}
    return lambda: system.step(0.01, driven, loads=loads, reel_out_speeds=speeds)


def wired(points, lines):
    """The variables of its FMU, and where they stand."""
    system = System("many", points, lines)
    return lambda: (table_of(system), of_system(system, (), ()))


def counted(work):
    """Lines of Python that some work executes."""
    count = 0

    def tick(_frame, event, _argument):
        nonlocal count
        count += event == "line"
        return tick

    before = sys.gettrace()
    sys.settrace(tick)
    try:
        work()
    finally:
        sys.settrace(before)
    return count


@pytest.mark.parametrize(("of", "kind"), [(stepped, chain), (wired, apart), (wired, star), (wired, chain)])
def test_work_grows_with_the_lines(of, kind):
    """Four times as many lines take at most four times the work: what is there for any number only lessens it."""
    few, many = (counted(of(*kind(count))) for count in (FEW, TIMES * FEW))
    assert FEW < few < many <= TIMES * few


# --- free points are numbered so that their matrix has a narrow band, however they are given


def path(count):
    return [(k, k + 1) for k in range(count - 1)]


def ladder(count):
    """Two chains, of the even and of the odd points, with rungs."""
    return [(k, k + 2) for k in range(count - 2)] + [(k, k + 1) for k in range(0, count, 2)]


@pytest.mark.parametrize(("pairs", "width"), [(path, 1), (ladder, 2)])
def test_band(pairs, width):
    lines = [Line(f"l{k}", f"p{a}", f"p{b}") for k, (a, b) in enumerate(pairs(40))]
    given = [f"p{k}" for k in np.random.default_rng(1).permutation(40)]
    found, band = ordered(given, lines)
    numbers = {name: k for k, name in enumerate(found)}
    assert sorted(found) == sorted(given)
    assert max(abs(numbers[line.start] - numbers[line.end]) for line in lines) == width
    assert band == width
