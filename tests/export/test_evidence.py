"""The evidence set is what FMI's cross-check asks for, and its reference does not come from the FMU."""

import csv
import io
import posixpath
import re
import zipfile
from functools import cache
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy import read_model_description

from runtime.host import of_every_flavour
from tetherfmu.export import evidence
from tetherfmu.export.archive import SLAVES
from tetherfmu.export.documents import EVIDENCE_FOLDER
from tetherfmu.python import models
from tetherfmu.runtime.parameters import DEFAULT_TOLERANCE, Tether
from tetherfmu.runtime.variants import BY_NAME

dynamic = pytest.mark.parametrize("model", [models.TetherDynamic, models.TetherDynamicFree])
ENDS = ("in.csv", "ref.csv", "ref.opt")
OPTIONS = {"StartTime", "StopTime", "StepSize", "RelTol"}
OURS = {"OutputIntervalLength", "AllowedDeviation"}
every_fmu = pytest.mark.parametrize("name", list(SLAVES))


def files(path):
    """Texts of the evidence set in an FMU, by file name."""
    with zipfile.ZipFile(path) as archive:
        names = [entry for entry in archive.namelist() if entry.startswith("documentation/evidence/")]
        return {entry.rpartition("/")[2]: archive.read(entry).decode("ascii") for entry in names}


def columns(text):
    """Columns of a CSV file as arrays."""
    head, *rows = csv.reader(io.StringIO(text))
    return dict(zip(head, np.array(rows, dtype=float).T, strict=True))


@every_fmu
def test_files_obey_the_rules_of_the_cross_check(fmu_folder, name):
    """Names, at most 10 outputs, quoted names in the first line, time first and rising, below 1 MB, all inputs, options."""
    found = files(fmu_folder / f"{name}.fmu")
    kinds = [name, *(f"{name}_{kind}" for kind in evidence.GIVEN)]
    assert sorted(found) == sorted(["README.txt", *(f"{each}_{end}" for each in kinds for end in ENDS)])
    variables = {each.name: each for each in read_model_description(str(fmu_folder / f"{name}.fmu")).modelVariables}
    for kind in kinds:
        obeys_the_rules(kind, found, variables)
    assert set(columns(found[f"{name}_in.csv"])) - {"time"} == {
        n for n, v in variables.items() if v.causality == "input" and v.type != "Boolean"
    }


def obeys_the_rules(kind, found, variables):
    """Files of one set; what is no option of the cross-check is a start value of a parameter."""
    options = dict(line.split(", ") for line in found[f"{kind}_ref.opt"].splitlines())
    assert set(options) >= OPTIONS
    assert {variables[each].causality for each in set(options) - OPTIONS - OURS} <= {"parameter"}
    for file, causality in ((f"{kind}_in.csv", "input"), (f"{kind}_ref.csv", "output")):
        assert len(found[file]) < 1_000_000
        assert all(each.startswith('"') for each in found[file].splitlines()[0].split('",'))
        table = columns(found[file])
        names = list(table)
        assert names[0] == "time"
        assert {variables[each].causality for each in names[1:]} == {causality}
        assert np.all(np.diff(table["time"]) > 0.0)
        assert (table["time"][0], table["time"][-1]) == (float(options["StartTime"]), float(options["StopTime"]))
    assert len(names) - 1 <= 10


def test_the_scene_moves_what_it_says():
    """Velocities are the derivatives of the positions; the kite flies out, the tether pays out, the wind rises."""
    h = 1e-4
    for time in (0.0, 1.3, 4.0, 6.7, 9.9):
        ahead, back = (np.array(evidence.inputs_at(time + s)["kite_position"]) for s in (h, -h))
        # the rises have jumps in their second derivative: first order there, h times an acceleration of some m/s2
        np.testing.assert_allclose((ahead - back) / (2.0 * h), evidence.inputs_at(time)["kite_velocity"], atol=1e-3)
    start, end = evidence.inputs_at(0.0), evidence.inputs_at(10.0)
    assert start["kite_position"] == (300.0, 0.0, 400.0)
    assert np.linalg.norm(end["kite_position"]) == pytest.approx(509.0)
    assert end["kite_position"][1] > 150.0
    assert (start["reel_out_speed"], end["reel_out_speed"]) == (0.0, 0.5)
    assert (start["wind_velocity"][0], end["wind_velocity"][0]) == (0.0, 8.0)


def deviation(model, relative_tolerance):
    """Largest difference of a dynamic tether's kite_tension from the reference, as a part of the largest tension."""
    made = evidence.flight(model, Tether())
    place = made.outputs.index("kite_tension")
    reference, tensions = (np.array(evidence.reference(made, each))[:, place] for each in (None, relative_tolerance))
    return np.abs(reference - tensions).max() / reference.max()


@dynamic
def test_the_reference_is_far_better_than_what_is_allowed(model):
    """A tolerance ten times tighter moves the reference of a dynamic tether by less than 1e-4 of the allowed deviation."""
    finer = 0.1 * evidence.flight(model, Tether()).reference_tolerance
    assert deviation(model, finer) < 1e-4 * BY_NAME[model.variant].evidence_deviation


@dynamic
def test_the_default_tolerance_stays_well_within_what_is_allowed(model):
    assert 1e-6 < deviation(model, DEFAULT_TOLERANCE) < 1e-3


