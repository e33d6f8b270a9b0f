"""Scenes in a box of turbulence: the wind of formulas at the points, the tether in it, one line for each mistake."""

import pickle
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from benchmark.scenes import BREEZE
from example_fmus.test_wind_boxes import turbsim
from study.scenes_of_tests import SCENE, written
from tetherfmu.__main__ import main
from tetherfmu.files.scene_files import load
from tetherfmu.runtime.parameters import Environment
from tetherfmu.study.advice.scene_build import needed
from tetherfmu.study.advice.scene_figures import draw_wind
from tetherfmu.study.measuring.runs import Config, run
from tetherfmu.study.measuring.scene_fmus import inputs_of
from tetherfmu.wiring.variables import variables

POINTS, SPACING = (8, 4, 4), (100.0, 200.0, 200.0)
BLOWING = SCENE.replace(
    "velocity = [8.0, 0.0, 0.0]", 'velocity = [0.0, 8.0, 0.0]\nfile = "box.npz"\n[wind.box]\nwind_points = 5'
)
PARKED = BLOWING.replace('kind = "circle"\nrate = "0.5 rad/s"', 'kind = "parked"\ndistance = "500 m"')
STEP = 0.02
REFERENCE = Path(__file__).parents[1] / "reference"


def box(folder, velocity=(0.0, 0.0, 0.0)):
    """Write a box with a velocity [m/s], one or one for each of its points."""
    numbers = np.broadcast_to(np.array(velocity, "f4"), (*POINTS, 3))
    np.savez(folder / "box.npz", velocity=numbers, spacing=SPACING)


def test_gusts_come_along_the_mean_wind_and_late_downwind(tmp_path):
    """The mean wind blows along y, so the axes of the box are y, -x, z. A gust u(q) of the box is at y = q + U t."""
    along = -SPACING[0] * np.arange(POINTS[0])[::-1]
    gust = np.zeros((*POINTS, 3))
    gust[..., 0], gust[..., 1] = 0.01 * along[:, None, None], 3.0
    box(tmp_path, gust)
    text = PARKED.replace("wind_points = 5", 'wind_points = 5\norigin = [0.0, "300 m", 0.0]')
    scene = load(written(tmp_path, text))
    time = STEP * np.arange(round(scene.duration / STEP))
    kite = scene.flight.motion(time).kite
    places = np.linspace(0.0, 1.0, 5)[:, None] * kite[:, None, :]
    expected = np.zeros_like(places)
    expected[..., 0] = -3.0
    expected[..., 1] = 8.0 + 0.01 * (places[..., 1] - 300.0 - 8.0 * time[:, None])
    np.testing.assert_allclose(scene.wind_at(STEP), expected, rtol=0.0, atol=2e-6)  # 32-bit numbers of the box
    middle = scene.wind_at(STEP, exact=True)
    assert middle[0, 0, 1] - expected[0, 0, 1] == pytest.approx(-0.01 * 8.0 * 0.5 * STEP, abs=2e-6)


@pytest.mark.parametrize("variant", ["dynamic", "quasi_steady", "catenary", "straight"])
def test_a_box_of_calm_is_the_law_of_the_mean_wind(tmp_path, variant):
    """At so many points that the interpolation, (f'' dz^2)/8, is no matter; of a taut tether, so the points are on it."""
    box(tmp_path)
    text = PARKED.replace("wind_points = 5", "wind_points = 201").replace('"505 m"', '"499 m"')
    profile = '[environment]\nwind_profile = "power_law"\nwind_exponent = 0.3\nwind_reference_height = 10\n[wind]'
    scene = load(written(tmp_path, text.replace("[wind]", profile)))
    plain = replace(scene, wind=replace(BREEZE, velocity=(0.0, 8.0, 0.0)))
    forces = [run(each, Config(variant, 40, 0.0, STEP)).flown.ground_force for each in (scene, plain)]
    calm = run(replace(plain, environment=Environment(air_density=0.0)), Config(variant, 40, 0.0, STEP)).flown.ground_force
    of_wind = np.linalg.norm(forces[1] - calm, axis=1).max()
    # the law at the middle of a segment, or the mean of its ends: observed 0.09 %; the wind turned around makes it 200 %
    assert np.linalg.norm(forces[0] - forces[1], axis=1).max() < 2e-3 * of_wind


def test_turbsim_has_its_own_mean_and_mann_needs_its_grid(tmp_path):
    """Files that other programs wrote; velocity gives the direction, which a box of TurbSim has not."""
    turbsim = PARKED.replace('"box.npz"', f'"{(REFERENCE / "pyconturb.bts").as_posix()}"').replace("8.0", "80.0")
    mann = PARKED.replace('"box.npz"', f'"{(REFERENCE / "mann_u.turb").as_posix()}"')
    grid = "points_along = 16\npoints_across = 4\npoints_upwards = 8\n"
    grid += "spacing_along = 5\nspacing_across = 10\nspacing_upwards = 8"
    for text in (turbsim, mann.replace("wind_points = 5", grid)):
        scene = load(written(tmp_path, text))
        speed = np.linalg.norm(scene.wind_at(0.1)[:, -1], axis=1)
        assert 1.0 < speed.mean() < 30.0
    assert scene.wind_points == 11


