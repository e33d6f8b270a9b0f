"""The work around the kernels grows with the number of lines, not with its square: counted lines of Python, no times."""

import sys

import pytest

from tetherfmu import Line, Point, Tether, TetherSystem
from tetherfmu.wiring.fmu import of_system
from tetherfmu.wiring.system import System
from tetherfmu.wiring.system_variables import table_of

FEW, TIMES = 12, 4
ROPE = Tether(initial_length=10.0, segments=1)


def chain(count):
    """Points and lines of a chain between two driven ends."""
    points = [Point(f"p{k}", (10.0 * k, 0.0, 0.0), mass=None if k in (0, count) else 1.0) for k in range(count + 1)]
    return points, [Line(f"l{k}", f"p{k}", f"p{k + 1}", ROPE) for k in range(count)]


def stepped(count):
    """All that a step can be given, to a system that has started."""
    points, lines = chain(count)
    system = TetherSystem(points, lines)
    system.initialize()
    given = {f"p{k}": (10.0 * k, 0.0, 0.0) for k in (0, count)}
    loads = {f"p{k}": (0.0, 0.0, 1.0) for k in range(1, count)}
    speeds = {line.name: 0.0 for line in lines}
    return lambda: system.step(0.01, given, loads=loads, reel_out_speeds=speeds)


def wired(count):
    """The variables of its FMU, and where they stand."""
    points, lines = chain(count)
    system = System("chain", points, lines)
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


@pytest.mark.parametrize("of", [stepped, wired])
def test_work_grows_with_the_lines(of):
    """Four times as many lines take at most four times the work: what is there for any number only lessens it."""
    few, many = counted(of(FEW)), counted(of(TIMES * FEW))
    assert FEW < few < many <= TIMES * few
