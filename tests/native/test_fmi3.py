"""FMI 3: a valid description with arrays and terminals, answers as the standard asks. Numbers: `runtime/test_flavours.py`"""

import math
import re
import subprocess
import sys
import zipfile
from ctypes import CDLL
from itertools import pairwise
from pathlib import Path

import fmpy
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi3 import FMU3Model
from fmpy.validation import validate_fmu
from lxml import etree

from isolation import in_shared_process
from runtime.host import Host, blob_of
from tetherfmu.export.archive import SLAVES
from tetherfmu.export.build_options import BuildOptions
from tetherfmu.export.native import native_fmus as native
from tetherfmu.export.native.native_fmus import HEADERS

SCHEMAS = Path(fmpy.__file__).parent / "schema" / "fmi3"
STEP = 0.02
every_fmu = pytest.mark.parametrize("name", list(SLAVES))


def read(path, file):
    with zipfile.ZipFile(path) as archive:
        return etree.fromstring(archive.read(file))


@every_fmu
def test_checkers_find_no_problem(fmi3_folder, name):
    path = fmi3_folder / f"{name}.fmu"
    assert validate_fmu(str(path)) == []
    for file, schema in (
        ("modelDescription.xml", "fmi3ModelDescription.xsd"),
        ("terminalsAndIcons/terminalsAndIcons.xml", "fmi3TerminalsAndIcons.xsd"),
    ):
        etree.XMLSchema(etree.parse(str(SCHEMAS / schema))).assertValid(read(path, file))


@every_fmu
def test_variables_are_those_of_fmi2(native_folder, fmi3_folder, name):
    """An array has the value reference, unit and start values of the scalars that it stands for."""
    scalars = read(native_folder / f"{name}.fmu", "modelDescription.xml").findall("ModelVariables/ScalarVariable")
    listed = read(fmi3_folder / f"{name}.fmu", "modelDescription.xml").find("ModelVariables")
    found = {each.get("name"): each for each in listed}
    assert found.pop("time").get("causality") == "independent"
    elements = {}
    for scalar in scalars:
        elements.setdefault(scalar.get("name").partition("[")[0], []).append(scalar)
    assert list(found) == list(elements)
    for each, parts in elements.items():
        variable, first = found[each], parts[0]
        size = math.prod(int(dimension.get("start")) for dimension in variable.findall("Dimension"))
        assert size == len(parts)
        for attribute in ("valueReference", "causality", "variability", "initial"):
            assert variable.get(attribute) == first.get(attribute)
        for attribute in ("unit", "quantity", "nominal", "min", "max", "displayUnit", "declaredType"):
            assert variable.get(attribute) == first[0].get(attribute)
        starts = [part[0].get("start") for part in parts if part[0].get("start")]
        assert (variable.get("start") or "").split() == starts
        references = [int(part.get("valueReference")) for part in parts]
        assert references == list(range(references[0], references[0] + size))


@every_fmu
def test_terminals_name_variables(fmi3_folder, name):
    path = fmi3_folder / f"{name}.fmu"
    known = {each.get("name") for each in read(path, "modelDescription.xml").find("ModelVariables")}
    terminals = read(path, "terminalsAndIcons/terminalsAndIcons.xml").findall("Terminals/Terminal")
    members = {each.get("name"): [member.get("memberName") for member in each] for each in terminals}
    assert list(members) == ["kite", "ground", "winch", "wind"]
    assert members["ground"] == ["position", "velocity", "force"]
    assert members["kite"] == ["position", "velocity", "force", *(["load"] if name.endswith("Free") else [])]
    assert members["winch"] == ["reel_out_speed", "force", "length", "tether_length", "speed"]
    assert members["wind"] == ["velocity"]
    assert all(member.get("variableName") in known for each in terminals for member in each)


def test_the_wind_at_points_is_the_terminal_of_the_wind(tmp_path):
    """With the points where it is wanted; what it replaces is ignored then."""
    path = native.build("TetherStraight", tmp_path, BuildOptions(wind_points=3), fmi=3)
    (wind,) = read(path, "terminalsAndIcons/terminalsAndIcons.xml").findall("Terminals/Terminal[@name='wind']")
    assert [member.get("variableName") for member in wind] == ["wind_at", "shape"]


@in_shared_process
def test_steps(fmi3_folder):
    """No event, no early return, no end; a discarded step has got nowhere, and the next one is done."""
    host = Host(fmi3_folder / "TetherDynamic.fmu").start()
    assert host.get("time") == 0.0
    host.step(STEP)
    assert host.flags == (False, False, False, STEP)
    assert host.get("time") == STEP
    before = host.outputs()
    with pytest.raises(FMICallException, match="discard"):
        host.step(STEP, wind_velocity=[0.0, math.nan, 0.0])
    assert "tether: fmi3DoStep: the step from 0.02 s is refused: the input wind_velocity[2] is nan" in host.messages[-1]
    assert host.outputs() == before
    host.step(STEP, wind_velocity=[0.0, 0.0, 0.0])
    assert host.flags == (False, False, False, 2.0 * STEP)


@in_shared_process
def test_a_stop_before_the_start_is_refused(fmi3_folder):
    host = Host(fmi3_folder / "TetherDynamic.fmu")
    with pytest.raises(FMICallException):
        host.fmu.enterInitializationMode(startTime=2.0, stopTime=1.0)
    assert host.messages[-1].endswith("the stop time is 1.0 s; it must not be before the start time of 2.0 s")
    host.start()


