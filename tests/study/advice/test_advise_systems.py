"""Advice for systems: its errors are those against formulas, it meets what is asked for, and wrong use is named."""

import re

import numpy as np
import pytest
from fmpy import read_model_description

from tetherfmu import TetherCatenary
from tetherfmu.__main__ import main
from tetherfmu.study.advice.system_advice import advise, errors, explain, run
from tetherfmu.study.measuring.system_flights import load

LINE = """
[points.low]
position = [0, 0, 0]
{velocity}

[points.high]
position = [80, 0, 40]

[lines.rope]
from = "low"
to = "high"
diameter = "20 mm"
density = 7800
axial_stiffness = "10 MN"
initial_length = "92 m"
segments = 8

[environment]
air_density = 0
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    return tmp_path_factory.mktemp("system")


def flight(place, settings=(), velocity=""):
    path = place / f"Line{len(velocity)}.toml"
    path.write_text(LINE.format(velocity=velocity))
    return load(path, [("duration", 1.0), *settings])


def test_the_error_is_that_against_the_catenary(place):
    """A rope at rest between two driven points: its end forces by the closed form of the elastic catenary."""
    scene = flight(place, [("wanted.allowed_error", 0.05)])
    advice = advise(scene)
    rope = scene.found.lines[0].tether
    closed = TetherCatenary(rope, scene.found.environment).initialize((80.0, 0.0, 40.0))
    exact = {"low": closed.ground_force, "high": closed.kite_force}
    for point in advice.points:
        (forces, _), *_ = run(scene, point.config)[0]
        error = max(np.linalg.norm(forces[name][-1] - exact[name]) / np.linalg.norm(exact[name]) for name in exact)
        assert error == pytest.approx(point.error(), abs=advice.finer.own_error())
    assert advice.met
    assert advice.least <= advice.point.error() <= advice.expected <= 0.05


def test_a_tenfold_demand_costs_more(place):
    loose, strict = (advise(flight(place, [("wanted.allowed_error", each)])) for each in (0.1, 0.005))
    assert loose.met
    assert strict.met
    assert loose.point.cost < strict.point.cost


def test_a_small_force_counts_as_a_hundredth_of_the_largest(place):
    """An error of 1 N in a force of 1 N beside one of 1000 N is one of 10 %."""
    rows = np.ones((10, 1))
    right = {"large": 1000.0 * rows, "small": rows}
    found = errors(flight(place), (right | {"small": 2.0 * rows}, 0.0), (right, 0.0))
    assert found == pytest.approx({"large": 0.0, "small": 0.1})


def test_a_driven_point_goes_straight_on_and_the_wind_has_gusts(place):
    """What is flown is what the file and the settings say; a reference has the wind of the middle of each step."""
    scene = flight(
        place, [("wind.velocity", [8, 0, 0]), ("wind.gust", 0.5), ("wind.gust_period", 2.0)], "velocity = [0, 1, 0]"
    )
    system, flown = scene.fly({"rope": 4}, scene.found.solver, 0.02)
    assert flown.positions["rope"].shape == (10, 5, 3)
    assert flown.points["low"].position[-1] == pytest.approx([0.0, 1.0, 0.0])
    assert system.lines[0].tether.segments == 4
    assert scene.wind(np.array([1.0]))[0] == pytest.approx([12.0, 0.0, 0.0])


def test_a_load_holds_a_free_point(place):
    """A load lifts a mass and its rope, from the equilibrium on: below is left what both do not weigh."""
    path = place / "Held.toml"
    path.write_text(LINE.format(velocity="").replace("position = [80, 0, 40]", 'mass = "100 kg"'))
    settings = [("duration", 2.0), ("lines.rope.initial_length", 40.0), ("loads.high", ["0 N", 0.0, "5 kN"])]
    scene = load(path, settings)
    _, flown = scene.fly({"rope": 4}, scene.found.solver, 0.02)
    weight = (100.0 + 7800.0 * np.pi / 4.0 * 0.02**2 * 40.0) * 9.81
    assert flown.points["low"].force[-1] == pytest.approx([0.0, 0.0, 5000.0 - weight], abs=1e-6)


def test_the_command_names_segments_and_errors(capsys):
    assert main(["advise", "hoist", "--fast", "--set", "wanted.allowed_error=0.05", "--set", "duration=1"]) == 0
    said = capsys.readouterr().out
    assert "  use       Hoist.fmu\n            lines.rope_left.segments = 2\n" in said
    assert "| rope_left 6, rope_right 6, beam 1 | 0.0001 " in said


def test_fixed_steps_stay_those_of_the_file(place, capsys):
    """And the finer system has adaptive ones; tolerances have no effect then."""
    scene = flight(place, [("solver.fixed_step", 0.01), ("wanted.allowed_error", 0.05)])
    advice = advise(scene)
    assert {point.config.tolerance for point in advice.points} == {0.0}
    assert len({point.config.segments for point in advice.points}) > 2
    assert advice.met
    assert "fixed_step = 0.01" in explain(scene, advice)


def test_what_no_number_of_segments_can_fly_is_refused(capsys):
    """A winch that reels in more rope than there is."""
    settings = ["--set", "lines.rope_left.reel_out_speed=-100"]
    assert main(["advise", "hoist", "--fast", *settings]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "this system cannot be flown" in line


def test_the_fmu_of_a_system_has_what_is_advised(place, capsys):
    """`build --scene` with the file of a system: segments and tolerance as its advice prints them."""
    path = place / "Line0.toml"
    path.write_text('duration = 1.0\nwanted.allowed_error = "5 %"\n' + LINE.format(velocity=""))
    assert main(["build", "--scene", str(path), "--out", str(place)]) == 0
    said = capsys.readouterr().out
    (count,) = re.findall(r"lines\.rope\.segments = (\d+)", said)
    (tolerance,) = re.findall(r"relative_tolerance = (\S+)", said)
    starts = {each.name: each.start for each in read_model_description(str(place / "Line0.fmu")).modelVariables}
    assert starts["rope.segments"] == count
    assert float(starts["relative_tolerance"]) == float(tolerance)
