"""What cannot be told from the data, or may be meant so, is a doubt that names the quantity; what is sound is none."""

import re

import numpy as np
import pandas as pd
import pytest

from study.replay.breaking import held_from, on, put, scaled, shifted, swapped, within, without
from study.replay.known_flight import KGF, enu, flown, full, path, written
from tetherfmu.study.replay import fitting, log
from tetherfmu.study.replay.flight import prepare

pytestmark = pytest.mark.filterwarnings("error::RuntimeWarning")  # a user would see them


POSITION, VELOCITY = "lat lon alt", "vx vy vz"
DOUBTED = {  # of the known flight: what is done, and the doubt
    "tension in N": (scaled("force", KGF), "ground_tension is 4.9 times .*; N was probably meant: check its unit"),
    "tension in kN": (scaled("force", KGF / 1e3), "ground_tension is 0.0049 times .*; kN was probably meant: check its"),
    "tension in pounds": (scaled("force", 1.0 / 0.45359237), "ground_tension is 1.1 times .*; lbf was probably meant"),
    "airspeed in km/h": (scaled("airspeed", 3.6), "airspeed is 3.6 times"),
    "wind in km/h": (scaled("wind", 3.6), "wind_velocity fits .* best times 0.3"),
    "wind in ft/s": (scaled("wind", 1.0 / 0.3048), "wind_velocity fits .* best times 0.3"),
    "wind from the wrong side": (shifted("wind_from", -180.0), "wind_velocity blows from kite_position"),
    "wind direction in radians": (on("wind_from", np.radians), "wind_from.* is it in radians"),
    "altitude 19 m too high": (shifted("alt", 19.0), "kite_position is up to 1.0.* altitude"),
    "altitude 19 m too low": (shifted("alt", -19.0), "kite_position is, while the tether is taut, only 0.9.* altitude"),
    "tension frozen": (held_from("force", range(500, 601)), "ground_tension reads .* from 50.0 to 60.0 s"),
    "length frozen": (held_from("length", range(600, 661)), "tether_length reads .* from 60.0 to 66.0 s"),
    "position frozen": (held_from(POSITION, range(500, 561)), "kite_position reads .* from 50.0 to 56.0 s"),
    "a small jump that stays": (
        within("alt", range(500, 1200), lambda c: c + 8.0),
        "kite_position jumps 1 times, first by [78].* m at 49.9 s, which kite_velocity does not explain",
    ),
    "a jump of the length": (
        within("length", range(500, 1200), lambda c: c - 4.0),
        "tether_length jumps 1 times, first by 4.* m at 49.9 s, which reel_out_speed does not explain",
    ),
    "a jump that stays": (
        within("alt", range(500, 541), lambda c: c - 60.0),
        "kite_position jumps 2 times, first by .* m at 49.[89] s",
    ),
}
UNCHECKED = "not checked.*kite_position against"
DOUBTED_ENU = {
    "tension in kgf": (scaled("ground_tension", 1.0 / KGF), "not checked.* ground_tension"),
    "tension in kN": (
        scaled("ground_tension", 1e-3),
        "the median of ground_tension is .* N, and the tether weighs 22.* N; kN was probably meant: check its unit",
    ),
    "kN, without length": (lambda t: without("tether_length")(scaled("ground_tension", 1e-3)(t)), "kN was probably meant"),
    "tension in mN": (scaled("ground_tension", 1e3), "ground_tension would stretch the tether by"),
    "length in feet, without speed": (
        lambda t: without("reel_out_speed")(scaled("tether_length", 1.0 / 0.3048)(t)),
        "kite_position is never more than 0.3",
    ),
    "no velocity": (without(VELOCITY), f"{UNCHECKED} kite_velocity"),
    "axes swapped, no velocity": (lambda t: swapped("x", "y")(without(VELOCITY)(t)), f"{UNCHECKED} kite_velocity"),
    "down for up, no velocity": (lambda t: on("z", np.negative)(without(VELOCITY)(t)), "kite_position is below the outlet"),
    "no wind": (without("wind_x"), "no wind_velocity: the tethers fly in still air"),
    "no tether": (lambda t: t, "the map does not specify the tether: the default is used, 4 mm and 9.1 g/m"),
    "no length": (without("tether_length"), f"{UNCHECKED} tether_length"),
    "speed with the wrong sign, no length": (
        lambda t: on("reel_out_speed", np.negative)(without("tether_length")(t)),
        "distance of kite_position changes by -1 m",
    ),
    "most of the wind empty": (
        lambda t: put(t, "wind_x", range(50, 1200), ""),
        "wind_velocity has readings in 50 of 1200 rows",
    ),
    "most of the tension empty": (
        lambda t: put(t, "ground_tension", range(50, 1200), ""),
        "ground_tension has readings in 50 of",
    ),
}


