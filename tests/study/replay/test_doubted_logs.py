"""What cannot be told from the data, or may be meant so, is a doubt that names the quantity; what is sound is none."""

import re

import numpy as np
import pandas as pd
import pytest

from tests.study.replay.breaking import changed, on, put
from tests.study.replay.known_flight import AREA, KGF, WIND, enu, flown, full, motions, path, written
from tests.study.replay.test_log_formats import FORMATS
from tests.study.replay.test_mended_logs import MENDED
from tests.study.replay.test_refused_logs import REFUSED
from tetherfmu.study.replay import fitting, log
from tetherfmu.study.replay.flight import prepare

pytestmark = pytest.mark.filterwarnings("error::RuntimeWarning")  # a user would see them


# of the known flight: what is done, and the doubt
DOUBTED = {
    "tension in N": (on("force", lambda c: KGF * c), "ground_tension is 4.9 times .*; N was probably meant: check its unit"),
    "tension in kN": (
        on("force", lambda c: KGF / 1000.0 * c),
        "ground_tension is 0.0049 times .*; kN was probably meant: check its unit",
    ),
    "tension in pounds": (on("force", lambda c: c / 0.45359237), "ground_tension is 1.1 times .*; lbf was probably meant"),
    "airspeed in km/h": (on("airspeed", lambda c: 3.6 * c), "airspeed is 3.6 times"),
    "wind in km/h": (on("wind", lambda c: 3.6 * c), "wind_velocity fits .* best times 0.3"),
    "wind in ft/s": (on("wind", lambda c: c / 0.3048), "wind_velocity fits .* best times 0.3"),
    "wind from the wrong side": (on("wind_from", lambda c: c - 180.0), "wind_velocity blows from kite_position"),
    "wind direction in radians": (on("wind_from", np.radians), "wind_from.* is it in radians"),
    "altitude 19 m too high": (on("alt", lambda c: c + 19.0), "kite_position is up to 1.0.* altitude"),
    "altitude 19 m too low": (
        on("alt", lambda c: c - 19.0),
        "kite_position is, while the tether is taut, only 0.9.* altitude",
    ),
    "tension frozen": (
        on("force", lambda c: c.where((c.index < 500) | (c.index > 600), c[500])),
        "ground_tension reads .* from 50.0 to 60.0 s",
    ),
    "length frozen": (
        on("length", lambda c: c.where((c.index < 600) | (c.index > 660), c[600])),
        "tether_length reads .* from 60.0 to 66.0 s",
    ),
    "position frozen": (
        lambda t: t.assign(
            **{name: t[name].where((t.index < 500) | (t.index > 560), t[name][500]) for name in ("lat", "lon", "alt")}
        ),
        "kite_position reads .* from 50.0 to 56.0 s",
    ),
    "a small jump that stays": (
        on("alt", lambda c: c.where(c.index < 500, c + 8.0)),
        "kite_position jumps 1 times, first by [78].* m at 49.9 s, which kite_velocity does not explain",
    ),
    "a jump of the length": (
        on("length", lambda c: c.where(c.index < 500, c - 4.0)),
        "tether_length jumps 1 times, first by 4.* m at 49.9 s, which reel_out_speed does not explain",
    ),
    "a jump that stays": (
        on("alt", lambda c: c.where((c.index < 500) | (c.index > 540), c - 60.0)),
        "kite_position jumps 2 times, first by .* m at 49.[89] s",
    ),
}
DOUBTED_ENU = {
    "tension in kgf": (on("ground_tension", lambda c: c / KGF), "not checked.* ground_tension"),
    "tension in kN": (
        on("ground_tension", lambda c: c / 1e3),
        "the median of ground_tension is .* N, and the tether weighs 22.* N; kN was probably meant: check its unit",
    ),
    "tension in kN, without length": (
        lambda t: changed(t, ground_tension=lambda c: c / 1e3).drop(columns="tether_length"),
        "kN was probably meant",
    ),
    "tension in mN": (on("ground_tension", lambda c: c * 1e3), "ground_tension would stretch the tether by"),
    "length in feet, without speed": (
        lambda t: changed(t, tether_length=lambda c: c / 0.3048).drop(columns="reel_out_speed"),
        "kite_position is never more than 0.3",
    ),
    "no velocity": (lambda t: t.drop(columns=["vx", "vy", "vz"]), "not checked.*kite_position against kite_velocity"),
    "axes swapped, no velocity": (
        lambda t: t.drop(columns=["vx", "vy", "vz"]).rename(columns={"x": "y", "y": "x"}),
        "not checked.*kite_position against kite_velocity",
    ),
    "down for up, no velocity": (
        lambda t: changed(t.drop(columns=["vx", "vy", "vz"]), z=np.negative),
        "kite_position is below the outlet",
    ),
    "no wind": (lambda t: t.drop(columns="wind_x"), "no wind_velocity: the tethers fly in still air"),
    "no tether": (lambda t: t, "the map does not specify the tether: the default is used, 4 mm and 9.1 g/m"),
    "no length": (lambda t: t.drop(columns="tether_length"), "not checked.*kite_position against tether_length"),
    "speed with the wrong sign, no length": (
        lambda t: changed(t.drop(columns="tether_length"), reel_out_speed=np.negative),
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
    table = changed(enu(), ground_tension=lambda c: c / KGF)
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
STILL = np.zeros_like(TIME)
LEGITIMATE = {
    "slack": calm(TIME, np.stack([60.0 + STILL, 10.0 * np.sin(TIME), 60.0 + STILL], axis=1), 120.0 + STILL),
    "very slack": calm(TIME, np.stack([30.0 + STILL, 5.0 * np.sin(TIME), 40.0 + STILL], axis=1), 160.0 + STILL),
    "load nearly at rest": calm(
        TIME, np.stack([0.02 * np.sin(TIME), STILL, 0.0 * TIME - 20.0], axis=1), tension=1000.0 + np.sin(TIME)
    ),
    "load lowered": calm(TIME, np.stack([0.3 * np.sin(TIME), STILL, -5.0 - 1.5 * TIME], axis=1)),
    "straight up": calm(TIME, np.stack([STILL, STILL, 2.0 + 3.0 * TIME], axis=1)),
    "straight up and down": calm(TIME, np.stack([STILL, STILL, 50.0 - 40.0 * np.cos(0.1 * TIME)], axis=1)),
    "along a line": calm(TIME, np.stack([4.0 * TIME, 2.0 * TIME, 10.0 + 3.0 * TIME], axis=1)),
    "to and fro along a line": calm(TIME, (50.0 + 30.0 * np.sin(0.3 * TIME))[:, None] * np.array([0.6, 0.0, 0.8])),
    "hovering": calm(TIME, np.stack([STILL, 0.1 * np.sin(TIME), 80.0 + 0.05 * np.cos(2.0 * TIME)], axis=1), 85.0 + STILL),
    "hovering exactly": calm(TIME, np.tile([0.0, 0.0, 80.0], (len(TIME), 1)), 85.0 + STILL),
    "parked": calm(TIME, np.stack([150.0 + STILL, 2.0 * np.sin(0.5 * TIME), 150.0 + np.cos(TIME)], axis=1), 213.0 + STILL),
    "quick loops once a second": calm(
        TIME[::10],
        np.stack([150.0 + 0 * TIME[::10], 15.0 * np.sin(1.3 * TIME[::10]), 90.0 + 15.0 * np.cos(1.3 * TIME[::10])], axis=1),
    ).assign(vx=0.0, vy=np.round(19.5 * np.cos(1.3 * TIME[::10]), 3), vz=np.round(-19.5 * np.sin(1.3 * TIME[::10]), 3)),
    "hops once a second": calm(
        TIME[::10],
        np.stack(
            [0 * TIME[::10], 0 * TIME[::10], 20.0 + 10.0 * np.sin(np.pi / 4.0 * np.minimum(TIME[::10] % 20.0, 4.0)) ** 2],
            axis=1,
        ),
    ),
    "load cell about zero": calm(
        TIME,
        np.stack([30.0 + STILL, 5.0 * np.sin(TIME), 40.0 + STILL], axis=1),
        90.0 + STILL,
        tension=np.round(2.0 * np.sin(7.0 * TIME) - 3.0, 3),
    ),
    "landing": calm(TIME, np.stack([60.0 - 0.8 * TIME, STILL, 70.0 - 1.1 * TIME], axis=1), 100.0 - 1.3 * TIME),
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
    position, velocity = (
        path(time) if kind == "flying" else (np.tile([60.0, 0.0, 150.0], (len(time), 1)), np.zeros((len(time), 3)))
    )
    table = calm(time, position)
    wandered = position + drift * np.sin(0.05 * time)[:, None] + noise * random.normal(size=position.shape)
    table[["x", "y", "z"]] = wandered.round(2)
    table[["vx", "vy", "vz"]] = (velocity + 0.1 * random.normal(size=velocity.shape)).round(2)
    found = flown(folder, table, "enu")
    assert not any("jumps" in each or "without any change" in each for each in found.log.report.doubts)
    assert found.log.table[["kite_position[1]"]].notna().mean().item() > 0.99


def test_kite_and_wind_of_the_known_flight():
    """The tension of the known flight is plausible: the doubts on it are tested with a right one."""
    made = motions(np.array([0.0]))
    assert 0.0 < made["force"][0] * KGF < 3e4
    assert np.hypot(*WIND[:2]) == pytest.approx(made["wind"][0])
    assert AREA > 0.0


def test_there_are_at_least_forty_kinds():
    assert len(FORMATS) + len(MENDED) + len(REFUSED) + len(DOUBTED) >= 40
