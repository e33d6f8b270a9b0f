"""The pages on systems: the file of the first is read, its lines run; the table of the second has every key."""

import re
from pathlib import Path

import numpy as np
import pytest

from manual import codes, page
from running import run_python
from tetherfmu.files.system_files import KEYS_OF_A_POINT
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.outputs import PLACES
from tetherfmu.runtime.parameters import Solver, Winch
from tetherfmu.runtime.quantities import quantities
from tetherfmu.study.measuring.system_flights import load

PAGE, KEYS = page("use/systems"), page("reference/systems")


def test_the_examples_of_the_page_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    crane, winches, drum, letting_go, atwood = codes(PAGE, "python")
    Path("crane.toml").write_text(codes(PAGE, "toml")[0], encoding="utf-8")
    names = {}
    exec(crane, names)
    assert np.isclose(names["outputs"].lines["rope"].tether_length, 21.0)  # 2 s at 0.5 m/s
    exec(winches, names)
    assert np.isclose(names["outputs"].lines["b"].tether_length, 19.0)  # 2 s at -0.5 m/s
    assert names["outputs"].lines["a"].winch_speed != 0.0
    exec(drum, names)
    found = names["outputs"]
    momentum = 40.0 * found.winches["drum"].winch_speed  # of the drum [N s], and of both loads times their ratios
    momentum -= 20.0 * found.points["a"].velocity[2] + 0.5 * 30.0 * found.points["b"].velocity[2]
    gained = 20.0 * 9.81 + 0.5 * 30.0 * 9.81 - 300.0 - 20.0  # N s, in 1 s of weights, winch_force and friction
    assert 0.0 <= momentum - gained < 2.0 * 20.0 * 0.1  # at first the drum reels in, for less than 0.1 s
    exec(atwood, names)
    assert np.isclose(names["outputs"].portions["rope"].payout[0], 0.5 * 98.1 / 55.5, rtol=0.1)  # of 10 kg more on one side
    exec(letting_go, names)
    assert np.isclose(names["outputs"].lines["rope"].break_time, 0.2)  # the beginning of step 10
    assert np.isclose(names["outputs"].points["load"].velocity[2], -9.81 * 0.8, rtol=1e-3)  # free fall since then
    (advice,) = re.findall(r"^tetherfmu (advise .*)$", PAGE, re.MULTILINE)
    said = run_python("-m", "tetherfmu", *advice.split(), "--set", "duration=2").stdout
    assert "\n  use       Crane.fmu\n            lines.rope.segments = " in said


def test_what_moves_on_the_page_moves(tmp_path):
    """The crane with the rows of the page: what the winch pays out is the area below them, and the tag line lets go."""
    rows, *_ = codes(PAGE.partition("## What moves")[2], "toml")
    (tmp_path / "crane.toml").write_text(codes(PAGE, "toml")[0] + rows, encoding="utf-8")
    flight = load(tmp_path / "crane.toml")
    assert flight.duration == 13.0
    segments = flight.segments_of_lines(1.0)
    _, flown = flight.fly(segments, flight.found.solver, 0.02)
    assert flown.outputs["rope"][-1, at.TETHER_LENGTH] == pytest.approx(20.0 + 0.5 + 5.0 + 0.25, abs=1e-3)
    assert flown.outputs["tag"][-1, PLACES["break_time"]] == pytest.approx(12.0)
    assert flown.points["drone"].position[-1] - flown.points["drone"].position[0] == pytest.approx([0, 0.5 * 12.9, 0])


def test_the_table_has_the_keys():
    for name in KEYS_OF_A_POINT:
        assert f"`points.NAME.{name}`" in KEYS
    for name, _ in quantities(Winch):
        assert re.search(rf"`(lines\.NAME)?\.{name}`", KEYS)
    for name, _ in quantities(Solver):
        assert f"`{name}`" in KEYS
