"""The FMU of a system with winches that hold several lines, in all flavours: the numbers of `TetherSystem`."""

from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description

from isolation import in_shared_process
from runtime.host import STEP, Host
from tetherfmu import TetherSystem
from tetherfmu.export import systems

from .flavours import assert_checks_pass, build_all, every_flavour, go_astray_and_back

FILE = Path(__file__).parents[2] / "examples" / "systems" / "steered_kite.toml"
CONTROLS = {"length": ("winch_length", "winch_lengths"), "speed": ("reel_out_speed", "reel_out_speeds")}
WEIGHTS = {"left.load": (-900.0, 0.0, 1500.0), "right.load": (900.0, 0.0, 1500.0)}


@pytest.fixture(scope="session")
def folder(built_once):
    """Folder with the file for both controls, and an FMU of each flavour in a folder of its own."""

    def build(folder):
        text = FILE.read_text(encoding="utf-8")
        for control in CONTROLS:
            own = text.replace('"length"', f'"{control}"').replace("SteeredKite", control.title())
            (folder / f"{control}.toml").write_text(own, encoding="utf-8")
        build_all(folder, *folder.glob("*.toml"))

    return built_once("shared_winches", build)


@every_flavour
@pytest.mark.parametrize("control", CONTROLS)
@in_shared_process
def test_the_numbers_of_the_python_api(folder, native, control):
    """Bit for bit, also where a state is restored."""
    name, argument = CONTROLS[control]
    system = TetherSystem.from_file(folder / f"{control}.toml")
    loads = {vector.partition(".")[0]: load for vector, load in WEIGHTS.items()}
    system.initialize(loads=loads)
    host = Host(folder / str(native) / f"{control.title()}.fmu").start(**WEIGHTS)
    for k in range(20):
        given = {"steering": 0.001 * k, "depower": 0.0005 * k * k}
        if k == 10:
            go_astray_and_back(host, **{f"steering.{name}": 1.0})
        host.step(STEP, **{f"{winch}.{name}": value for winch, value in given.items()})
        wanted = system.step(STEP, **{argument: given})
        for line, own in wanted.lines.items():
            assert host.get(f"{line}.tether_length") == own.tether_length
            assert host.get(f"{line}.tension_from") == own.ground_tension
        for winch, own in wanted.winches.items():
            # sums of two products, in another order
            assert host.get(f"{winch}.payout") == pytest.approx(own.payout, abs=1e-13)
            assert host.get(f"{winch}.winch_speed") == pytest.approx(own.winch_speed, abs=1e-13)
    assert host.get("depower.payout") > 0.005


@every_flavour
def test_lines_in_winches_have_no_variables_of_a_winch(folder, native):
    names = {each.name for each in read_model_description(folder / str(native) / "Length.fmu").modelVariables}
    assert {"steering.winch_length", "depower.winch_length", "steering.winch_speed", "depower.payout"} <= names
    assert "main.reel_out_speed" in names
    assert not names & {f"tape_left.{what}" for what in ("reel_out_speed", "winch_length", "winch_control", "winch_mass")}


@every_flavour
@in_shared_process
def test_what_is_refused_names_the_winches(folder, native):
    host = Host(folder / str(native) / "Speed.fmu").start(**WEIGHTS)
    with pytest.raises(Exception, match=r"fmi|Discard"):
        host.step(STEP, **{"steering.reel_out_speed": float("nan")})
    assert "the input steering.reel_out_speed and depower.reel_out_speed is nan" in str(host.messages)


DRUM = """
name = "{name}"
[points]
ground = {{position = [0, 0, 0]}}
kite = {{position = [360, 0, 380]}}
[lines.line]
from = "ground"
to = "kite"
initial_length = 525.0
{winch}
"""


@in_shared_process
def test_derivatives_of_a_native_fmu_count_with_the_ratio(tmp_path, folder):
    """Of inputs bit for bit, as the ratio is a power of 2; of outputs as differences are."""
    hosts = {}
    for name, winch in {"Alone": "", "Held": "[winches.drum]\nlines = {line = -2}"}.items():
        (tmp_path / f"{name}.toml").write_text(DRUM.format(name=name, winch=winch), encoding="utf-8")
        hosts[name] = Host(systems.build(tmp_path / f"{name}.toml", tmp_path, native=2)).start()
    inputs = {"Alone": ("line.reel_out_speed", 1.0), "Held": ("drum.reel_out_speed", -0.5)}
    for k in range(4):
        for name, host in hosts.items():
            own, factor = inputs[name]
            host.fmu.setRealInputDerivatives([host.reference[own]], [1], [factor * 3.0])
            host.step(STEP, **{own: factor * 0.4 * k})
    found = {}
    for name, host in hosts.items():
        own, factor = inputs[name]
        forces = [host.reference[f"kite.force[{i}]"] for i in (1, 3)]
        found[name] = factor * np.array(host.fmu.getDirectionalDerivative(forces, [host.reference[own]], [1.0]))
    assert hosts["Alone"].get("line.tension_to") == hosts["Held"].get("line.tension_to")
    np.testing.assert_allclose(found["Held"], found["Alone"], rtol=1e-5)
    steered = Host(folder / "2" / "Speed.fmu").start(**WEIGHTS)
    place = steered.reference["steering.reel_out_speed"]
    steered.refuses(
        lambda: steered.fmu.setRealInputDerivatives([place], [1], [1.0]),
        "the derivative of steering.reel_out_speed cannot be used: it turns a line that another winch turns, too",
    )


def test_their_evidence_is_met(folder, capfd):
    assert_checks_pass(folder, capfd)