def test_an_advised_fmu_has_the_winds_as_inputs_and_other_processes_get_no_box(tmp_path):
    box(tmp_path, (1.0, 0.0, 0.0))
    scene = load(written(tmp_path, PARKED))
    inputs = inputs_of(scene, STEP)
    np.testing.assert_array_equal(inputs.filter(like="wind_at").to_numpy(), scene.wind_at(STEP).reshape(len(inputs), -1))
    assert list(inputs.filter(like="wind_at"))[3:5] == ["wind_at[2,1]", "wind_at[2,2]"]
    moving, _ = needed(scene, inputs, variables("dynamic", 0, wind_points=5))
    assert "wind_at" in moving
    assert len(pickle.dumps(scene.wind)) < 2000 < (tmp_path / "box.npz").stat().st_size
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(scene)).wind_at(STEP), scene.wind_at(STEP))
    draw_wind(scene, tmp_path / "wind.png")
    assert (tmp_path / "wind.png").stat().st_size > 3000


def test_another_box_is_another_scene(tmp_path):
    box(tmp_path)
    before = load(written(tmp_path, PARKED)).digest
    assert load(written(tmp_path, PARKED)).digest == before
    np.savez(tmp_path / "box.npz", velocity=np.zeros((9, 4, 4, 3), "f4"), spacing=SPACING)
    assert load(written(tmp_path, PARKED)).digest != before


WRONG = {
    "no such file": ("box.npz", "bax.npz", "wind.file: '.*bax.npz' cannot be opened: No such file"),
    "another kind": ("box.npz", "box.csv", r"wind.file: '.*box.csv' is not the name of a wind box: it must end in \.bts"),
    "no name": ('"box.npz"', "3", "wind.file is 3; it must be the name of a box"),
    "no file": ('file = "box.npz"\n', "", "wind.box is given without wind.file"),
    "gust": ("file =", "gust = 0.3\nfile =", "wind.gust is given with wind.file"),
    "upwards": ("8.0, 0.0]", "8.0, 1.0]", r"wind.velocity is \[0.0, 8.0, 1.0\]; with wind.file it must be horizontal"),
    "profile": (
        r"\[wind\]",
        '[environment]\nwind_profile = "logarithmic"\n[wind]',
        r"environment.wind_profile is 3; with wind.file it must be 1 \(uniform\) or 2 \(power_law\)",
    ),
    "unknown key": ("wind_points", "wind_point", "unknown key wind.box.wind_point; did you mean wind_points?"),
    "one point": ("wind_points = 5", "wind_points = 1", "wind.box.wind_points is 1; it must be at least 2"),
    "origin": (
        "wind_points = 5",
        "origin = [0, 1]",
        r"wind.box.origin is \[0, 1\]; it must be three numbers \[x, y, z\] in m",
    ),
    "outside": (
        "wind_points = 5",
        'outside = "refused"\norigin = [0, -900, 0]',
        r".*box.npz does not reach the point \(.*\) m at .* s: .*; move its origin, use a larger box or a periodic one",
    ),
    "free end": (
        'kind = "parked"\ndistance = "500 m"',
        'kind = "free_end"',
        "wind.file is given to a free end, whose path is unknown",
    ),
}


@pytest.mark.parametrize("mistake", WRONG)
def test_a_mistake_is_one_line(tmp_path, capsys, mistake):
    box(tmp_path)
    old, new, words = WRONG[mistake]
    text = re.sub(old, new, PARKED, count=1)
    assert text != PARKED
    path = written(tmp_path, text)
    assert main(["advise", str(path)]) == 2
    lines = capsys.readouterr().err.strip().splitlines()
    assert len(lines) == 1
    assert re.search(words, lines[0])
    assert str(path) in lines[0]


@pytest.mark.parametrize("kind", [7, 8])
def test_a_scene_says_that_its_box_has_a_seam(tmp_path, capsys, kind):
    numbers = np.zeros((6, 5, 3, 3), int)
    turbsim(tmp_path / "box.bts", numbers, kind=kind)
    text = PARKED.replace("box.npz", "box.bts")
    load(written(tmp_path, text.replace("wind_points = 5", 'wind_points = 5\noutside = "repeated"')))
    assert ("box.bts says that it is not periodic" in capsys.readouterr().err) == (kind == 7)


def test_a_scene_ends_with_a_box_that_is_not_periodic(tmp_path, capsys):
    """Its planes pass within 2.5 s; the scene takes 2 s, or 3 s."""
    turbsim(tmp_path / "box.bts", np.zeros((6, 5, 3, 3), int), kind=7)
    text = PARKED.replace("box.npz", "box.bts")
    load(written(tmp_path, text))
    assert not capsys.readouterr().err
    path = written(tmp_path, re.sub(r"duration = .*", "duration = 3.0", text))
    assert main(["advise", str(path)]) == 2
    words = (
        r"box.bts does not reach the point \(0, 0, 0\) m at 2.6 s: .*The file says that it is not periodic: make it periodic"
    )
    assert re.search(words, capsys.readouterr().err)