@pytest.mark.parametrize("diameter", [0.004, 0.5])
def test_the_load_begins_with_what_holds_a_free_kite(diameter):
    tether = Tether().with_diameter(diameter)
    (first, *_) = evidence.flight(models.TetherDynamicFree, tether).scene
    balance = np.array(first["kite_load"]) + models.TetherDynamicFree(tether).initialize().kite_force
    np.testing.assert_allclose(balance, (0.0, 0.0, 10.0 * 9.81), atol=1e-3)  # 10 digits of up to 1e6 N


def test_a_free_kite_is_pulled_taut():
    tether = models.TetherDynamicFree()
    tether.initialize()
    scene = evidence.flight(models.TetherDynamicFree, Tether()).scene
    outputs = [tether.step(evidence.STEP, **inputs) for inputs in scene[:-1]]
    assert outputs[-1].kite_tension > 3.0 * outputs[0].kite_tension
    assert max(each.kite_position[1] for each in outputs) > 20.0


@cache
def set_of(model, segments):
    """Files of the evidence set of a tether with so many segments."""
    name = model.__name__
    return evidence.files(name, [evidence.flight(model, Tether(segments=segments))], model=name, scene="", more="")


@dynamic
@pytest.mark.parametrize("segments", [1, 300])
def test_the_set_belongs_to_the_start_values_of_the_fmu(model, segments):
    """Also with the fewest and with the most segments that a builder may ask for."""
    name, made, usual = model.__name__, set_of(model, segments), set_of(model, 20)
    same = made[f"{name}_in.csv"] == usual[f"{name}_in.csv"]
    assert same == (model is models.TetherDynamic)  # the load of a free kite begins with the force of its tether
    assert made[f"{name}_ref.csv"] != usual[f"{name}_ref.csv"]


def test_digits_hide_the_last_bit_of_a_zero():
    assert evidence.text_of(-3e-15, 8) == "0"
    assert evidence.text_of(123.456789012, 8) == "123.45679"


@pytest.mark.parametrize("kind", list(evidence.GIVEN))
@dynamic
def test_the_reference_of_a_winch_is_far_better_than_what_is_allowed(model, kind):
    """A tolerance ten times tighter moves it by less than 1e-2 of the allowed deviation, the drum's stops included."""
    made = evidence.winch_set(kind, model, Tether())
    usual = np.array(evidence.reference(made))
    moved = np.abs(evidence.reference(made, 0.1 * made.reference_tolerance) - usual).max(axis=0)
    assert np.all(moved <= 1e-2 * BY_NAME[model.variant].evidence_deviation * largest(usual))


def largest(rows):
    """Largest size in each column, the three of a position together."""
    sizes = np.abs(rows).max(axis=0)
    sizes[4:] = sizes[4:].max(initial=0.0)
    return sizes


@pytest.mark.parametrize("model", [models.TetherQuasiSteady, models.TetherDynamic])
def test_the_drum_does_what_the_set_says(model):
    """Still as long as the pull differs from the tension by less than the friction; taut; slack and at its stop."""
    made = evidence.winch_set("force", model, Tether())
    tension, _, length, speed = np.transpose(evidence.reference(made))
    pull = np.array([each["winch_force"] for each in made.scene])
    first = int(np.argmax(np.abs(pull - tension[0]) > made.starts["winch_friction"]))
    assert first > 10
    assert np.all(speed[: first - 1] == 0.0)
    assert speed.min() < -1.0
    assert tension.max() > 5.0 * tension[0]
    assert length.min() < 501.0 < length[-1] == made.starts["longest_length"]
    assert speed[-1] == 0.0
    assert tension[-1] < tension[0]


def test_a_long_flight_says_how_far_it_is(monkeypatch):
    """A text each time that the patience ends; here with each step."""
    monkeypatch.setattr(evidence, "PATIENCE", -1.0)
    made, said = evidence.flight(models.TetherDynamic, Tether(segments=2)), []
    evidence.reference(made, now=said.append)
    count = len(made.scene) - 1
    assert said == [f"{k} of {count} steps" for k in range(count)]


# --- the manifest of related files


FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
NAMESPACE = "{http://fmi-standard.org/fmi-ls-manifest}"
FIXED = {  # by the schema of 1.0.0-beta.1
    "fmi-ls-name": "org.fmi-standard.fmi-ls-ref",
    "fmi-ls-version": "1.0.0-beta.1",
    "fmi-ls-description": "Layered Standard providing information on related files included in an FMU.",
}
ROLES = re.compile(
    "document|requirement|specification|model|parameter|system|testcase|result|method|rationale|report|request|delivery|"
    "configuration|signature|meta-data|other|experiment(/(smoke-test|validation|uncertainty-analysis))?|serialized-state(/.*)?"
)


@of_every_flavour("name")
def test_names_every_file_of_the_evidence_set(fmu_folder, name):
    with zipfile.ZipFile(fmu_folder / f"{name}.fmu") as archive:
        names = archive.namelist()
        root = ElementTree.fromstring(archive.read(f"{FOLDER}/fmi-ls-manifest.xml"))
    assert root.tag == "fmiReferences"
    assert root.attrib == {f"{NAMESPACE}{key}": value for key, value in FIXED.items()}
    assert all(set(each.attrib) == {"type", "source", "role", "description"} for each in root)
    assert all(each.tag == "Related" and ROLES.fullmatch(each.get("role")) for each in root)
    found = [posixpath.normpath(posixpath.join(FOLDER, each.get("source"))) for each in root]
    assert found == sorted(each for each in names if each.startswith(EVIDENCE_FOLDER))
    assert len(found) == 1 + 3 * 3
