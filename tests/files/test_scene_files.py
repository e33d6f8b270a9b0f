"""Scene files: numbers with units, and one clear line with exit status 2 for each mistake."""

import os
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from study.scenes_of_tests import SCENE, SERIES, write_series, written
from tetherfmu.__main__ import main
from tetherfmu.files.named import named_systems
from tetherfmu.files.scene_files import load, load_for_advice
from tetherfmu.files.toml_files import WrongUse, contents_of
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.parameters import Ground, Tether
from tetherfmu.study.measuring.runs import Config, parameters_of

HEAD = "time,kite_position[1],kite_position[2],kite_position[3]\n"
WRONG = {
    "missing key": ("allowed_error.*", "", "the key wanted.allowed_error is missing"),
    "unknown key": ("rate =", "rte =", "unknown key flight.rte"),
    "wrong unit": ("505 m", "505 kg", "tether.initial_length is '505 kg'; it must be a number with one of the units m"),
    "not a number": ('"505 m"', "nan", "tether.initial_length is nan; it must be at least 0.01 m"),
    "out of range": ('"3 %"', "7", "wanted.allowed_error is 7; it must be at least 0.0001 and at most 0.5"),
    "NaN in a vector": (r"\[8.0", "[nan", "wind.velocity is [nan, 0.0, 0.0]; each must be a finite number"),
    "unknown flight": ("circle", "spiral", "flight.kind is 'spiral'; it must be one of circle"),
    "unknown output": (r"allowed_error", 'outputs = ["sag"]\nallowed_error', "wanted.outputs is ['sag']"),
    "no table": (r"\[tether\]", "tether = 3\n[more]", "unknown key more; known are name, duration, flight"),
    "no TOML": ("duration =.*", "duration =", "is not a TOML file"),
    "nested lists": ("duration =.*", "duration = " + "[" * 5000, "nested too deeply"),
    "nested tables": ("duration =.*", "duration = " + "{a=" * 5000, "nested too deeply"),
    "degrees": (
        "rate = .*",
        "half_angle = 20",
        'flight.half_angle is 20; it must be at least -1.5708 rad and at most 1.5708 rad; did you mean "20 deg"?',
    ),
    "mass and density": (
        "505 m",
        '505 m"\nmass_per_length = 1\ndensity = "700 kg/m3',
        "tether.mass_per_length and density are both given; give one of them",
    ),
    "longer than a day": ('"2 s"', '"25 h"', "duration is '25 h'; it must be at least 0.5 s and at most 86400 s"),
}
BEFORE_WIND = {  # what stands before the table [wind]
    "ground without contact": ("[ground]\nheight = 3", "the key ground.contact is missing"),
    "unknown ground": ('[ground]\ncontact = "grass"', "ground.contact is 'grass'; it must be one of 1 (none), 2 (flat)"),
    "unknown choice": ("[ground]\ncontact = 'flt'", "it must be one of 1 (none), 2 (flat); did you mean flat?"),
    "unknown key of the ground": (
        '[ground]\ncontact = "flat"\nslope = 0.1',
        "unknown key ground.slope; known are contact, height, friction, sink",
    ),
    "ground of lead": (
        '[ground]\ncontact = "flat"\nsink = "2 kg"',
        "ground.sink is '2 kg'; it must be a number with one of the units m, mm, cm, km",
    ),
    "ground in the environment": ('[environment]\nground_contact = "flat"', "unknown key environment.ground_contact"),
    "ground without gravity": (
        '[environment]\ngravity = 0\n[ground]\ncontact = "flat"',
        "ground.contact is flat; it needs a gravity above 0, for ground.sink is a depth under weight",
    ),
}
WRONG |= {name: (r"\[wind", f"{text}\n[wind", says) for name, (text, says) in BEFORE_WIND.items()}
VELOCITY = ",".join(f"ground_velocity[{i}]" for i in (1, 2, 3))
ROW = "0,1,2,3\n"


def with_columns(names, rows):
    """A file that has more columns behind the time."""
    return HEAD.replace("time", f"time,{names}") + rows


