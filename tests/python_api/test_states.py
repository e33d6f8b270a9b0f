"""A state is whole: another object, a copy and one from a pickle continue with the same numbers. Others are refused."""

import contextlib
import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest

from balance import VARIANTS
from over_sheaves import Atwood, rope
from scenes import same
from solvers import ADAPTIVE, fixed
from tetherfmu import (
    Environment,
    Line,
    Point,
    SharedWinch,
    StepRefused,
    Tether,
    TetherDynamic,
    TetherDynamicFree,
    TetherSystem,
)
from tetherfmu.python import models
from tetherfmu.runtime import layout as at

WIND, KITE = (8.0, 1.0, 0.0), (300.0, 0.0, 401.0)
EVERY = (*VARIANTS, "TetherDynamicFree")
WAYS = {
    "set_state": lambda tether: given_to(type(tether)(), tether),
    "deepcopy": copy.deepcopy,
    "copy": copy.copy,
    "pickle": lambda tether: pickle.loads(pickle.dumps(tether)),
}
every_variant = pytest.mark.parametrize("variant", EVERY)


def given_to(other, tether):
    other.set_state(tether.get_state())
    return other


def flying(variant="TetherDynamic", **options):
    """A tether away from its start, in wind, with a winch that runs."""
    tether = getattr(models, variant)(**options)
    tether.initialize(wind_velocity=WIND)
    moved = {} if variant == "TetherDynamicFree" else {"kite_position": KITE}
    tether.step(0.02, reel_out_speed=0.5, **moved)
    return tether


@every_variant
@pytest.mark.parametrize("way", WAYS)
def test_another_object_continues_without_any_input(variant, way):
    """69 N without wind, or the kite at the start values of the inputs, was 24 kN."""
    tether = flying(variant)
    other = WAYS[way](tether)
    assert same(other.outputs(), tether.outputs())
    assert other.positions.shape == tether.positions.shape == (tether.segments + 1, 3) == (other.segments + 1, 3)
    for _ in range(3):
        assert same(other.step(0.02), tether.step(0.02))
    other.step(0.02, wind_velocity=(0.0, 0.0, 0.0))
    before = tether.get_state()
    assert not np.array_equal(before, other.get_state())
    tether.step(0.02)  # it is on its own
    assert not np.array_equal(before, tether.get_state())


@pytest.mark.parametrize("way", ["deepcopy", "copy", "pickle"])
def test_a_copy_has_all_that_the_tether_was_made_with(way):
    series = [Tether(segments=3, initial_length=200.0), Tether(segments=4, initial_length=305.0, diameter=0.006)]
    options = {"point_masses": {3: 2.0}, "shape_points": 5, "free_ends": (False, True)}
    tether = TetherDynamic(series, Environment(wind_profile="power_law"), **options)
    fresh, running = WAYS[way](tether), tether
    with pytest.raises(StepRefused, match="is not initialized"):
        fresh.step(0.02)
    assert same(fresh.initialize(wind_velocity=WIND), running.initialize(wind_velocity=WIND))
    copied = WAYS[way](running)
    load = {"kite_load": (50.0, 0.0, 300.0), "wind_velocity": (9.0, 0.0, 0.0)}
    assert same(copied.step(0.02, **load), running.step(0.02, **load))


@pytest.mark.parametrize("way", WAYS)
def test_wind_at_the_nodes_is_in_the_state(way):
    tether = flying()
    tether.step(0.02, wind_velocity=np.linspace(0.0, 12.0, 63).reshape(21, 3))
    other = WAYS[way](tether)
    assert same(other.step(0.02), tether.step(0.02))


