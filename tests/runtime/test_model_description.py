"""The model description is valid, complete and offers the interface of docs/use/interface.md.

FMPy's validation and the XML schemas: `check/test_check.py`, `native/test_fmi3.py`.
"""

import logging
import math
import subprocess
import sys

import pytest
from fmpy import read_model_description
from fmu_manipulation_toolbox.checker import get_checkers
from fmu_manipulation_toolbox.operations import FMU

from isolation import in_shared_process
from running import status_of
from runtime.host import Host, description_of, every_flavour_and_version, of_every_flavour
from tetherfmu.export import archive
from tetherfmu.export.archive import SLAVES
from tetherfmu.export.build_options import BuildOptions
from tetherfmu.fmi.model_description import base_units
from tetherfmu.runtime.kernel_library import this_platform
from tetherfmu.runtime.variants import EVERY_VARIANT
from tetherfmu.wiring.variables import variables

VECTORS = {"input": ["ground_position", "ground_velocity", "wind_velocity"], "output": ["ground_force", "kite_force"]}
DRIVEN = {"input": ["kite_position", "kite_velocity"], "output": []}
FREE = {"input": ["kite_load"], "output": ["kite_position", "kite_velocity"]}
SCALARS = {
    "input": ["reel_out_speed", "winch_force", "winch_length", "release"],
    "output": [
        *("ground_tension", "kite_tension", "max_tension", "tether_length", "ground_elevation", "ground_azimuth"),
        *("slack_segments", "kite_end_mass", "kite_stiffness", "kite_damping", "wave_time", "sag"),
        *("winch_speed", "grounded_length", "peak_tension", "broken", "break_time"),
    ],
    "local": ["solver_steps", "solver_rejections", "solver_iterations", "solver_iteration_limit", "fallback_steps"],
}
SHAPE = [f"shape[{k},{i}]" for k in range(1, 22) for i in (1, 2, 3)]
PARAMETERS = {  # name: (start, unit), as the page says
    "segments": ("20", None),
    "initial_length": ("505", "m"),
    "diameter": ("0.004", "m"),
    "density": ("724", "kg/m3"),
    "axial_stiffness": ("614600", "N"),
    "axial_damping": ("473", "N.s"),
    "slack_stiffness_ratio": ("0.01", None),
    "slack_damping_ratio": ("1", None),
    "damping_law": ("1", None),
    "drag_coefficient": ("0.958", None),
    "breaking_force": ("0", "N"),
    "air_density": ("1.225", "kg/m3"),
    "air_density_scale_height": ("0", "m"),
    "gravity": ("9.81", "m/s2"),
    "wind_profile": ("1", None),
    "wind_reference_height": ("6", "m"),
    "wind_exponent": ("0.08163", None),
    "surface_roughness": ("0.0002", "m"),
    "relative_tolerance": ("0", None),
    "fixed_step": ("0", "s"),
    "fixed_step_method": ("1", None),
    "initial_shape": ("2", None),
    "end_velocities": ("1", None),
    "input_continuation": ("1", None),
    "winch_control": ("1", None),
    "winch_start": ("1", None),
    "winch_mass": ("0", "kg"),
    "winch_damping": ("0", "N.s/m"),
    "winch_friction": ("0", "N"),
    "shortest_length": ("0", "m"),
    "longest_length": ("0", "m"),
    "ground_contact": ("1", None),
    "ground_height": ("0", "m"),
    "ground_friction": ("0.5", None),
    "ground_sink": ("0.002", "m"),
}

PARAMETERS_OF_A_FREE_KITE = {
    "kite_mass": ("10", "kg"),
    "kite_start": ("1", None),
    **{f"initial_kite_position[{i}]": (start, "m") for i, start in enumerate(("300", "0", "400"), start=1)},
    **{f"initial_kite_velocity[{i}]": ("0", "m/s") for i in (1, 2, 3)},
}

every_fmu = pytest.mark.parametrize("name", list(SLAVES))