WRONG_SERIES = {
    "unreadable": (None, "cannot be read"),
    "no text": (b"\xff\xfe\x00", "is not a text file"),
    "empty": ("", "has 0 lines; it must have a header row and at least 4 rows"),
    "missing column": ("time,kite_position[1]\n0,1\n", "the column kite_position[2] is missing"),
    "unknown column": (with_columns("colour", ("0," + ROW) * 5), "unknown column 'colour'"),
    "word in a cell": (HEAD + "0,1,2,x\n", "row 2, column kite_position[3] has no number; it must be"),
    "more than an input may be": (
        HEAD + "0,1,1e300,3\n",
        "row 2, column kite_position[2] is 1e+300; it must be at most 1e+09 in magnitude",
    ),
    "a column twice": (HEAD.strip() + ",time\n" + "0,1,2,3,0\n" * 5, "the column time appears twice"),
    "too few cells": (HEAD + "0,1,2\n", "row 2, column kite_position[3] has no number; it must be"),
    "too many cells": (HEAD + "0,1,2,3,4\n" * 5, "row 2 has more cells than the header"),
    "time stands still": (HEAD + ROW * 5, "row 3: time is 0 after 0; it must grow from row to row"),
    "time goes back": (
        HEAD + "".join(f"{k},1,2,3\n" for k in (0, 1, 2, 1.5, 4, 3)),
        "row 5: time is 1.5 after 2; it must grow from row to row",
    ),
    "long name": (with_columns("x" * 500, ("0," + ROW) * 5), f"'{'x' * 40}...'; known are"),
    "velocity alone": (
        with_columns(VELOCITY, ("0,0,0," + ROW) * 5),
        "ground_velocity, but none of ground_position",
    ),
    "length twice": (
        with_columns("reel_out_speed,tether_length", "0,0,505,1,2,3\n" * 5),
        "has the columns reel_out_speed and tether_length; it must have one of them",
    ),
    "another length": (
        with_columns("tether_length", "".join(f"{k},501,{k},2,3\n" for k in range(5))),
        "tether.initial_length is 505.0 m; tether_length of the series begins with 501.0 m",
    ),
    "too short": (HEAD + "".join(f"0.{k},1,2,3\n" for k in range(5)), "duration is 2.0; it must be at most 0.4 s"),
}