def test_the_environment_is_that_of_the_object():
    """Also after a wind at the nodes, which a state without one ends."""
    tether, blown, other = flying(), *(flying(environment=Environment(wind_profile="power_law")) for _ in range(2))
    blown.step(0.02, wind_velocity=np.ones((21, 3)))
    for each in (blown, other):
        each.set_state(tether.get_state())
    expected = other.step(0.02)
    assert same(blown.step(0.02), expected)
    assert not same(tether.step(0.02), expected)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (
            {"diameter": 0.005, "axial_stiffness": 614600.0, "axial_damping": 473.0},
            r"mass per length \[kg/m\] is 0\.00909\d*, that of this one 0\.0142",
        ),
        ({"density": 900.0}, "mass per length"),
        ({"initial_length": 506.0}, "initial_length is 505, that of this one 506"),
        ({"axial_stiffness": 1e6}, r"axial_stiffness \[N\] is 614600, that of this one 1e\+06"),
        ({"axial_damping": 1.0}, r"axial_damping \[N s\] is 473"),
        ({"drag_coefficient": 1.1}, "drag_coefficient times diameter"),
        ({"slack_stiffness_ratio": 0.5}, "slack_stiffness_ratio is 0.01"),
        ({"damping_law": 2}, "damping_law is 1, that of this one 2"),
        ({"point_masses": {4: 3.0}}, r"point mass \[kg\] at node 4 is 0, that of this one 3"),
        ({"free_ends": (False, True)}, "kite_is_free is 0, that of this one 1"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_a_state_of_another_tether_is_refused_and_nothing_is_changed(change, says):
    other = TetherDynamic(**change)
    other.initialize()
    before = other.get_state()
    with pytest.raises(ValueError, match=says):
        other.set_state(flying().get_state())
    np.testing.assert_array_equal(other.get_state(), before)


def test_a_state_of_another_kind_is_refused():
    with pytest.raises(ValueError, match="another kind of tether: catenary, not straight"):
        models.TetherStraight().set_state(flying("TetherCatenary").get_state())
    with pytest.raises(ValueError, match=r"its point mass \[kg\] at node 20 is 10, that of this one 3"):
        TetherDynamicFree(kite_mass=3.0).set_state(flying("TetherDynamicFree").get_state())


@pytest.mark.parametrize("number", [np.nan, np.inf, -1.0, 1e9])
def test_impossible_numbers_of_a_state_are_refused(number):
    tether = flying()
    state = tether.get_state()
    state[at.state_size(20) + at.INPUTS] = number  # the number of the variant
    with pytest.raises(ValueError, match="state contains impossible numbers"):
        tether.set_state(state)


def test_there_is_no_state_before_the_start():
    with pytest.raises(StepRefused, match="this TetherDynamic is not initialized: call initialize first"):
        TetherDynamic().get_state()


def test_kernels_of_its_own_are_shared_by_copies_and_refused_by_pickle():
    tether = TetherDynamic(kernels=TetherDynamic()._instance.kernels)
    tether.initialize()
    assert copy.deepcopy(tether)._instance.kernels is tether._instance.kernels
    with pytest.raises(pickle.PicklingError, match="this TetherDynamic was made with its own kernels"):
        pickle.dumps(tether)


@pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")  # any number that a state may hold
@every_variant
@pytest.mark.parametrize("value", [np.nan, np.inf, -1.0, 1e300])
def test_a_state_with_any_number_replaced_is_refused_or_harmless(variant, value):
    """Refused: nothing is changed. Taken: the outputs are finite, and a step is done or refused in words."""
    tether = flying(variant, segments=3)
    good = tether.get_state()
    for place in range(len(good)):
        state = good.copy()
        state[place] = value
        try:
            tether.set_state(state)
        except ValueError:
            np.testing.assert_array_equal(tether.get_state(), good)
            continue
        assert all(np.isfinite(each).all() for each in tether.outputs())
        with contextlib.suppress(StepRefused):
            tether.step(0.02)
        assert all(np.isfinite(each).all() for each in tether.outputs())
        tether.set_state(good)


# --- systems


WINDS = np.array([[4.0, 1.0, 0.0], [9.0, -2.0, 0.5], [12.0, 1.5, 0.0]])
POINTS = [Point("left", (0.0, 0.0, 30.0)), Point("right", (8.0, 0.0, 30.0)), Point("load", (4.0, 0.0, 10.2), mass=20.0)]
ROPE = Tether(segments=4, initial_length=20.4)


def started(wind_points):
    lines = [Line("a", "left", "load", ROPE), Line("b", "right", "load", ROPE)]
    system = TetherSystem(POINTS, lines, wind_points=wind_points)
    system.initialize(**winds(wind_points, 0))
    return system


def winds(wind_points, k):
    scale = 1.0 + 0.1 * k
    return {"wind_at": dict.fromkeys("ab", scale * WINDS)} if wind_points else {"wind_velocity": scale * WINDS[1]}


def flown(system, wind_points, steps=range(5, 10)):
    return [system.step(0.02, **winds(wind_points, k)).points["load"].position.tolist() for k in steps]


@pytest.mark.parametrize("wind_points", [0, 3])
@pytest.mark.parametrize("way", ["deepcopy", "copy", "pickle"])
def test_a_copy_of_a_system_goes_on(way, wind_points):
    system = started(wind_points)
    flown(system, wind_points, range(5))
    other = WAYS[way](system)
    assert other.counters == system.counters
    assert flown(other, wind_points) == flown(system, wind_points)


@pytest.mark.parametrize("wind_points", [0, 3])
def test_back_to_a_state_with_other_winds(wind_points):
    system = started(wind_points)
    flown(system, wind_points, range(5))
    state = system.get_state()
    expected = flown(system, wind_points)
    system.set_state(state)
    assert flown(system, wind_points) == expected
    other = started(wind_points)
    other.set_state(state)
    assert flown(other, wind_points) == expected


def test_a_system_that_was_not_started_is_copied():
    system = TetherSystem(POINTS, [Line("a", "left", "load", ROPE), Line("b", "right", "load", ROPE)])
    assert "not initialized" in repr(copy.deepcopy(system))


# --- what is left in the workspace


SOLVERS = [ADAPTIVE, fixed(0.01, "second_order"), fixed(0.01, "backward_euler")]


def whipped(solver):
    """A tether in wind, of which the kite end is driven aside."""
    model = TetherDynamic(Tether(segments=5), solver=solver)
    model.initialize(wind_velocity=(8.0, 1.0, 0.0))
    return model, {"kite_velocity": (1.0, 2.0, 0.0), "reel_out_speed": 0.5}


def atwood(solver):
    return Atwood(5.0).system(solver), {}


def broken(solver):
    """Two drums that hold three loads; the line of one breaks, and the others slow the drums down and turn them round."""
    places = {"b": (2.0, 60.0), "a": (0.0, 20.0), "c": (-2.0, 40.0)}
    points = [Point("top", (0.0, 0.0, 0.0)), *(Point(name, (x, 0.0, -10.0), mass=m) for name, (x, m) in places.items())]
    lines = [Line(f"to_{name}", "top", name, rope(10.2 if name != "a" else 10.0, 3)) for name in places]
    lines[0] = replace(lines[0], tether=replace(lines[0].tether, breaking_force=300.0))
    held = ((2.0, -1.0, -1.0), (0.5, -1.0, 0.5))
    ratios = [{line.name: ratio for line, ratio in zip(lines, each, strict=True)} for each in held]
    drums = [SharedWinch(f"drum{k}", each, "force", winch_mass=5.0, winch_friction=40.0) for k, each in enumerate(ratios)]
    system = TetherSystem(points, lines, solver=solver, winches=drums)
    system.initialize()
    return system, {}


@pytest.mark.filterwarnings("ignore::tetherfmu.PlausibilityWarning")  # broken ropes, in steps of all kinds
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("scene", [whipped, atwood, broken])
def test_what_is_left_in_the_workspace_has_no_effect(scene, solver):
    """A step depends on nothing but the state, the inputs and the parameters; also after one in which numbers overflowed."""
    system, given = scene(solver)
    for _ in range(60):
        before, found = system.get_state(), []
        for left in (0.0, 7.0, np.nan):
            system.set_state(before)
            np.frombuffer(system._instance.work)[:] = left
            system.step(0.02, **given)
            found.append(system.get_state())
        assert np.array_equal(found[0], found[1])
        assert np.array_equal(found[0], found[2])
    if scene is broken:
        assert system.outputs().lines["to_b"].broken
