"""A flight of a CSV file: any duration, its own length, ends without velocities, noise, ends that are too far apart."""

import numpy as np
import pytest

from study.scenes_of_tests import SCENE, SERIES, swaying, write_series, written
from tetherfmu.files.scene_files import load
from tetherfmu.runtime import layout as at
from tetherfmu.study.advice.scene_advice import FAST_BUDGET, advise, explain
from tetherfmu.study.advice.scene_build import advised
from tetherfmu.study.measuring.runs import Config, parameters_of, run

WITHOUT_LENGTH = SERIES.replace('initial_length = "505 m"', "")
DRUM = "\n[winch]\nmass = 2000.0\ndamping = 50.0\n"
DUE = 0.1  # time between rows [s]


def velocity(time):
    return swaying(time)[1]


def scene_of(folder, duration=20.0, scatter=0.0, smooth=lambda column: column, text=SERIES, **columns):
    """Path of a scene file beside the CSV file of its flight; columns : of vectors or numbers, functions of time."""
    time = np.arange(0.0, duration + 0.5 * DUE, DUE)
    noise = scatter * np.random.default_rng(3).normal(size=(len(time), 3))
    positions = np.apply_along_axis(smooth, 0, swaying(time)[0] + noise)
    others = {name: column(time) for name, column in columns.items()}
    write_series(folder / "flight.csv", time, {"kite_position": positions, **others})
    return written(folder, text.replace('"2 s"', f"{duration}"))


def test_an_hour(tmp_path):
    """All of it is flown, and advised within the budget of a second."""
    scene = load(scene_of(tmp_path, 3600.0))
    assert scene.duration == 3600.0
    flown = run(scene, Config("straight", 0, 0.0, 0.02)).flown
    assert len(flown.kite_force) == 36_000
    np.testing.assert_allclose(flown.of("ground_azimuth")[-1], 0.1 * (1.0 - np.cos(0.3 * 3600.0)), atol=0.05)
    assert advise(scene, FAST_BUDGET).finer.spent < 60.0


def test_the_length_may_come_from_the_series(tmp_path):
    scene = load(scene_of(tmp_path, text=WITHOUT_LENGTH, tether_length=lambda time: 507.5 + 0.1 * time))
    assert scene.tether.initial_length == 507.5
    np.testing.assert_allclose(scene.flight.motion(np.array([20.0])).reeled, 2.0)


def test_without_it_the_length_is_missing(tmp_path):
    with pytest.raises(ValueError, match=r"the key tether\.initial_length is missing"):
        load(scene_of(tmp_path, text=WITHOUT_LENGTH))


KITE, GROUND = {"kite_velocity": velocity}, {"ground_position": lambda time: 0.01 * swaying(time)[0]}
BOTH = {**KITE, **GROUND, "ground_velocity": lambda time: 0.01 * velocity(time)}


@pytest.mark.parametrize(
    ("columns", "expected"),
    [({}, at.DERIVED), (KITE, at.GIVEN), (KITE | GROUND, at.DERIVED), (BOTH, at.GIVEN)],
    ids=["none", "kite", "kite only", "both"],
)
def test_velocities_that_are_not_there_are_derived(tmp_path, columns, expected):
    """In the FMU that is built for the scene, and in the flights that its advice is measured with."""
    scene_file = scene_of(tmp_path, 3.0, **columns)
    _, _, _, options = advised(scene_file, 0, ("x86_64-linux",))
    assert dict(options.lean.starts)["end_velocities"] == expected
    scene, config = load(scene_file), Config("dynamic", 6, 1e-4, 0.02)
    assert parameters_of(scene, config)["end_velocities"] == expected
    as_advised = run(scene, config).flown.kite_force
    scene.flight.has_velocities = expected == at.DERIVED  # the other way
    assert not np.array_equal(run(scene, config).flown.kite_force, as_advised)


@pytest.mark.parametrize("name", ["tether_length", "winch_length"])
def test_a_length_leads_the_winch(tmp_path, name):
    """The advised FMU is told the length, and FMPy hands it the column that has the name of the input."""
    told = {name: lambda time: 507.5 + 0.4 * np.sin(time)}
    scene_file = scene_of(tmp_path, 3.0, text=WITHOUT_LENGTH, **told)
    _, _, _, options = advised(scene_file, 0, ("x86_64-linux",))
    starts = dict(options.lean.starts)
    assert (starts["winch_control"], starts["initial_length"]) == (at.WINCH_BY_LENGTH, 507.5)
    scene, config = load(scene_file), Config("dynamic", 6, 1e-4, 0.02)
    lengths = run(scene, config).flown.of("tether_length")
    times = scene.every * np.arange(1, len(lengths) + 1)
    np.testing.assert_allclose(lengths, 507.5 + 0.4 * np.sin(times), rtol=0, atol=2e-3)  # of the spline between the rows
    led_by_speed = run(scene, config, exact=True).flown.of("tether_length")
    np.testing.assert_allclose(lengths, led_by_speed, rtol=0, atol=2e-4)  # the curvature of the spline jumps at the rows