def complaint(path, capsys):
    """What the command says of a wrong file, on one line."""
    assert main(["advise", str(path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    return line


@pytest.mark.parametrize(("pattern", "replacement", "says"), WRONG.values(), ids=WRONG)
def test_a_wrong_scene_is_told_in_one_line(tmp_path, capsys, pattern, replacement, says):
    path = written(tmp_path, re.sub(pattern, replacement, SCENE, count=1))
    line = complaint(path, capsys)
    assert line.startswith(str(path))
    assert says in line


@pytest.mark.parametrize(("content", "says"), WRONG_SERIES.values(), ids=WRONG_SERIES)
def test_a_wrong_series_is_told_in_one_line(tmp_path, capsys, content, says):
    if content is not None:
        (tmp_path / "flight.csv").write_bytes(content.encode() if isinstance(content, str) else content)
    line = complaint(written(tmp_path, SERIES), capsys)
    assert line.startswith(str(tmp_path))
    assert says in line


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="a pipe with a name is needed")
def test_only_regular_files_are_read(tmp_path, capsys):
    """A pipe waits for ever, a device has no end, a file without a size is taken as empty; the head line alone is quoted."""
    os.mkfifo(tmp_path / "pipe")
    for name in ("pipe", "/dev/zero", "."):
        line = complaint(written(tmp_path, SERIES.replace("flight.csv", name)), capsys)
        assert "cannot be read (it is not a regular file" in line
    for name in ("pipe", "."):
        assert "cannot be read (it is not a regular file)" in complaint(tmp_path / name, capsys)
    (tmp_path / "secret").write_text("user:password\nadmin:hunter2\n" * 5, encoding="utf-8")
    line = complaint(written(tmp_path, SERIES.replace("flight.csv", "secret")), capsys)
    assert "unknown column 'user:password'" in line
    assert "hunter2" not in line
    (tmp_path / "secret").write_text(HEAD + "1,2,3,hunter2\n" * 5, encoding="utf-8")
    line = complaint(written(tmp_path, SERIES.replace("flight.csv", "secret")), capsys)
    assert "row 2, column kite_position[3]" in line
    assert "hunter2" not in line


@pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="Linux only")
def test_a_file_of_unknown_size_is_empty():
    """Linux says 0 of what it makes up while it is read."""
    assert contents_of(Path("/proc/self/environ")) == b""


def test_a_file_that_is_too_large(tmp_path, monkeypatch):
    monkeypatch.setattr("tetherfmu.files.toml_files.LARGEST_FILE", 10)
    (tmp_path / "file").write_bytes(b"x" * 11)
    with pytest.raises(ValueError, match=r"it has more than 1e-08 GB"):
        contents_of(tmp_path / "file")


def test_missing_scene_file(tmp_path, capsys):
    assert "cannot be read" in complaint(tmp_path / "none.toml", capsys)


def test_numbers_with_units_and_in_si_are_the_same_scene(tmp_path):
    plain = SCENE.replace('"3 %"', "0.03").replace('"20 ms"', "0.02").replace('"505 m"', "505")
    scenes = [load(written(tmp_path, text)) for text in (SCENE, plain)]
    assert scenes[0].tether == scenes[1].tether
    assert scenes[0].wanted == scenes[1].wanted
    assert scenes[0].tether.initial_length == 505.0


def test_a_scene_may_say_the_mass_of_a_metre(tmp_path):
    """1 mm with 140 g/m; the density follows, and stiffness and damping follow the diameter unless they are given."""
    text = SCENE.replace('"505 m"', '"505 m"\ndiameter = "1 mm"\nmass_per_length = "140 g/m"')
    stays = {"axial_stiffness": 614600.0, "axial_damping": 473.0}
    rope = Tether(initial_length=505.0, diameter=0.001, mass_per_length=0.14, **stays)
    sixteenth = {name: value / 16.0 for name, value in stays.items()}
    assert load(written(tmp_path, text)).tether == replace(rope, **sixteenth)
    given = text.replace('"1 mm"', '"1 mm"\naxial_stiffness = 614600.0\naxial_damping = 473.0')
    assert load(written(tmp_path, given)).tether == rope


def test_the_ground_of_a_scene_is_that_of_its_tether(tmp_path):
    """With units; and it is a start value of the FMU that the scene advises."""
    table = '[ground]\ncontact = "flat"\nheight = "-40 cm"\nfriction = "30 %"\nsink = "5 mm"\n'
    scene = load(written(tmp_path, SCENE + table))
    assert scene.ground == Ground("flat", -0.4, 0.3, 0.005)
    starts = parameters_of(scene, Config("dynamic", 8, 1e-4, 0.02))
    assert {name: starts[name] for name in vars(scene.ground)} == vars(scene.ground)
    assert load(written(tmp_path)).ground == Ground()


def test_a_free_end_that_begins_under_the_ground_is_told(tmp_path, capsys):
    """A load on 505 m below a crane of 100 m; on one of 600 m nothing is said."""
    free = SCENE.replace('kind = "circle"\nrate = "0.5 rad/s"', 'kind = "free_end"\nheight = "HEIGHT m"')
    for height, said in (("100", "the free end begins 405 m below ground.height"), ("600", "")):
        load(written(tmp_path, free.replace("HEIGHT", height) + '[ground]\ncontact = "flat"\n'))
        assert said in capsys.readouterr().err if said else not capsys.readouterr().err


def test_a_series_may_give_the_length_instead_of_its_rate(tmp_path):
    """A parabola of the length, sampled every 0.2 s: its length and its rate at all times but the first and last ones."""
    time = 0.2 * np.arange(16)
    length = 505.0 + 0.4 * time + 0.1 * time**2
    kite = np.column_stack([300.0 + time, time, time])
    write_series(tmp_path / "flight.csv", time, {"tether_length": length, "kite_position": kite})
    times = np.linspace(0.3, 2.7, 13)
    motion = load(written(tmp_path, SERIES, "series")).flight.motion(times)
    # the slope is the harmonic mean of both sides instead of the mean: wrong by (h x2/2)^2/x1, x1 = 0.4 at least
    bound = (0.2 * 0.2 / 2.0) ** 2 / 0.4
    np.testing.assert_allclose(motion.reel_out_speed, 0.4 + 0.2 * times, rtol=0, atol=2.0 * bound)
    np.testing.assert_allclose(motion.reeled, 0.4 * times + 0.1 * times**2, rtol=0, atol=0.2 * bound)


def test_a_series_is_the_flight_that_it_samples(tmp_path):
    """A circle sampled every 0.2 s: a cubic spline is wrong by 5/384 h^4 |x''''| at most in the middle, more at its ends."""
    circle = load(written(tmp_path))
    time = 0.2 * np.arange(16)
    write_series(tmp_path / "flight.csv", time, {"kite_position": np.column_stack(circle.flight.kite(time))})
    series = load(written(tmp_path, SERIES, "series"))
    expected, inputs = circle.inputs(0.02), series.inputs(0.02)
    radius, rate = 500.0 * np.sin(np.radians(10.0)), 0.5
    bound = 5.0 / 384.0 * 0.2**4 * radius * rate**4
    middle = slice(30, 70)
    assert np.abs(inputs - expected)[middle, at.KITE_POSITION : at.KITE_POSITION + 3].max() < bound
    others = slice(at.WIND_VELOCITY, at.REEL_OUT_SPEED + 4)
    assert inputs[:, others] == pytest.approx(expected[:, others])


def test_what_is_no_scene_is_told_as_what_it_is(tmp_path):
    """A system, and a flight whose tether lets go."""
    said = r"hoist\.toml: describes a system of tethers, not a scene; use tetherfmu fly, advise, sweep or"
    with pytest.raises(WrongUse, match=said):
        load(named_systems()["hoist"])
    rows = "".join(f"{0.1 * k},300,{k},400,{int(k > 5)}\n" for k in range(200))
    (tmp_path / "flight.csv").write_text(HEAD.replace("\n", ",release\n") + rows)
    file = written(tmp_path, SERIES)
    assert load(file).flight.has_release
    with pytest.raises(WrongUse, match=r"series.release is for fly and sweep only"):
        load_for_advice(file)
