"""Winches that hold several lines and start in equilibrium, or with a speed, in FMUs of all flavours: as `TetherSystem`."""

from dataclasses import replace

import pytest

from isolation import in_shared_process
from runtime.host import STEP, Host
from tetherfmu import TetherSystem
from tetherfmu.files import system_files as files

from .flavours import build_all, every_flavour

FILE = """
name = "{name}"
[points]
left = {{position = [-6, 0, 30]}}
right = {{position = [6, 0, 30]}}
far = {{position = [0, 12, 31]}}
load = {{mass = 60.0}}
[lines]
a = {{from = "left", to = "load", initial_length = 9.0, segments = 3}}
b = {{from = "right", to = "load", initial_length = 9.5, segments = 3}}
c = {{from = "far", to = "load", initial_length = 15.0, segments = 3}}
[winches]
trim = {{lines = {{a = 1, b = -1}}, control = "{control}"{trim}}}
lift = {{lines = {{a = 0.5, b = 0.5, c = 1}}, control = "{control}"{lift}}}
"""
OF_DRUMS = {
    "trim": ', winch_force = 25.0, winch_start = "equilibrium", winch_mass = 10.0',
    "lift": ', winch_force = "0.9 kN", winch_start = "equilibrium", winch_mass = 20.0, winch_friction = 5.0',
}
LOAD = (0.0, 15.0, 40.0)
GIVEN = 1


@pytest.fixture(scope="session")
def folder(built_once):
    """Folder with a file for each control, and an FMU of each flavour in a folder of its own."""

    def build(folder):
        (folder / "drums.toml").write_text(FILE.format(name="Drums", control="force", **OF_DRUMS), encoding="utf-8")
        no_drums = dict.fromkeys(OF_DRUMS, "")
        (folder / "lengths.toml").write_text(FILE.format(name="Lengths", control="length", **no_drums), encoding="utf-8")
        build_all(folder, folder / "drums.toml", folder / "lengths.toml")

    return built_once("shared_winch_starts", build)


def assert_same(host, outputs):
    """Bit for bit; payouts are sums of products in another order."""
    for line, own in outputs.lines.items():
        assert host.get(f"{line}.tether_length") == own.tether_length
        assert host.get(f"{line}.tension_from") == own.ground_tension
    assert list(host.get("load.position")) == outputs.points["load"].position.tolist()
    for winch, own in outputs.winches.items():
        assert host.get(f"{winch}.payout") == pytest.approx(own.payout, abs=1e-12)
        assert host.get(f"{winch}.winch_speed") == pytest.approx(own.winch_speed, abs=1e-12)


def system_of(path, **of_winches):
    """`TetherSystem` of a file whose winches have other values."""
    found = files.load(path)
    winches = [replace(each, **of_winches) for each in found.winches]
    return TetherSystem(found.points, found.lines, found.environment, found.solver, found.ground, winches=winches)


@every_flavour
@in_shared_process
def test_drums_start_in_equilibrium(folder, native):
    system = TetherSystem.from_file(folder / "drums.toml")
    start = system.initialize(loads={"load": LOAD})
    a, b, c = (start.lines[name].ground_tension for name in "abc")
    assert (a - b, 0.5 * (a + b) + c) == pytest.approx((25.0, 900.0), rel=1e-8)
    host = Host(folder / str(native) / "Drums.fmu").start(**{"load.load": LOAD})
    assert_same(host, start)
    for k in range(10):
        forces = {"trim": 25.0 + k * k, "lift": 900.0 - k}
        host.step(STEP, **{f"{name}.winch_force": force for name, force in forces.items()})
        assert_same(host, system.step(STEP, winch_forces=forces))


@every_flavour
@pytest.mark.parametrize("start", [{}, {"winch_start": GIVEN}])
@in_shared_process
def test_drums_start_with_a_speed(folder, native, start):
    system = system_of(folder / "drums.toml", **start)
    outputs = system.initialize(reel_out_speeds={"lift": 0.25})
    assert outputs.lines["a"].winch_speed == pytest.approx(0.125, abs=1e-15)
    given = {f"{name}.{own}": value for name in OF_DRUMS for own, value in start.items()}
    host = Host(folder / str(native) / "Drums.fmu").start(**{"lift.reel_out_speed": 0.25, **given})
    assert_same(host, outputs)
    for _ in range(5):
        host.step(STEP)
        assert_same(host, system.step(STEP))
    assert not host.messages


@every_flavour
@in_shared_process
def test_winches_by_length_start_with_a_speed(folder, native):
    system = TetherSystem.from_file(folder / "lengths.toml")
    outputs = system.initialize(reel_out_speeds={"lift": 0.25, "trim": -0.1})
    host = Host(folder / str(native) / "Lengths.fmu").start(**{"lift.reel_out_speed": 0.25, "trim.reel_out_speed": -0.1})
    assert_same(host, outputs)
    assert outputs.lines["b"].winch_speed == pytest.approx(0.225, abs=1e-15)
    for _ in range(5):
        host.step(STEP)
        assert_same(host, system.step(STEP))


REFUSED = {
    "no balance": (
        {"lift.winch_force": 1.0},
        "lift.winch_force, 1.0 N, with trim.winch_start and lift.winch_start 2 (equilibrium)",
    ),
    "no choice": ({"trim.winch_start": 3}, "winch_start is 3; it must be one of 1 (given), 2 (equilibrium)"),
    "no number": ({"trim.reel_out_speed": float("nan")}, "trim.reel_out_speed"),
}


@every_flavour
@pytest.mark.parametrize("refused", REFUSED.values(), ids=REFUSED)
@in_shared_process
def test_what_cannot_be_is_refused_in_words(folder, native, refused):
    values, says = refused
    Host(folder / str(native) / "Drums.fmu").refuses_to_start(says, **values)