@in_shared_process
def test_arrays_are_set_as_a_whole(fmi3_folder):
    host = Host(fmi3_folder / "TetherDynamic.fmu")
    reference = host.reference["kite_position"]
    for values in ([1.0], [1.0, 2.0], [1.0, 2.0, 3.0, 4.0]):
        with pytest.raises(FMICallException):
            host.fmu.setFloat64([reference], values)
        assert f"{len(values)} values were passed for variables that have 3" in host.messages[-1]
    for wrong in (reference + 1, host.reference["time"], host.reference["sag"]):
        with pytest.raises(FMICallException):
            host.fmu.setFloat64([wrong], [1.0])
        name = next((name for name, each in host.reference.items() if each == wrong), "no variable of this FMU")
        assert f"value reference {wrong} ({name}) cannot be set" in host.messages[-1]
    assert host.get("kite_position") == [300.0, 0.0, 400.0]
    with pytest.raises(FMICallException):
        host.fmu.setInt64([host.reference["segments"]], [5])
    host.set(kite_position=[1.0, 2.0, 3.0], segments=5, wind_profile=2)
    assert (host.get("kite_position"), host.get("segments"), host.get("wind_profile")) == ([1.0, 2.0, 3.0], 5, 2)


@in_shared_process
def test_simulate_fmu(fmi3_folder):
    """FMPy's own loop with arrays as start values and as outputs."""
    path, kite = fmi3_folder / "TetherDynamic.fmu", [0.0, 300.0, 400.0]
    start, output = {"initial_length": 525.0, "kite_position": kite}, ["kite_force", "sag"]
    result = fmpy.simulate_fmu(str(path), stop_time=1.0, output_interval=STEP, start_values=start, output=output)
    assert result["time"][-1] == pytest.approx(1.0)
    host = Host(path).start(**start)
    for now, then in pairwise(result["time"]):
        host.step(float(then - now))
    assert result["kite_force"][-1].tolist() == host.get("kite_force")
    assert result["sag"][-1] == host.get("sag")


@in_shared_process
def test_every_function_is_there(fmi3_folder, native_folder):
    for folder, version in ((native_folder, 2), (fmi3_folder, 3)):
        host = Host(folder / "TetherStraight.fmu")
        text = (HEADERS / f"fmi{version}FunctionTypes.h").read_text()
        names = set(re.findall(rf"fmi{version}\w+(?=TYPE)", text)) - {f"fmi{version}Callback", f"fmi{version}CallbackLogger"}
        assert len(names) > 20
        library = CDLL(host.fmu.dll._name)
        missing = [name for name in names if not hasattr(library, name) and "Callback" not in name]
        assert [name for name in missing if name not in ("fmi2StepFinished",)] == []


@in_shared_process
def test_what_is_not_offered_is_refused(fmi3_folder):
    host = Host(fmi3_folder / "TetherDynamic.fmu").start()
    before = blob_of(host)
    calls = (
        host.fmu.enterEventMode,
        host.fmu.enterStepMode,
        host.fmu.enterConfigurationMode,
        host.fmu.updateDiscreteStates,
        lambda: host.fmu.getDirectionalDerivative([19], [0], [1.0]),
        lambda: host.fmu.getClock([0]),
        lambda: host.fmu.setFloat32([0], [1.0]),
        lambda: host.fmu.getBoolean([0]),
    )
    for call in calls:
        host.messages.clear()
        with pytest.raises(FMICallException, match="error"):
            call()
        assert len(host.messages) == 1
    assert blob_of(host) == before


@in_shared_process
def test_instances_that_are_refused(fmi3_folder):
    host = Host(fmi3_folder / "TetherDynamic.fmu")
    for wrong in ({"eventModeUsed": True}, {"requiredIntermediateVariables": [19]}):
        with pytest.raises(Exception, match="Failed to instantiate"):
            host.fmu.instantiate(logMessage=host.log, **wrong)
        assert f"this FMU does not offer {next(iter(wrong))}; see" in host.messages[-1]
    host.fmu.guid = "{another}"
    with pytest.raises(Exception, match="Failed to instantiate"):
        host.fmu.instantiate(logMessage=host.log)
    assert "the guid or token is {another}; this FMU has {" in host.messages[-1]
    facts = {"unzipDirectory": host.folder, "modelIdentifier": "TetherDynamic", "guid": host.description.guid}
    with pytest.raises(Exception, match="Failed to instantiate"):
        FMU3Model(instanceName="model", **facts).instantiate(logMessage=host.log)
    assert "this FMU is for co-simulation only" in host.messages[-1]


def test_snippet_of_the_manual(native_folder, fmi3_folder, tmp_path):
    """It runs, and gives the same number twice."""
    page = (Path(__file__).parents[2] / "docs" / "use" / "importing.md").read_text(encoding="utf-8")
    snippet = next(re.finditer(r"^```python\n(.*?)^```$", page, re.MULTILINE | re.DOTALL))[1]
    for name, folder in (("native", native_folder), ("fmi3", fmi3_folder)):
        (tmp_path / name).symlink_to(folder, target_is_directory=True)
    done = subprocess.run([sys.executable, "-c", snippet], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    one, other = done.stdout.split()
    assert one == other