@every_fmu
def test_offers_the_plug(fmu_folder, name):
    description = description_of(fmu_folder / f"{name}.fmu")
    variables = {variable.name: variable for variable in description.modelVariables}
    is_free = name == "TetherDynamicFree"
    parameters = PARAMETERS | (PARAMETERS_OF_A_FREE_KITE if is_free else {})
    expected = set(parameters)
    for causality in ("input", "output"):
        vectors = VECTORS[causality] + (FREE if is_free else DRIVEN)[causality]
        names = SCALARS[causality] + [f"{each}[{i}]" for each in vectors for i in (1, 2, 3)]
        assert {variables[each].causality for each in names} == {causality}
        expected.update(names)
    assert {variables[each].causality for each in (*SCALARS["local"], *SHAPE)} == {"local"}
    expected.update(SCALARS["local"], SHAPE)
    assert set(variables) == expected
    for each, (start, unit) in parameters.items():
        assert (variables[each].start, variables[each].unit) == (start, unit)
        assert variables[each].causality == "parameter"
        assert variables[each].variability == "fixed"
    assert [variables[f"kite_position[{i}]"].start for i in (1, 2, 3)] == ([None] * 3 if is_free else ["300", "0", "400"])
    assert {variables[each].type for each in ("slack_segments", *SCALARS["local"])} == {"Integer"}
    enumerations = (
        "damping_law",
        "wind_profile",
        "fixed_step_method",
        "initial_shape",
        "end_velocities",
        "input_continuation",
    )
    assert {variables[each].type for each in enumerations} == {"Enumeration"}


@every_fmu
def test_variables_are_described(fmu_folder, name):
    description = description_of(fmu_folder / f"{name}.fmu")
    outputs = [variable for variable in description.modelVariables if variable.causality == "output"]
    assert all(variable.description for variable in description.modelVariables)
    assert [unknown.variable.name for unknown in description.outputs] == [variable.name for variable in outputs]
    assert [unknown.variable.name for unknown in description.initialUnknowns] == [variable.name for variable in outputs]
    assert all(unknown.dependencies == [] for unknown in description.outputs), "outputs change in steps only"
    assert description.defaultExperiment.stepSize == "0.02"
    assert description.coSimulation.canHandleVariableCommunicationStepSize
    assert description.coSimulation.canGetAndSetFMUstate
    assert description.coSimulation.canSerializeFMUstate


@every_fmu
def test_variables_have_quantity_nominal_and_true_limits(fmu_folder, name):
    description = description_of(fmu_folder / f"{name}.fmu")
    variables = {variable.name: variable for variable in description.modelVariables}
    for variable in variables.values():
        assert (variable.quantity is not None) == (variable.unit is not None)
        if variable.unit is not None and variable.causality != "parameter":
            assert float(variable.nominal) > 0.0
    displayed = {each: (variable.displayUnit, variable.unit) for each, variable in variables.items() if variable.displayUnit}
    angles = {"ground_elevation": ("deg", "rad"), "ground_azimuth": ("deg", "rad")}
    forces = {each: ("kN", "N") for each, variable in variables.items() if variable.unit == "N"}
    assert {"axial_stiffness", "kite_force[1]", "max_tension", "winch_force", "winch_friction"} <= set(forces)
    assert displayed == {"diameter": ("mm", "m"), "kite_stiffness": ("kN/m", "N/m"), **angles, **forces}
    factors = {shown.name: shown.factor for unit in description.unitDefinitions for shown in unit.displayUnits}
    assert factors == {"mm": 1e3, "deg": math.degrees(1.0), "kN": 1e-3, "kN/m": 1e-3}
    not_negative = (
        "tether_length",
        "kite_end_mass",
        "kite_stiffness",
        "kite_damping",
        "wave_time",
        "sag",
        "grounded_length",
        "slack_segments",
    )
    assert {variables[each].min for each in not_negative} == {"0"}
    assert float(variables["ground_azimuth"].max) == -float(variables["ground_azimuth"].min) == math.pi
    assert float(variables["ground_elevation"].max) == -float(variables["ground_elevation"].min) == math.pi / 2.0


@every_fmu
def test_every_choice_is_described(fmu_folder, name):
    description = description_of(fmu_folder / f"{name}.fmu")
    variables = {variable.name: variable for variable in description.modelVariables}
    items = {each: variable.declaredType.items for each, variable in variables.items() if variable.type == "Enumeration"}
    for each, choices in items.items():
        assert all(item.description for item in choices), each
        assert not any(";" in item.description for item in choices), "tables list them with semicolons"
        assert len({item.description for item in choices}) == len(choices)
    assert [(item.name, item.value) for item in items["winch_control"]] == [("speed", "1"), ("force", "2"), ("length", "3")]
    for item, given in zip(items["winch_control"], SCALARS["input"][:3], strict=True):
        assert given in item.description, "it names the input"
    assert variables["winch_control"].description == "quantity that controls the winch: speed, force or length"