@pytest.mark.parametrize("name", ["ground_tension", "winch_force"])
def test_a_tension_leads_the_winch(tmp_path, name):
    """The advised FMU is told the force; the tension of the flight is that of the log, and the length follows."""
    scene_file = scene_of(tmp_path, 3.0, **{name: lambda time: 400.0 + 30.0 * np.sin(time)})
    _, _, _, options = advised(scene_file, 0, ("x86_64-linux",))
    assert dict(options.lean.starts)["winch_control"] == at.WINCH_BY_FORCE
    scene = load(scene_file)
    for variant in ("dynamic", "catenary"):
        tensions = run(scene, Config(variant, 6, 1e-4, 0.02)).flown.of("ground_tension")
        times = scene.every * np.arange(1, len(tensions) + 1)
        # within a step of h the force goes on linearly, h^2 30 N/s2; and the curve between the rows is not the sine
        np.testing.assert_allclose(tensions, 400.0 + 30.0 * np.sin(times), rtol=0, atol=0.02**2 * 30.0 + 0.05)


def test_a_drum_turns_as_its_forces_say(tmp_path):
    """m (u - u0) = int (T - W) dt - c (L - L0), with the drum of the table [winch], which the advised tether has, too."""
    scene = load(scene_of(tmp_path, 5.0, text=SERIES + DRUM, winch_force=lambda time: 400.0 + 100.0 * np.sin(time)))
    config = Config("catenary", 0, 0.0, 0.02)
    drum = {"winch_control": 2, "winch_mass": 2000.0, "winch_damping": 50.0}
    assert drum.items() <= parameters_of(scene, config).items()
    flown = run(scene, config).flown
    speed, length = flown.of("winch_speed"), flown.of("tether_length")
    excess = flown.of("ground_tension") - 400.0 - 100.0 * np.sin(scene.times[1:])
    impulse = scene.every * np.cumsum(0.5 * (excess[1:] + excess[:-1])) - 50.0 * (length[1:] - length[0])
    assert np.ptp(speed) > 0.1
    # the trapezoidal rule: h^2/12 times the change of the rate of the tension, some 100 N/s; the curve between the rows
    np.testing.assert_allclose(2000.0 * (speed[1:] - speed[0]), impulse, rtol=0, atol=0.5)


def test_a_force_without_a_length_starts_in_balance(tmp_path):
    """The length is the one at which the tether pulls with the first force, so nothing jerks."""
    scene = load(scene_of(tmp_path, 5.0, text=WITHOUT_LENGTH, winch_force=lambda time: 400.0 + 0.0 * time))
    config = Config("quasi_steady", 10, 0.0, 0.02)
    assert parameters_of(scene, config)["winch_start"] == 2
    flown = run(scene, config).flown
    np.testing.assert_allclose(flown.of("ground_tension"), 400.0, rtol=1e-6)
    assert np.abs(np.diff(flown.of("tether_length"))).max() < 0.2  # as the kite flies; 5 m too long it was 5 m at once
    with pytest.raises(ValueError, match=r"tether\.initial_length"):
        load(scene_of(tmp_path, text=WITHOUT_LENGTH))


def test_a_drum_needs_a_force(tmp_path):
    with pytest.raises(ValueError, match=r"a drum needs winch\.force, or a series with a column winch_force"):
        load(scene_of(tmp_path, text=SERIES + DRUM))


def averaged(column):
    """A cubic through 21 rows, 2 s, in their middle (Savitzky and Golay 1964); the ends by what is there of it."""
    from scipy.signal import savgol_filter

    return savgol_filter(column, 21, 3)


def test_noise_is_named(tmp_path):
    """2 cm at 10 Hz: second differences of errors scatter by sqrt(6) times as much, 4.9 m/s2; smoothing cures it."""
    scene = load(scene_of(tmp_path, 30.0, scatter=0.02))
    assert scene.flight.scatter == pytest.approx(0.02, rel=0.1)
    assert scene.flight.shaking == pytest.approx(np.sqrt(6.0) * 0.02 / DUE**2, rel=0.1)
    told = explain(scene, advise(scene, FAST_BUDGET))
    assert "No configuration is known" in told
    assert "noise is the likely cause: the positions of the series scatter by about 0.02 m from row to row" in told
    assert "scipy.signal.savgol_filter(column, n, 3)" in told
    smooth = load(scene_of(tmp_path, 30.0, scatter=0.02, smooth=averaged))
    assert smooth.flight.shaking < 0.5
    advice = advise(smooth, FAST_BUDGET)
    assert advice.met
    assert "noise" not in explain(smooth, advice)


@pytest.mark.parametrize("digits", [3, 12])
def test_a_clean_path_has_no_noise_to_speak_of(tmp_path, digits):
    """Nor one that is rounded to millimetres."""
    scene = load(scene_of(tmp_path, 30.0, smooth=lambda column: np.round(column, digits)))
    assert scene.flight.shaking < 0.1


def test_a_diameter_in_millimetres_is_told_first(tmp_path, capsys):
    scene_file = written(tmp_path, SCENE.replace("[tether]", "[tether]\ndiameter = 4"))
    load(scene_file)
    said = "tether.diameter is 4 m, more than 0.2 m; diameters are in m: 4 mm are 0.004"
    assert capsys.readouterr().err == f"{scene_file}: {said}\n"


@pytest.mark.parametrize(
    ("length", "says"),
    [("50 m", "s, the tether is 50 m long: stretched by 900 %, where any rope is broken; check"), ("477 m", None)],
)
def test_a_tether_that_is_far_too_short_is_told_first(tmp_path, capsys, length, says):
    scene_file = scene_of(tmp_path, text=SERIES.replace("505 m", length))
    load(scene_file)
    told = capsys.readouterr().err
    if says is None:
        assert told == ""
    else:
        assert told.startswith(f"{scene_file}: the ends are 500 m apart at ")
        assert says in told
        assert "tether.initial_length, and the unit m of the positions" in told
        assert len(told.splitlines()) == 1
