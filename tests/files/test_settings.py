"""Values in the place of those of a scene file: they give the scene of a file that has them, and wrong ones are named."""

import math
import re

import numpy as np
import pytest

from study.scenes_of_tests import SCENE, written
from tetherfmu.files.named import about, named_scenes
from tetherfmu.files.scene_files import SceneError, load
from tetherfmu.files.settings import FARTHEST, check_settings
from tetherfmu.libraries.examples import EXAMPLES
from tetherfmu.runtime.layout import WINCH_FORCE

WIND = "velocity = [8.0, 0.0, 0.0]"
TURBULENT = EXAMPLES / "wind" / "parked_in_turbulence.toml"
SAME = {  # settings: what the file has for it
    (("tether.diameter", "5 mm"),): ("[wind]", 'diameter = "5 mm"\n[wind]'),
    (("diameter", 0.005),): ("[wind]", 'diameter = "5 mm"\n[wind]'),
    (("duration", 3),): ('"2 s"', "3.0"),
    (("wind.velocity[3]", -1.0),): (WIND, "velocity = [8.0, 0.0, -1.0]"),
    (("wind.speed", "36 km/h"),): (WIND, "velocity = [10.0, 0.0, 0.0]"),
    (("ground_contact", "flat"), ("ground.height", -100.0)): ("[wind]", '[ground]\ncontact = "flat"\nheight = -100\n[wind]'),
    (("wind_exponent", 0.2),): ("[wind]", "[environment]\nwind_exponent = 0.2\n[wind]"),
}


@pytest.mark.parametrize("settings", SAME)
def test_a_setting_is_a_line_of_the_file(tmp_path, settings):
    found = load(written(tmp_path), settings)
    wanted = load(written(tmp_path, SCENE.replace(*SAME[settings])))
    for name in ("duration", "flight", "tether", "environment", "ground", "wind"):
        assert getattr(found, name) == getattr(wanted, name), name
    assert found.digest != load(written(tmp_path)).digest


def test_speed_and_direction_of_the_wind(tmp_path):
    scene = load(written(tmp_path), [("wind.speed", 6.0), ("wind.direction", "30 deg")])
    assert scene.wind.velocity == pytest.approx((6.0 * math.cos(math.pi / 6.0), 3.0, 0.0))


def test_a_seed_is_another_place_in_a_periodic_box():
    still, first, again, other = (load(TURBULENT, settings) for settings in ((), *([("wind.seed", n)] for n in (1, 1, 2))))
    moved = np.subtract(first.wind.box.origin, still.wind.box.origin)
    assert moved[2] == 0.0
    assert np.all((moved[:2] > 0.0) & (moved[:2] < FARTHEST))
    assert first.wind == again.wind
    assert not np.allclose(first.wind_at(0.1), other.wind_at(0.1), atol=0.1)


WRONG = {
    ("tether.diametre", 1): "unknown key tether.diametre; did you mean diameter?",
    ("diametre", 1): "a scene has no diametre; did you mean diameter?",
    ("wind.sped", 1): "a scene has no wind.sped; did you mean wind.speed?",
    ("wind.speed", "3 kg"): "wind.speed is '3 kg'; it must be a number with one of the units m/s, km/h",
    ("wind.seed", 1): "wind.seed is 1; it needs a periodic box of turbulence, wind.file",
    ("duration.x", 1): "duration.x cannot be set: duration is '2 s', no table",
    ("tether.diameter[1]", 1): "unknown key",
    ("diameter", "1 s"): "tether.diameter is '1 s'; it must be a number with one of the units m, mm",
}


@pytest.mark.parametrize("setting", WRONG)
def test_what_cannot_be_set_is_named(tmp_path, setting):
    with pytest.raises(SceneError, match=r"^[^:]+short\.toml: "):
        load(written(tmp_path), [setting])
    if setting[0] != "tether.diameter[1]":
        with pytest.raises(SceneError, match=re.escape(WRONG[setting])):
            load(written(tmp_path), [setting])


TWICE = {  # names of settings: whether two of them are the same value
    ("diameter", "tether.diameter"): True,
    ("gravity", "duration", "gravity"): True,
    ("ground_height", "ground.height"): True,
    ("wind.velocity", "wind.velocity[2]"): True,
    ("wind.velocity[1]", "wind.direction"): True,
    ("wind.speed", "wind.velocity"): True,
    ("wind.box.origin[2]", "wind.seed"): True,
    ("wind.speed", "wind.direction", "wind.velocity[3]"): False,
    ("wind.velocity[1]", "wind.velocity[2]", "wind.box.origin[3]", "wind.seed"): False,
    ("winch.mass", "winch.damping", "kite_mass.x"): False,
}


@pytest.mark.parametrize("names", TWICE)
def test_a_value_is_given_once_in_whatever_spelling(names):
    if TWICE[names]:
        with pytest.raises(ValueError, match=re.escape(names[0]) + r"( and .*,| is) given twice"):
            check_settings(names)
    else:
        check_settings(names)


HELD = SCENE.replace("[wind]", '[winch]\nforce = "3 kN"\nmass = 20\n[wind]')


def test_a_winch_holds_its_force(tmp_path):
    """Without a length the tether starts with the one that the force holds, taut; the force is that of each step."""
    scene = load(written(tmp_path, HELD.replace('initial_length = "505 m"', "")))
    assert scene.has_force
    assert scene.winch.winch_start == 2  # equilibrium
    assert scene.tether.initial_length == pytest.approx(500.0)  # the distance, where the search begins
    assert np.all(scene.inputs(0.02)[:, WINCH_FORCE] == 3000.0)
    assert not load(written(tmp_path)).has_force


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (HELD.replace('force = "3 kN"', ""), "winch is given without a force; a drum needs winch.force"),
        (HELD.replace("3 kN", "-3 kN"), "winch.force is '-3 kN'; it must be at least 0 N"),
    ],
)
def test_a_winch_without_a_force_is_refused(tmp_path, text, says):
    with pytest.raises(SceneError, match=re.escape(says)):
        load(written(tmp_path, text))


def test_scenes_have_names():
    known = named_scenes()
    assert {"circle", "eight_on_a_winch", "slewing_crane", "parked_in_turbulence"} <= set(known)
    assert all(about(path) for path in known.values())
    assert load("circle").digest == load(known["circle"]).digest
    with pytest.raises(SceneError, match="there is no file and no scene 'cirkle'; did you mean circle"):
        load("cirkle")