@pytest.mark.parametrize("variant", EVERY_VARIANT)
def test_each_unit_has_a_quantity_and_base_units(variant):
    units = {each.quantity.unit for each in variables(variant, 2, wind_points=2)} - {""}
    assert all(base_units(unit) for unit in units)
    with pytest.raises(ValueError, match=r"the unit N.s/m2 has no quantity and no base units: add it to UNITS in fmi/model"):
        base_units("N.s/m2")


def test_the_shape_of_an_fmu_with_wind_points_is_an_output(tmp_path):
    """It is connected, to find the wind there; counters are local all the same."""
    description = read_model_description(str(archive.build("TetherStraight", tmp_path, BuildOptions(wind_points=3))))
    of = {variable.name: variable.causality for variable in description.modelVariables}
    assert {of[each] for each in SHAPE} == {"output"}
    assert {of[each] for each in SCALARS["local"]} == {"local"}
    found = {unknown.variable.name for unknown in description.initialUnknowns}
    assert found == {each for each in of if of[each] == "output"}


@every_fmu
def test_common_variables_have_one_order_and_are_the_same(fmu_folder, name):
    """Also their value references, so that a tool which keeps numbers instead of names can change the file, too.

    The motion of the kite is an input or an output, so a connection to it has to be changed anyway.
    """
    facts = ("valueReference", "causality", "variability", "initial", "type", "unit", "start", "min", "max")
    found, expected = (
        {variable.name: [getattr(variable, fact) for fact in facts] for variable in description_of(path).modelVariables}
        for path in (fmu_folder / f"{name}.fmu", fmu_folder / "TetherDynamic.fmu")
    )
    motion = {f"kite_{what}[{i}]" for what in ("position", "velocity") for i in (1, 2, 3)}
    common = [each for each in found if each in expected and each not in motion]
    assert [found[each] for each in common] == [expected[each] for each in common]
    assert common == [each for each in expected if each not in motion]


def test_builder_options_and_equal_bytes(tmp_path):
    for folder in ("a", "b"):
        options = ["TetherDynamic", "--segments", "7", "--shape-points", "0", "--out", str(tmp_path / folder)]
        done = subprocess.run([sys.executable, "build_fmus.py", *options], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        assert "TetherDynamic.fmu" in done.stdout
        assert f"for {this_platform()}\n" in done.stdout
    description = read_model_description(str(tmp_path / "a" / "TetherDynamic.fmu"))
    variables = {variable.name: variable for variable in description.modelVariables}
    assert variables["segments"].start == "7"
    assert not any(each.startswith("shape") for each in variables)
    assert (tmp_path / "a" / "TetherDynamic.fmu").read_bytes() == (tmp_path / "b" / "TetherDynamic.fmu").read_bytes()


@pytest.mark.parametrize("options", [["NoTether"], ["--segments", "0"], ["--segments", "301"], ["--shape-points", "-1"]])
def test_builder_refuses_wrong_options(tmp_path, options, capsys):
    assert status_of("build", "--out", str(tmp_path), *options) == 2
    assert options[-1] in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@every_flavour_and_version
@in_shared_process
def test_booleans_in_the_description(fmu_folder):
    variables = {each.name: each for each in description_of(fmu_folder / "TetherDynamic.fmu").modelVariables}
    for name, causality in (("release", "input"), ("broken", "output")):
        assert variables[name].type == "Boolean"
        assert (variables[name].causality, variables[name].variability) == (causality, "discrete")
    assert variables["release"].start == "false"
    host = Host(fmu_folder / "TetherDynamic.fmu")
    host.refuses(lambda: host.fmu.setBoolean([host.reference["broken"]], [True]), "broken")


@of_every_flavour("name")
def test_toolbox(fmu_folder, caplog, name):
    """Checkers of fmu-manipulation-toolbox tell a problem in the log only."""
    caplog.set_level(logging.INFO)
    checkers = [checker() for checker in get_checkers()]
    with FMU(str(fmu_folder / f"{name}.fmu")) as fmu:
        for checker in checkers:
            fmu.apply_operation(checker)
    assert [record.message for record in caplog.records if record.levelno > logging.INFO] == []
    assert caplog.messages[-1] == "No semantic error against the FMI-2 standard."
