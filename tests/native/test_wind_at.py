"""FMUs with wind points: `wind_at[k,1..3]` in both flavours and both versions of FMI, as the Python API has it."""

import math
import zipfile

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

from flavours import WIND_POINTS, every_flavour
from isolation import in_shared_process
from native.steps_again import differences
from runtime.host import Host, blob_of, description_of, restore
from scenes import circle, kite_at_start, kite_inputs
from tetherfmu.export import osp
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import WITHOUT_EFFECT
from tetherfmu.wiring.variables import variables

STEP = 0.02
FORCE = [f"kite_force[{i}]" for i in (1, 2, 3)]
NAMES = ("TetherStraight", "TetherDynamicFree")
WIND = np.array([[4.0, 1.0, 0.0], [9.0, -2.0, 0.5], [12.0, 1.5, 0.0]])
every_fmu = pytest.mark.parametrize("name", NAMES)


def wind(k):
    """Wind at the points in step k [m/s], array (WIND_POINTS, 3)."""
    return WIND * (1.0 + 0.02 * k)


def started(path):
    kite = {key: list(value) for key, value in kite_at_start(path.stem, *circle(0.0)).items()}
    return Host(path).start(initial_length=525.0, wind_at=wind(0).ravel().tolist(), **kite)


def fly(host, name, begin, end):
    """Numbers of all real outputs after each step."""
    rows = []
    for k in range(begin, end):
        host.time = k * STEP
        host.step(STEP, wind_at=wind(k).ravel().tolist(), **kite_inputs(name, *circle(k * STEP)))
        rows.append(host.all_outputs())
    return rows


@every_flavour
@every_fmu
@in_shared_process
def test_a_refused_step_names_the_wind(windy, name, flavour):
    """Those that are set do not show in the outputs before the next step."""
    host = started(windy / flavour / f"{name}.fmu")
    fly(host, name, 0, 1)
    before = host.all_outputs()
    host.set(wind_at=(2.0 * WIND).ravel().tolist())
    with pytest.raises(FMICallException):
        host.step(STEP, **{"wind_at[3,1]": math.nan})
    assert "the input wind_at[3,1] is nan" in host.messages[-1]
    assert host.all_outputs() == before


@in_shared_process
def test_state_of_an_fmu_with_another_number_of_points(windy, native_folder):
    host, other = started(windy / "native" / "TetherStraight.fmu"), Host(native_folder / "TetherStraight.fmu").start()
    for one, blob in ((host, blob_of(other)), (other, blob_of(host))):
        with pytest.raises(FMICallException):
            restore(one, blob)
        assert "belongs to another tether FMU" in one.messages[-1]


def give_rate(host, rate):
    references = [host.reference[f"wind_at[{k},{i}]"] for k in range(1, WIND_POINTS + 1) for i in (1, 2, 3)]
    host.fmu.setRealInputDerivatives(references, [1] * len(references), rate.ravel().tolist())


@pytest.mark.parametrize("when", ["before the start", "before a step"])
@in_shared_process
def test_given_derivatives(windy, when):
    """Without waves: the wind of the end of the step, w + h dw/dt; for one step, and they wait in a saved state."""
    rate = np.random.default_rng(2).normal(size=(WIND_POINTS, 3))
    path = windy / "native" / "TetherStraight.fmu"
    growing, constant = Host(path), Host(path).start(initial_length=490.0)
    growing.enter_initialization(None)
    growing.set(initial_length=490.0)
    if when == "before the start":
        give_rate(growing, rate)
    growing.fmu.exitInitializationMode()
    if when == "before a step":
        give_rate(growing, rate)
        blob = blob_of(growing)
        give_rate(growing, 7.0 * rate)
        restore(growing, blob)
    growing.step(STEP, wind_at=WIND.ravel())
    constant.step(STEP, wind_at=(WIND + STEP * rate).ravel())
    assert growing.all_outputs() == constant.all_outputs()
    for host in (growing, constant):
        host.step(STEP, wind_at=WIND.ravel())
    assert growing.all_outputs() == constant.all_outputs()


@in_shared_process
def test_a_tether_with_waves_feels_the_mean_of_the_step(windy):
    """Its motion is that in the wind of the middle of the step; its drag then is that of the end."""
    rate, name = np.random.default_rng(3).normal(size=(WIND_POINTS, 3)), "TetherDynamicFree"
    growing, constant = (started(windy / "native" / f"{name}.fmu") for _ in range(2))
    give_rate(growing, rate)
    growing.step(STEP, wind_at=WIND.ravel())
    constant.step(STEP, wind_at=(WIND + 0.5 * STEP * rate).ravel())
    assert growing.get("kite_position") == constant.get("kite_position")
    assert growing.get("shape") == constant.get("shape")
    assert growing.get("kite_force") != constant.get("kite_force")


