"""Free points of systems that start in equilibrium.

at rest:                          nothing moves, and forces, weight and load add up to 0 at each free point
knot without mass:                two lines joined there are one line
on flat ground:                   a point with its half lines is carried in proportion to its depth, and friction holds it
"""

import numpy as np
import pytest

from tetherfmu import Ground, Line, Point, Solver, StepRefused, Tether, TetherSystem

G = 9.81
LINE = Tether(segments=6, initial_length=30.0)
WIND = (8.0, 1.0, 0.0)


def residuals(system, loads=()):
    """Sums of all forces on the free points [N]."""
    outputs, loads = system.outputs(), dict(loads)
    return {
        point.name: outputs.points[point.name].force + loads.get(point.name, 0.0) - np.array((0.0, 0.0, G * point.mass))
        for point in system.points
        if not point.is_driven
    }


def network(kind):
    """Points, lines and loads of a system whose free points are to be found."""
    if kind == "drones":
        corners = [(10.0, 0.0), (0.0, 10.0), (-10.0, 0.0), (0.0, -10.0)]
        drones = [Point(f"drone{k}", (*corner, 50.0)) for k, corner in enumerate(corners)]
        lines = [
            Line(f"line{k}", each.name, "load", Tether(segments=5, initial_length=20.0)) for k, each in enumerate(drones)
        ]
        return [*drones, Point("load", mass=20.0)], lines, {}
    if kind == "triangle":
        points = [Point("top", (0.0, 0.0, 60.0)), Point("left", mass=5.0), Point("right", mass=3.0)]
        ends = [("top", "left"), ("left", "right"), ("right", "top")]
        loads = {"left": (-30.0, 0.0, 0.0), "right": (30.0, 0.0, 0.0)}
        return points, [Line(f"side{k}", *pair, LINE) for k, pair in enumerate(ends)], loads
    points = [Point("ground", (0.0, 0.0, 0.0)), Point("knot", mass=2.0)]  # slack between kites and ground
    points += [Point("left", (-20.0, 0.0, 22.0)), Point("right", (20.0, 0.0, 22.0))]
    ends = [("ground", "knot"), ("knot", "left"), ("right", "knot")]
    return points, [Line(f"line{k}", *pair, LINE) for k, pair in enumerate(ends)], {}


@pytest.mark.parametrize("kind", ["drones", "triangle", "slack"])
def test_what_starts_in_equilibrium_stays_there(kind):
    points, lines, loads = network(kind)
    system = TetherSystem(points, lines)
    system.initialize(WIND, loads=loads)
    for residual in residuals(system, loads).values():
        np.testing.assert_allclose(residual, 0.0, atol=1e-6)  # 1e-9 of some 200 N
    before = system.positions
    system.fly(50, 0.02, every=0)
    for name, each in system.positions.items():
        np.testing.assert_allclose(each, before[name], rtol=0, atol=1e-6)  # the residual over slopes of 1 N/m
    assert system.counters["rejections"] == 0


def test_a_knot_without_mass_is_no_knot():
    top, end = Point("top", (0.0, 0.0, 50.0)), Point("end", (30.0, 10.0, 20.0))
    # soft: a line counts as at rest within the rounding errors of its springs, 1e-15 of EA, over some 1 N/m across
    half, whole = (Tether(segments=each, initial_length=5.0 * each, axial_stiffness=1e4) for each in (6, 12))
    halves = [Line("a", "top", "knot", half), Line("b", "knot", "end", half)]
    knotted = TetherSystem([top, Point("knot", mass=0.0), end], halves)
    single = TetherSystem([top, end], [Line("line", "top", "end", whole)])
    knotted.initialize(WIND)
    single.initialize(WIND)
    found = np.concatenate([knotted.positions["a"], knotted.positions["b"][1:]])
    np.testing.assert_allclose(found, single.positions["line"], rtol=0, atol=1e-9)


def test_a_point_lies_on_the_ground():
    points = [Point("post", (0.0, 0.0, 4.0)), Point("stone", (2.0, 0.0, 0.0), mass=3.0)]
    ground = Ground(ground_contact="flat", ground_height=-1.0)
    system = TetherSystem(points, [Line("line", "post", "stone", LINE)], ground=ground)
    force = system.initialize(positions={"stone": None}).points["stone"].force
    below = system.positions["line"][-1, 2] - ground.ground_height
    half_segment = 0.5 * LINE.mass_per_length * 5.0
    carried = (3.0 + half_segment) * G * -below / ground.ground_sink
    assert carried == pytest.approx(3.0 * G - force[2], rel=1e-9)
    assert np.hypot(*force[:2]) <= ground.ground_friction * carried


def test_other_starts_are_refused_in_words():
    pair = [Point("a", mass=1.0), Point("b", mass=1.0)]
    with pytest.raises(StepRefused, match="no point of the system is driven"):
        TetherSystem(pair, [Line("line", "a", "b", LINE)]).initialize()
    driven = TetherSystem([Point("a", (0.0, 0.0, 0.0)), pair[1]], [Line("line", "a", "b", LINE)])
    with pytest.raises(ValueError, match="a is not a free point: give its position"):
        driven.initialize(positions={"a": None})
    with pytest.raises(StepRefused, match=r"the input a\.position\[2\] is nan"):
        driven.initialize(positions={"a": (0.0, np.nan, 0.0)})
    elastic = Tether(segments=4, initial_length=30.0, axial_stiffness=1.0)
    torn = TetherSystem(driven.points, [Line("line", "a", "b", elastic)])
    with pytest.raises(StepRefused, match="no equilibrium was found for the free point b; check"):
        torn.initialize((100.0, 0.0, 0.0))  # its drag grows as its length, which stretches it without end


def test_lines_keep_their_own_shape_at_the_start():
    points, lines, _ = network("drones")
    system = TetherSystem(points, lines, solver=Solver(initial_shape="straight"))
    system.initialize(WIND)
    shape = system.positions["line0"]
    np.testing.assert_allclose(np.diff(shape, 2, axis=0), 0.0, atol=1e-12)