def test_an_unbroken_log_has_no_doubts(unbroken):
    assert unbroken.log.report.doubts == []


@pytest.mark.parametrize("kind", DOUBTED)
def test_what_may_be_wrong_is_doubted(kind, folder, own):
    done, doubt = DOUBTED[kind]
    doubts = flown(folder, done(full()), own).log.report.doubts
    assert any(re.search(doubt, each) for each in doubts), doubts


@pytest.mark.parametrize("kind", DOUBTED_ENU)
def test_what_may_be_wrong_in_a_plain_log_is_doubted(kind, folder):
    done, doubt = DOUBTED_ENU[kind]
    doubts = flown(folder, done(enu()), "enu").log.report.doubts
    assert any(re.search(doubt, each) for each in doubts), doubts


def test_a_diameter_in_millimetres_and_a_tension_in_kgf_of_a_thick_tether_are_doubted(folder):
    """The tension is 2000 N in the middle, 15 times the weight of 250 m of 10 mm; in kgf it is 1.5 times as much."""
    table = scaled("ground_tension", 1.0 / KGF)(enu())
    for diameter, doubt in ((4.0, "tether.diameter is 4.* 4 mm are 0.004"), (0.01, "; kgf was probably meant")):
        flight = prepare(log.read(written(folder, table), "enu", {"tether.diameter": diameter}))
        (said,) = flight.log.report.of_units
        assert re.search(doubt, said), said
        with pytest.raises(log.LogError, match=f"nowhere taut from .* s: nothing can be fitted; .*{doubt}"):
            fitting.fit(flight)


def test_a_slack_tether_is_not_said_to_pull_in_another_unit(folder):
    """The log says that it is longer than the way."""
    assert flown(folder, LEGITIMATE["slack"].assign(ground_tension=2.0), "enu").log.report.of_units == []


@pytest.mark.parametrize("constants", [{}, {"tether.diameter": 0.004, "tether.density": 724.0}], ids=["unsaid", "said"])
def test_the_default_tether_may_be_the_one_that_flew(constants, folder):
    doubts = prepare(log.read(written(folder, enu()), "enu", constants)).log.report.doubts
    assert any("does not specify the tether" in each for each in doubts) == (not constants)


def calm(time, position, length=None, tension=None, **more):
    """A plain log of a motion whose velocity is the difference of neighbours."""
    made = pd.DataFrame({"time": time})
    made[["x", "y", "z"]] = np.round(position, 3)
    made[["vx", "vy", "vz"]] = np.round(np.gradient(position, time, axis=0), 3)
    made["tether_length"] = length if length is not None else np.round(np.linalg.norm(position, axis=1) * 1.01, 3)
    made["reel_out_speed"] = np.round(np.gradient(made["tether_length"], time), 3)
    made["ground_tension"] = tension if tension is not None else np.round(50.0 + np.sin(time), 3)
    return made.assign(**more)


TIME = np.arange(0.0, 60.0, 0.1)
STILL, SECONDS = np.zeros_like(TIME), TIME[::10]
HOP = 20.0 + 10.0 * np.sin(np.pi / 4.0 * np.minimum(SECONDS % 20.0, 4.0)) ** 2


def way(x, y, z):
    """Positions [m] at all times, of numbers or arrays."""
    return np.stack(np.broadcast_arrays(x, y, z), axis=1)


