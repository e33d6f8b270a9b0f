"""FMUs of tethers in all flavours against the Python API: a table of flights, all outputs to the last bit, states too."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import pytest

import tetherfmu
from flavours import NEXT, check_flight, every_flavour, folder_of
from isolation import in_shared_process
from runtime.host import STEP, Host
from scenes import circle, kite_at_start, kite_inputs
from tetherfmu.export.archive import SLAVES

STEPS, HALF = 20, 10
FREE = "TetherDynamicFree"
WITH_WAVES = ("TetherDynamic", FREE)  # which take steps of their own


class Flight(NamedTuple):
    """A flight, its inputs and parameters by the names of an FMU; name : of the tether."""

    parameters: dict
    given: Callable  # inputs of step k, of (name, k)
    start: Callable  # inputs and the motion of the kite at the start, of (name,)
    seen: Callable = lambda name, rows: None  # asserts that what the flight is about does happen; rows : of all outputs
    tethers: tuple = tuple(SLAVES)
    wind_points: int = 0


# --- the flights


def on_the_circle(winch_force=False):
    """Inputs of step k, of (name, k): a kite on the circle, a winch that pulls by a third more and less, or swings."""

    def given(name, k):
        winch = {"winch_force": 400.0 + 130.0 * math.sin(0.6 * k)} if winch_force else {"reel_out_speed": 0.5 * math.sin(k)}
        return kite_inputs(name, *circle(k * STEP)) | winch

    return given


def from_the_circle(**more):
    return lambda name: kite_at_start(name, *circle(0.0)) | more


def by_force(**winch):
    start = from_the_circle(wind_velocity=(5.0, 1.0, 0.0), reel_out_speed=0.3)
    parameters = {"initial_length": 500.0, "winch_control": 2, "relative_tolerance": 1e-5, **winch}
    return Flight(parameters, on_the_circle(winch_force=True), start, seen=winch_turns)


def winch_turns(name, rows):
    assert rows[-1]["tether_length"][0] != 500.0


def stops(name, rows):
    lengths = [row["tether_length"][0] for row in rows]
    assert min(lengths) == pytest.approx(499.98, abs=1e-9) or max(lengths) == pytest.approx(500.02, abs=1e-9)


def landing(k):
    """A kite that comes down and drags: position [m] and velocity [m/s]."""
    time = k * STEP
    return np.array((45.0 + 2.0 * time, time, 12.0 - 4.0 * time)), np.array((2.0, 1.0, -4.0))


def on_the_ground(tethers=tuple(SLAVES)[1:], **ground):
    """It lies there, but for the straight tether, which ignores the ground; a winch may pull it off at once."""
    held = "winch_control" in ground

    def start(name):
        return kite_at_start(name, *landing(0)) | ({"winch_force": 30.0} if held else {})

    def lies(name, rows):
        length = max(row["grounded_length"][0] for row in rows)
        assert length == 0.0 if name == "TetherStraight" else held or length > 5.0

    parameters = {"initial_length": 60.0, "segments": 10, "ground_contact": 2, "relative_tolerance": 1e-5, **ground}
    return Flight(parameters, lambda name, k: kite_inputs(name, *landing(k)), start, lies, tethers)


def flies_away(name, k):
    return {"kite_position": (300.0, 0.0, 400.0 + 0.1 * k), "kite_velocity": (0.0, 0.0, 5.0)}


def gets_loose(name, rows):
    assert not rows[0]["broken"][0]
    assert rows[-1]["broken"][0]
    assert rows[-1]["break_time"][0] > 0.0


def loose(given=flies_away, **parameters):
    """A dynamic tether that breaks, or lets its kite go."""
    parameters = {"initial_length": 500.5, **parameters}
    return Flight(parameters, given, lambda name: flies_away(name, 0), gets_loose, ("TetherDynamic",))


WIND = np.array([[4.0, 1.0, 0.0], [9.0, -2.0, 0.5], [12.0, 1.5, 0.0]])  # at three points [m/s]


def wind_at_points(name, k):
    return kite_inputs(name, *circle(k * STEP)) | {"wind_at": (WIND * (1.0 + 0.02 * k)).ravel()}


CIRCLE = Flight(
    {"initial_length": 525.0, "relative_tolerance": 1e-5}, on_the_circle(), from_the_circle(wind_velocity=(5.0, 1.0, 0.0))
)
DRUM = {"winch_mass": 50.0, "winch_damping": 20.0, "winch_friction": 30.0}
CRANE = {"ground_position": (1.0, 2.0, 50.0), "wind_velocity": (15.0, 3.0, 0.0), "kite_load": (200.0, 0.0, 100.0)}
CRANE |= {"initial_kite_position": (1.0, 2.0, 10.0), "initial_kite_velocity": (1.0, 2.0, 3.0)}
FLIGHTS = {
    "circle": CIRCLE,
    "fixed steps": CIRCLE._replace(parameters={"initial_length": 525.0, "fixed_step": 0.005}, tethers=WITH_WAVES),
    "winch without a drum": by_force(),
    "its friction": by_force(winch_friction=30.0),
    "drum": by_force(**DRUM),
    "drum that stops": by_force(**DRUM, shortest_length=499.98, longest_length=500.02)._replace(seen=stops),
    "winch in fixed steps": by_force(fixed_step=0.005),
    "winch by length": Flight(
        {"initial_length": 525.0, "winch_control": 3},
        lambda name, k: kite_inputs(name, *circle(k * STEP)) | {"winch_length": 525.0 + 0.1 * math.sin(0.3 * k)},
        from_the_circle(winch_length=525.0, reel_out_speed=1.5),
    ),
    "drum in fixed steps": by_force(**DRUM, fixed_step=0.005),
    "ground": on_the_ground(tuple(SLAVES)),
    "soft ground without friction": on_the_ground(ground_friction=0.0, ground_sink=0.02),
    "ground below the station": on_the_ground(ground_height=-4.0),
    "ground in fixed steps": on_the_ground(WITH_WAVES, fixed_step=0.005),
    "ground, and a winch that holds 30 N": on_the_ground(winch_control=2),
    "break": loose(breaking_force=1500.0),
    "break in fixed steps": loose(breaking_force=1500.0, fixed_step=0.005),
    "stiff": CIRCLE._replace(  # positions alone cannot hold the strain
        parameters={"initial_length": 499.9, "axial_stiffness": 1e12}, tethers=("TetherCatenary", "TetherQuasiSteady")
    ),
    "release": loose(given=lambda name, k: {"release": k == 12, **flies_away(name, k)}),
    "released kite": Flight({}, lambda name, k: {"release": k >= 5}, lambda name: {}, gets_loose, (FREE,)),
    "kite that starts in equilibrium": Flight(
        {"initial_length": 40.0, "segments": 8, "kite_mass": 300.0, "kite_start": 2},
        lambda name, k: {"reel_out_speed": 0.1 * k},
        lambda name: CRANE,
        lambda name, rows: np.testing.assert_array_equal(rows[0]["kite_velocity"], 0.0),
        (FREE,),
    ),
    "wind at points": Flight(
        {"initial_length": 525.0},
        wind_at_points,
        lambda name: {**kite_at_start(name, *circle(0.0)), "wind_at": WIND.ravel()},
        tethers=("TetherStraight", FREE),
        wind_points=len(WIND),
    ),
}


# --- both sides, by the names of the FMU


def of_python(inputs):
    """Inputs as arguments of a tether of the Python API."""
    named = {name.removeprefix("initial_"): value for name, value in inputs.items()}
    return named | ({"wind_at": np.reshape(named["wind_at"], (-1, 3))} if "wind_at" in named else {})


def flat(outputs):
    return {name: np.ravel(value).tolist() for name, value in outputs.items()}


def flown_in_python(name, flight):
    """All outputs at the start and after each step, dicts of flat lists; and what was said of them."""
    made = {"shape_points": 21, "wind_points": flight.wind_points, **flight.parameters}  # 21 points as FMUs have
    tether = getattr(tetherfmu, name)(**made)
    rows = [tether.initialize(**of_python(flight.start(name)))]
    rows += [tether.step(STEP, **of_python(flight.given(name, k))) for k in range(STEPS)]
    return [flat(row._asdict()) for row in rows], tether.implausible


def assert_same(host, expected):
    """To the last bit; a tether whose end is driven does not show its motion."""
    found = flat(host.outputs())
    assert found.keys() <= expected.keys() | {"time"}
    assert found == {name: expected[name] for name in found}


@pytest.fixture(scope="session")
def built(built_once, windy):
    """Function of a number of wind points and a flavour: folder with all FMUs."""
    return lambda points, flavour: windy / flavour if points else folder_of(built_once, flavour)


@every_flavour
@pytest.mark.parametrize(("flight", "name"), [(flight, name) for flight, each in FLIGHTS.items() for name in each.tethers])
def test_flight_of_the_python_api(built, flight, name, flavour):
    path, other = (built(FLIGHTS[flight].wind_points, each) / f"{name}.fmu" for each in (flavour, NEXT[flavour]))
    check(path=path, other=other, flight=flight)


@in_shared_process
def check(path, other, flight):
    flight, host = FLIGHTS[flight], Host(path)
    rows, sentences = flown_in_python(host.name, flight)
    flight.seen(host.name, rows)
    check_flight(
        host,
        other,
        rows,
        sentences,
        HALF,
        start=lambda host: host.start(**flight.parameters, **flight.start(host.name)),
        step=lambda host, k: host.step(STEP, **flight.given(host.name, k)),
        assert_same=assert_same,
    )
