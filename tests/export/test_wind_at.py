"""FMUs with wind points, of tethers and of a system: `wind_at[k,1..3]` in all flavours, as the Python API has it."""

import math
import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

from export.test_host_header import c_name, numbers_of
from export.test_system_flavours import SWING, WIND, winds
from flavours import FLAVOURS, WIND_POINTS, every_flavour
from isolation import in_shared_process
from native.steps_again import differences
from runtime.host import Host, blob_of, description_of, restore
from scenes import circle, kite_at_start, kite_inputs
from tetherfmu.commands.build import main
from tetherfmu.export import osp, system_fmus
from tetherfmu.export.build_options import BuildOptions
from tetherfmu.export.native.host_header import PREFIX
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import WITHOUT_EFFECT
from tetherfmu.wiring.variables import variables

STEP = 0.02
FORCE = [f"kite_force[{i}]" for i in (1, 2, 3)]
TETHERS = ("TetherStraight", "TetherDynamicFree")
SYSTEM = "Swing"
every_tether = pytest.mark.parametrize("name", TETHERS)
every_fmu = pytest.mark.parametrize("name", [*TETHERS, SYSTEM])
native = pytest.mark.parametrize("flavour", [flavour for flavour in FLAVOURS if flavour != "pythonfmu"])


@pytest.fixture
def path(windy, built, name, flavour):
    """Path of an FMU with wind points."""
    return built(SWING, flavour, WIND_POINTS) if name == SYSTEM else windy / flavour / f"{name}.fmu"


def given(name, k):
    """Inputs of step k."""
    if name == SYSTEM:
        return winds(k)
    return {"wind_at": (WIND * (1.0 + 0.02 * k)).ravel(), **kite_inputs(name, *circle(k * STEP))}


def started(path):
    name = path.stem
    if name == SYSTEM:
        return Host(path).start(**winds(0))
    return Host(path).start(initial_length=525.0, wind_at=WIND.ravel(), **kite_at_start(name, *circle(0.0)))


def fly(host, name, steps):
    """Do some steps from the start; the state before the last one."""
    for k in range(steps):
        before = blob_of(host)
        host.time = k * STEP
        host.step(STEP, **given(name, k))
    return before


@every_flavour
@every_fmu
@in_shared_process
def test_a_refused_step_names_the_wind(path, name, flavour):
    """What is set does not show in the outputs before the next step."""
    host = started(path)
    fly(host, name, 1)
    before = host.all_outputs()
    host.set(**given(name, 50))
    wrong, line = ("b.wind_at[3,1]", "the line b: ") if name == SYSTEM else ("wind_at[3,1]", "")
    with pytest.raises(FMICallException):
        host.step(STEP, **{wrong: math.nan})
    assert f"{line}the input {wrong} is nan" in host.messages[-1]
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
    rate = np.random.default_rng(3).normal(size=(WIND_POINTS, 3))
    growing, constant = (started(windy / "native" / "TetherDynamicFree.fmu") for _ in range(2))
    give_rate(growing, rate)
    growing.step(STEP, wind_at=WIND.ravel())
    constant.step(STEP, wind_at=(WIND + 0.5 * STEP * rate).ravel())
    assert growing.get("kite_position") == constant.get("kite_position")
    assert growing.get("shape") == constant.get("shape")
    assert growing.get("kite_force") != constant.get("kite_force")


@native
@pytest.mark.parametrize("name", ["TetherStraight", SYSTEM])
@in_shared_process
def test_directional_derivative(path, name, flavour):
    """Of forces by the wind at the middle point of a line: that of the differences of steps done again."""
    host = started(path)
    before = fly(host, name, 11)
    outputs, wind = (["a.tension_from"], "a.wind_at") if name == SYSTEM else (FORCE, "wind_at")
    if flavour == "native_fmi3":
        unknown, seed = host.reference[outputs[0].partition("[")[0]], np.eye(9)[4].tolist()
        found = host.fmu.getDirectionalDerivative([unknown], [host.reference[wind]], seed, len(outputs))
    else:
        unknowns = [host.reference[each] for each in outputs]
        found = host.fmu.getDirectionalDerivative(unknowns, [host.reference[f"{wind}[2,2]"]], [1.0])
    expected = differences(host, before, STEP, given(name, 10), outputs, {f"{wind}[2,2]": 0.1})[:, 0]
    # drag is nearly quadratic in the wind: observed 1e-5 from the cubic terms of a change of 0.1 m/s
    np.testing.assert_allclose(found, expected, atol=1e-3 * np.abs(expected).max())


@every_flavour
@every_fmu
def test_it_is_a_valid_fmu_that_says_what_it_ignores(path, name, flavour):
    assert validate_fmu(str(path)) == []
    known = description_of(path).modelVariables
    says = {each.name.partition("[")[0]: "(ignored: the wind is that of wind_at)" in each.description for each in known}
    assert {each for each, ignored in says.items() if ignored} == set(WITHOUT_EFFECT)
    assert {each.causality for each in known if "shape" in each.name.partition("[")[0].split(".")} == {"output"}


@every_flavour
@every_tether
def test_dependencies_and_value_references(path, name, flavour):
    """Outputs depend on wind_at and not on what it replaces; value references of inputs as without."""
    description = description_of(path)
    by_name = {each.name: each for each in description.modelVariables}
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


@every_tether
@in_shared_process
def test_each_number_is_felt_at_the_start(windy, name):
    """Each declared dependency on the wind is seen, and what wind_at replaces changes nothing."""
    host = Host(windy / "native" / f"{name}.fmu")
    host.enter_initialization(None)
    host.set(**kite_at_start(name, *circle(0.0)), initial_length=525.0, wind_at=WIND.ravel(), surface_roughness=0.01)
    before = host.get("ground_force")
    for change in np.eye(9):
        host.set(wind_at=WIND.ravel() + change)
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
    with pytest.raises(SystemExit):
        main(["TetherStraight", "--wind-points", points])
    assert "--wind-points" in capsys.readouterr().err


@pytest.mark.parametrize("fmi", [2, 3])
def test_of_a_system_header_terminals_and_groups(tmp_path, fmi):
    """Numbers of the header are those of the description; each line has a terminal of its wind, and there is none of all."""
    (tmp_path / "swing.toml").write_text(SWING)
    path = system_fmus.build(
        tmp_path / "swing.toml", tmp_path, BuildOptions(wind_points=WIND_POINTS), fmi, with_header=PREFIX
    )
    numbers = numbers_of(path.with_suffix(".h"))
    for variable in description_of(path).modelVariables:
        assert numbers.pop(c_name(variable.name)) == variable.valueReference
    if fmi == 2:
        groups = ElementTree.parse(tmp_path / osp.file_name(SYSTEM)).iter()
        assert "wind" not in [each.get("name") for each in groups]
        return
    assert numbers["TETHER_A_WIND_AT_SIZE"] == 3 * WIND_POINTS
    with zipfile.ZipFile(path) as opened:
        root = ElementTree.fromstring(opened.read("terminalsAndIcons/terminalsAndIcons.xml"))
    found = {each.get("name"): [(one.get("memberName"), one.get("variableName")) for one in each] for each in root[0]}
    winds_of = {f"{line}.wind": [("at", f"{line}.wind_at")] for line in "ab"}
    assert {name: members for name, members in found.items() if "wind" in name} == winds_of
