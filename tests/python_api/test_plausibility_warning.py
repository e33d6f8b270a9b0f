"""The Python API warns once of what no tether and no kite does, at the line of the caller; `implausible` says it again."""

import re
import warnings
from pathlib import Path

import numpy as np
import pytest

from scenes import circle
from tetherfmu import PlausibilityWarning, TetherCatenary, TetherDynamic, TetherQuasiSteady, TetherStraight, inputs_along

EVERY = (TetherStraight, TetherCatenary, TetherQuasiSteady, TetherDynamic)
every_model = pytest.mark.parametrize("model", EVERY, ids=lambda model: model.variant)
POSITIONS = np.array([circle(0.02 * k)[0] for k in range(40)])


def warnings_of(act):
    with warnings.catch_warnings(record=True) as given:
        warnings.simplefilter("always")
        act()
    assert all(each.category is PlausibilityWarning and each.filename == __file__ for each in given)
    return [str(each.message) for each in given]


def step_along(tether, positions=POSITIONS):
    for position in positions:
        tether.step(0.02, kite_position=position)


@every_model
def test_once_and_again_after_a_new_start(model):
    tether = model(initial_length=525.0, ground_height=-100.0)
    for _ in range(2):
        assert warnings_of(lambda: tether.initialize(POSITIONS[0])) == []
        assert tether.implausible == []
        (first,) = warnings_of(lambda: step_along(tether))
        assert first.startswith("kite_velocity contradicts kite_position: it does not account for 100 % of the displacement")
        assert warnings_of(lambda: step_along(tether, POSITIONS[::-1])) == []
        assert tether.implausible == [first]


@every_model
def test_a_flight_in_compiled_code(model):
    tether = model(initial_length=525.0)
    tether.initialize(POSITIONS[0])
    inputs = inputs_along(len(POSITIONS), 0.02)
    inputs[:, :3], inputs[:, 3:6] = POSITIONS, 0.0
    assert len(warnings_of(lambda: tether.fly(inputs, 0.02))) == 1
    assert warnings_of(lambda: tether.fly(inputs[::-1], 0.02)) == []


@every_model
def test_a_start_on_a_tether_that_is_too_short(model):
    tether = model(initial_length=100.0)
    assert "stretched by 400 %" in warnings_of(lambda: tether.initialize((300.0, 0.0, 400.0)))[0]
    assert warnings_of(lambda: tether.step(0.02)) == []


def test_a_diameter_in_millimetres_is_named():
    """At the line that makes the model, for every kind of it, before its forces are looked at."""
    for model in EVERY:
        said = warnings_of(lambda model=model: model(diameter=4))
        assert said == ["diameter is 4 m, more than 0.2 m; diameters are in m: 4 mm are 0.004"]
        assert warnings_of(lambda model=model: model(diameter=0.2)) == []


def test_a_stretch_names_what_it_comes_from():
    """Whatever the rope is made of, and without two equal numbers where it is just beyond the limit."""
    (said,) = warnings_of(lambda: TetherStraight(initial_length=500.0 / 1.0501).initialize((300.0, 0.0, 400.0)))
    assert said.startswith("a segment is stretched by 5.01 %; from 5 % on, most ropes break; check kite_pos")
    assert "diameter and axial_stiffness, and their units" in said
    assert "Dyneema" not in said


def test_states():
    """A state that has warned is silent in another tether, too; one that no tether has is refused."""
    tether, another = (TetherStraight(initial_length=525.0) for _ in range(2))
    tether.initialize(POSITIONS[0])
    before = tether.get_state()
    warnings_of(lambda: step_along(tether))
    after = tether.get_state()
    another.set_state(after)
    assert warnings_of(lambda: step_along(another, POSITIONS[::-1])) == []
    assert another.implausible == tether.implausible
    tether.set_state(before)
    assert warnings_of(lambda: step_along(tether)) == []
    fresh = TetherStraight(initial_length=525.0)
    fresh.set_state(before)
    assert len(warnings_of(lambda: step_along(fresh))) == 1
    with pytest.raises(ValueError, match="state contains impossible numbers"):
        fresh.set_state(np.full_like(before, np.nan))


def test_a_refused_start_keeps_what_was_told():
    tether = TetherStraight(initial_length=100.0)
    warnings_of(lambda: tether.initialize((300.0, 0.0, 400.0)))
    with pytest.raises(ValueError, match="kite_position"):
        tether.initialize((np.nan, 0.0, 0.0))
    assert warnings_of(lambda: tether.step(0.02)) == []


@every_model
def test_what_cannot_break_says_so(model):
    said = warnings_of(lambda: model(breaking_force=5e3))
    cannot = "breaking_force is 5000 N and has no effect: this tether cannot break; the dynamic one can"
    assert said == ([] if model is TetherDynamic else [cannot])


def test_what_silences_all_warnings_says_why():
    """A mark that names what it silences says enough; one of the whole kind has its reason beside it."""
    tests = Path(__file__).resolve().parents[1]
    whole = re.compile(r'^.*filterwarnings\("ignore::.*$', re.MULTILINE)
    found = [line for path in tests.rglob("*.py") for line in whole.findall(path.read_text(encoding="utf-8"))]
    assert found
    assert [line for line in found if "  # " not in line] == []
    assert "filterwarnings" not in (tests.parent / "pyproject.toml").read_text(encoding="utf-8")
