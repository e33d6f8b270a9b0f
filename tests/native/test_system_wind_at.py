"""The FMU of a system with wind points: `LINE.wind_at[k,1..3]` in all flavours, as the Python API has it."""

import math
import zipfile
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy import read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu

from export.test_host_header import c_name, numbers_of
from export.test_system_flavours import SWING as FILE
from flavours import FLAVOURS, build_by_command, every_flavour
from isolation import in_shared_process
from native.steps_again import differences
from runtime.host import Host, blob_of

POINTS, STEP = 3, 0.02
WIND = np.array([[4.0, 1.0, 0.0], [9.0, -2.0, 0.5], [12.0, 1.5, 0.0]])


@pytest.fixture(scope="session")
def fmus(built_once):
    """Folder with the file, and a folder of FMUs with wind points for each flavour."""

    def build(folder):
        (folder / "swing.toml").write_text(FILE)
        for flavour in FLAVOURS:
            options = ["--system", str(folder / "swing.toml"), "--wind-points", str(POINTS)]
            build_by_command(folder / flavour, flavour, *options)

    return built_once("system_fmus_with_wind_points", build)


def wind(line, k):
    """Wind at the points of a line in step k [m/s], array (POINTS, 3)."""
    return WIND * (1.0 + 0.02 * k + (0.3 if line == "b" else 0.0))


def winds(k):
    return {f"{line}.wind_at": wind(line, k).ravel().tolist() for line in "ab"}


def started(path):
    return Host(path).start(**winds(0))


def fly(host, begin, end):
    """Numbers of all real outputs after each step."""
    rows = []
    for k in range(begin, end):
        host.time = k * STEP
        host.step(STEP, **winds(k))
        rows.append(host.all_outputs())
    return rows


@every_flavour
@in_shared_process
def test_a_refused_step_names_the_wind(fmus, flavour):
    host = started(fmus / flavour / "Swing.fmu")
    before = host.all_outputs()
    with pytest.raises(FMICallException):
        host.step(STEP, **{"b.wind_at[3,1]": math.nan})
    assert "the line b: the input b.wind_at[3,1] is nan" in host.messages[-1]
    assert host.all_outputs() == before


@pytest.mark.parametrize("flavour", ["native", "native_fmi3"])
@in_shared_process
def test_directional_derivative(fmus, flavour):
    """Of a tension by the wind at one point of its line: a difference of two steps from the same state."""
    host = started(fmus / flavour / "Swing.fmu")
    fly(host, 0, 5)
    blob, tension = blob_of(host), "a.tension_from"
    fly(host, 5, 6)
    output = [host.reference[tension]]
    if flavour == "native_fmi3":
        seed = [0.0] * 3 + [1.0] + [0.0] * 5
        (rate,) = host.fmu.getDirectionalDerivative(output, [host.reference["a.wind_at"]], seed, 1)
    else:
        (rate,) = host.fmu.getDirectionalDerivative(output, [host.reference["a.wind_at[2,1]"]], [1.0])
    ((expected,),) = differences(host, blob, STEP, winds(5), [tension], {"a.wind_at[2,1]": 0.1})
    assert rate == pytest.approx(expected, rel=1e-3)  # drag is nearly quadratic in the wind


@every_flavour
def test_it_is_a_valid_fmu_that_says_what_it_ignores(fmus, flavour):
    path = fmus / flavour / "Swing.fmu"
    assert validate_fmu(str(path)) == []
    known = {each.name: each for each in read_model_description(str(path)).modelVariables}
    wind_velocity = next(each for name, each in known.items() if "wind_velocity" in name)
    assert "ignored: the wind is that of wind_at" in wind_velocity.description
    assert known[next(name for name in known if name.startswith("a.shape"))].causality == "output"


@pytest.mark.parametrize("flavour", ["native", "native_fmi3"])
def test_numbers_of_the_header_are_those_of_the_model_description(fmus, flavour):
    numbers = numbers_of(fmus / flavour / "Swing.h")
    for variable in read_model_description(str(fmus / flavour / "Swing.fmu")).modelVariables:
        assert numbers.pop(c_name(variable.name)) == variable.valueReference
    assert flavour == "native" or numbers["TETHER_A_WIND_AT_SIZE"] == 3 * POINTS


def test_each_line_has_a_terminal_of_its_wind_in_the_place_of_the_one_of_all(fmus):
    with zipfile.ZipFile(fmus / "native_fmi3" / "Swing.fmu") as opened:
        root = ElementTree.fromstring(opened.read("terminalsAndIcons/terminalsAndIcons.xml"))
    found = {each.get("name"): [(one.get("memberName"), one.get("variableName")) for one in each] for each in root[0]}
    assert {name: members for name, members in found.items() if "wind" in name} == {
        "a.wind": [("at", "a.wind_at")],
        "b.wind": [("at", "b.wind_at")],
    }
    groups = ElementTree.parse(fmus / "native" / "Swing_OspModelDescription.xml").iter()
    assert "wind" not in [each.get("name") for each in groups]
