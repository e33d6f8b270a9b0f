"""The advisor judges scenes with a free end: a load on a crane, one under a ship in waves, a mass that a force pulls."""

import zipfile
from dataclasses import replace

import numpy as np
import pytest
from fmpy import read_model_description

from advice.random_scenes import random_scenes
from build_fmus import main as build
from isolation import in_own_process
from study.scenes_of_tests import written
from tetherfmu.__main__ import main
from tetherfmu.files.scene_files import Wind, load
from tetherfmu.runtime import layout as at
from tetherfmu.study.advice.configurations import ladder, measure
from tetherfmu.study.advice.scene_advice import FAST_BUDGET, advise
from tetherfmu.study.measuring.errors import converged, power_error
from tetherfmu.study.measuring.runs import Config, parameters_of, run

WIRE = """
[tether]
initial_length = "80 m"
diameter = "12 mm"
density = 5080
axial_stiffness = 5.82e6
axial_damping = 9650
"""
SCENES = {
    "crane": f"""
duration = "12 s"
[flight]
kind = "free_end"
kite_mass = "500 kg"
radius = "30 m"
rate = "0.1 rad/s"
speed = "-1 m/s"
{WIRE}
[wanted]
outputs = ["ground_force", "shape", "power"]
allowed_error = "1 %"
""",
    "ship": f"""
duration = "12 s"
[flight]
kind = "free_end"
kite_mass = "2000 kg"
heave = "1 m"
heave_period = "7 s"
{WIRE}
[wanted]
outputs = ["kite_force"]
allowed_error = "1 %"
communication_step = "20 ms"
""",
    "balloon": """
duration = "12 s"
[flight]
kind = "free_end"
kite_mass = "20 kg"
pull = "1200 N"
elevation = "60 deg"
height = "0 m"
heave = "0.5 m"
[tether]
initial_length = "150 m"
[wind]
velocity = [8.0, 0.0, 0.0]
[wanted]
outputs = ["kite_force", "kite_direction"]
allowed_error = "3 %"
""",
}


@pytest.fixture(scope="module", params=SCENES)
def scene(request, tmp_path_factory):
    return load(written(tmp_path_factory.mktemp("free_end"), SCENES[request.param], request.param))


def test_it_starts_at_rest(scene):
    """Nothing moves yet: the first force is that of the mass, with half of the tether, under weight and pull."""
    mass = scene.flight.kite_mass + 0.5 * scene.tether.mass_per_length * scene.tether.initial_length
    force = np.linalg.norm(scene.flight.load() - (0.0, 0.0, 9.81 * mass))
    still = {"rate": 0.0, "speed": 0.0, "heave": 0.0}
    calm = replace(scene, flight=replace(scene.flight, **still), wind=Wind())
    flown = run(calm, Config("dynamic", 20, 1e-6, 0.02)).flown
    tension = np.linalg.norm(flown.kite_force - flown.ground_force, axis=1) / 2.0  # the mean of both ends
    np.testing.assert_allclose(tension, force, rtol=0.01)  # the sag of a slanting tether


@pytest.mark.parametrize("budget", [15.0, FAST_BUDGET])
def test_the_verdict_is_true(scene, budget):
    """Measured anew against a finer reference."""
    names, allowed = scene.wanted.outputs, scene.wanted.allowed_error
    reference = converged(scene, 0.1 * allowed, names)
    advice = advise(scene, budget)
    error = measure(scene, advice.point.config, reference.run.flown).error(names)
    assert advice.point.config.variant == "dynamic"
    assert advice.met
    assert error <= allowed
    assert advice.least - reference.own_error(names) <= error <= advice.expected + reference.own_error(names)


def test_only_the_dynamic_tether_can_do_it(scene):
    assert {config.variant for config in ladder(scene)} == {"dynamic"}


def test_power_is_that_of_the_free_end(scene):
    """A velocity of the mass that is 10 % wrong gives a power that is 10 % wrong."""
    flown = run(scene, Config("dynamic", 8, 1e-6, 0.02)).flown
    outputs = flown.outputs.copy()
    outputs[:, at.OUTPUT_KITE_VELOCITY : at.OUTPUT_KITE_VELOCITY + 3] *= 1.1
    assert power_error(scene, flown._replace(outputs=outputs), flown, 0) == pytest.approx(0.1, rel=1e-6)


def test_the_command_names_the_fmu_and_why_no_other(tmp_path, capsys):
    assert main(["advise", str(written(tmp_path, SCENES["crane"], "crane"))]) == 0
    said = capsys.readouterr().out
    assert "use       TetherDynamicFree.fmu" in said
    assert "why not   the other tethers: they need the motion of the kite end, which is free here" in said


@pytest.mark.parametrize(
    ("text", "wrong"), [('kite_mass = "500 kg"', 'kite_mass = "-1 kg"'), ('radius = "30 m"', 'distance = "30 m"')]
)
def test_a_wrong_key_is_told(tmp_path, capsys, text, wrong):
    assert main(["advise", str(written(tmp_path, SCENES["crane"].replace(text, wrong), "crane"))]) == 2
    assert f"flight.{wrong.partition(' ')[0]}" in capsys.readouterr().err


def test_random_scenes_have_prescribed_ends():
    assert not any(scene.kite_is_free for scene in random_scenes(9, 1))


@in_own_process
def test_its_fmu_flies_as_the_python_api_does(tmp_path):
    from runtime.host import Host

    path = written(tmp_path, SCENES["balloon"], "balloon")
    assert build(["--scene", str(path), "--out", str(tmp_path)]) == 0
    (fmu,) = tmp_path.glob("*_balloon.fmu")
    scene = load(path)
    config = advise(scene).point.config
    description = read_model_description(fmu)
    names = {variable.name.partition("[")[0]: variable.causality for variable in description.modelVariables}
    assert names["kite_load"] == "input"
    assert names["kite_position"] == "output"
    with zipfile.ZipFile(fmu) as archive:
        assert "measured against dynamic" in archive.read("documentation/index.html").decode("utf-8")
    host, load_of_kite = Host(fmu), scene.flight.load()
    exact = parameters_of(scene, config)  # the start values of the FMU have 12 digits
    host.start(**{name: value for name, value in exact.items() if name in host.reference})
    for row in scene.inputs(config.step):
        host.step(config.step, kite_load=load_of_kite, ground_position=row[6:9], ground_velocity=row[9:12])
    assert host.get("kite_force") == run(scene, config).flown.kite_force[-1].tolist()