LOOP = calm(SECONDS, way(150.0, 15.0 * np.sin(1.3 * SECONDS), 90.0 + 15.0 * np.cos(1.3 * SECONDS)))
LEGITIMATE = {
    "slack": calm(TIME, way(60.0, 10.0 * np.sin(TIME), 60.0), 120.0 + STILL),
    "very slack": calm(TIME, way(30.0, 5.0 * np.sin(TIME), 40.0), 160.0 + STILL),
    "load nearly at rest": calm(TIME, way(0.02 * np.sin(TIME), 0.0, -20.0), tension=1000.0 + np.sin(TIME)),
    "load lowered": calm(TIME, way(0.3 * np.sin(TIME), 0.0, -5.0 - 1.5 * TIME)),
    "straight up": calm(TIME, way(0.0, 0.0, 2.0 + 3.0 * TIME)),
    "straight up and down": calm(TIME, way(0.0, 0.0, 50.0 - 40.0 * np.cos(0.1 * TIME))),
    "along a line": calm(TIME, way(4.0 * TIME, 2.0 * TIME, 10.0 + 3.0 * TIME)),
    "to and fro along a line": calm(TIME, (50.0 + 30.0 * np.sin(0.3 * TIME))[:, None] * np.array([0.6, 0.0, 0.8])),
    "hovering": calm(TIME, way(0.0, 0.1 * np.sin(TIME), 80.0 + 0.05 * np.cos(2.0 * TIME)), 85.0 + STILL),
    "hovering exactly": calm(TIME, way(STILL, 0.0, 80.0), 85.0 + STILL),
    "parked": calm(TIME, way(150.0, 2.0 * np.sin(0.5 * TIME), 150.0 + np.cos(TIME)), 213.0 + STILL),
    "quick loops once a second": LOOP.assign(
        vx=0.0, vy=np.round(19.5 * np.cos(1.3 * SECONDS), 3), vz=np.round(-19.5 * np.sin(1.3 * SECONDS), 3)
    ),
    "hops once a second": calm(SECONDS, way(0.0, 0.0, HOP)),
    "load cell about zero": calm(
        TIME, way(30.0, 5.0 * np.sin(TIME), 40.0), 90.0 + STILL, np.round(2.0 * np.sin(7.0 * TIME) - 3.0, 3)
    ),
    "landing": calm(TIME, way(60.0 - 0.8 * TIME, 0.0, 70.0 - 1.1 * TIME), 100.0 - 1.3 * TIME),
}


@pytest.mark.parametrize("kind", LEGITIMATE)
def test_a_legitimate_flight_is_not_refused(kind, folder):
    table = LEGITIMATE[kind]
    found = flown(folder, table, "enu")
    assert not any("frozen" in each or "left out" in each for each in found.log.report.lines)
    position, _ = found.kite(table["time"].to_numpy()[5:-5])
    # of hops in a second; nothing was left out
    assert np.abs(position - table[["x", "y", "z"]].to_numpy()[5:-5]).max() < 10.0


@pytest.mark.parametrize("kind", ["hovering", "hovering exactly", "parked"])
def test_what_rests_is_not_called_frozen(kind, folder):
    doubts = flown(folder, LEGITIMATE[kind], "enu").log.report.doubts
    assert not any("without any change" in each for each in doubts)


NOISY = {  # noise of a position [m], every [s], drift [m]
    "good receiver": (0.05, 0.1, 0.0),
    "usual receiver": (1.0, 0.1, 3.0),
    "bad receiver": (2.5, 0.2, 3.0),
    "slow receiver": (1.5, 1.0, 3.0),
    "fast receiver": (1.0, 0.02, 3.0),
}


@pytest.mark.parametrize("receiver", NOISY)
@pytest.mark.parametrize("kind", ["still", "flying"])
def test_noise_is_no_contradiction(kind, receiver, folder):
    """White noise and a slow drift of a receiver, 0.1 m/s noise of velocities: the log is flown without a jump."""
    noise, every, drift = NOISY[receiver]
    random, time = np.random.default_rng(7), np.arange(0.0, 60.0, every)
    rest = np.tile([60.0, 0.0, 150.0], (len(time), 1))
    position, velocity = path(time) if kind == "flying" else (rest, 0.0 * rest)
    table = calm(time, position)
    wandered = position + drift * np.sin(0.05 * time)[:, None] + noise * random.normal(size=position.shape)
    table[["x", "y", "z"]] = wandered.round(2)
    table[["vx", "vy", "vz"]] = (velocity + 0.1 * random.normal(size=velocity.shape)).round(2)
    found = flown(folder, table, "enu")
    assert not any("jumps" in each or "without any change" in each for each in found.log.report.doubts)
    assert found.log.table[["kite_position[1]"]].notna().mean().item() > 0.99