@pytest.mark.parametrize("flavour", ["native", "native_fmi3"])
@in_shared_process
def test_directional_derivative(windy, flavour):
    """Of the forces by the wind at the middle point: that of the differences of steps done again."""
    name = "TetherStraight"
    path = windy / flavour / f"{name}.fmu"
    host = started(path)
    fly(host, name, 0, 10)
    blob = blob_of(host)
    fly(host, name, 10, 11)
    if flavour == "native_fmi3":
        seed = [0.0] * 4 + [1.0] + [0.0] * 4
        found = host.fmu.getDirectionalDerivative([host.reference["kite_force"]], [host.reference["wind_at"]], seed, 3)
    else:
        force = [host.reference[each] for each in FORCE]
        found = host.fmu.getDirectionalDerivative(force, [host.reference["wind_at[2,2]"]], [1.0])
    given = {"wind_at": wind(10).ravel(), **kite_inputs(name, *circle(10 * STEP))}
    expected = differences(host, blob, STEP, given, FORCE, {"wind_at[2,2]": 0.1})[:, 0]
    # drag is nearly quadratic in the wind: observed 1e-5 from the cubic terms of a change of 0.1 m/s
    np.testing.assert_allclose(found, expected, atol=1e-3 * np.abs(expected).max())


@every_flavour
@every_fmu
def test_model_description(windy, name, flavour):
    """Valid; outputs depend on wind_at and not on what it replaces, which says so; value references of inputs as without."""
    path = windy / flavour / f"{name}.fmu"
    assert validate_fmu(str(path)) == []
    description = description_of(path)
    by_name = {each.name: each for each in description.modelVariables}
    for each in by_name.values():
        assert ("(ignored: the wind is that of wind_at)" in each.description) == (
            each.name.partition("[")[0] in WITHOUT_EFFECT
        )
    depending = {
        unknown.variable.name: {known.name.partition("[")[0] for known in unknown.dependencies or ()}
        for unknown in description.initialUnknowns
    }
    output = "kite_force" if flavour == "native_fmi3" else "kite_force[1]"
    assert "wind_at" in depending[output]
    assert depending[output].isdisjoint(WITHOUT_EFFECT)
    places = list(range(at.INPUTS, at.INPUTS + 3 * WIND_POINTS))
    if flavour == "native_fmi3":
        assert [int(size.start) for size in by_name["wind_at"].dimensions] == [WIND_POINTS, 3]
        assert by_name["wind_at"].valueReference == at.INPUTS
    else:
        assert [by_name[f"wind_at[{k},{i}]"].valueReference for k in (1, 2, 3) for i in (1, 2, 3)] == places
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
        assert f"extra/com.open-simulation-platform/{osp.file_name(name)}" in names


@every_fmu
@in_shared_process
def test_each_number_is_felt_at_the_start(windy, name):
    """Each declared dependency on the wind is seen, and what wind_at replaces changes nothing."""
    host = Host(windy / "native" / f"{name}.fmu")
    host.enter_initialization(None)
    kite = kite_at_start(name, *circle(0.0))
    host.set(**kite, initial_length=525.0, wind_at=WIND.ravel(), surface_roughness=0.01)
    before = host.get("ground_force")
    for each in range(9):
        changed = WIND.ravel() + np.eye(9)[each]
        host.set(wind_at=changed)
        assert host.get("ground_force") != before
    host.set(wind_at=WIND.ravel(), wind_velocity=(30.0, 0.0, 0.0), wind_profile=4, wind_exponent=0.5, surface_roughness=0.1)
    host.set(wind_reference_height=20.0)
    assert host.get("ground_force") == before


@pytest.mark.parametrize("flavour", ["pythonfmu", "native"])
@in_shared_process
def test_a_profile_without_effect_is_said_once(windy, flavour):
    host = Host(windy / flavour / "TetherStraight.fmu").start(wind_at=WIND.ravel(), wind_profile=4)
    host.step(0.02)
    assert sum("wind_profile has no effect: the wind is that of wind_at" in each for each in host.messages) == 1
    usual = Host(windy / flavour / "TetherStraight.fmu").start(wind_at=WIND.ravel())
    assert not any("wind_profile" in each for each in usual.messages)


def test_without_points_all_is_as_before():
    for name in ("straight", "dynamic_free"):
        assert variables(name, 5) == variables(name, 5, wind_points=0)


@pytest.mark.parametrize("points", ["1", "-3", "1002", "x", "2.5"])
def test_numbers_of_points_that_cannot_be(points, capsys):
    from tetherfmu.commands.build import main

    with pytest.raises(SystemExit):
        main(["TetherStraight", "--wind-points", points])
    assert "--wind-points" in capsys.readouterr().err
