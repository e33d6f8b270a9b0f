"""The FMU of a system with winches that hold several lines by force, beside a sheave, in all flavours: as `TetherSystem`."""

import pytest
from fmpy import read_model_description

from isolation import in_shared_process
from runtime.host import STEP, Host, blob_of, restore
from shared_drums import SHARED, TEXT
from tetherfmu import TetherSystem
from tetherfmu.check.__main__ import main as check
from tetherfmu.export import systems

FLAVOURS = {0: "2.0", 2: "2.0", 3: "3.0"}


@pytest.fixture(scope="session")
def folder(built_once):
    """Folder with the file, and an FMU of each flavour in a folder of its own."""

    def build(folder):
        (folder / "drums.toml").write_text(TEXT, encoding="utf-8")
        (folder / "shared.toml").write_text(SHARED, encoding="utf-8")
        for native in FLAVOURS:
            systems.build(folder / "drums.toml", folder / str(native), native=native or None)
            systems.build(folder / "shared.toml", folder / str(native), native=native or None)

    return built_once("shared_drums", build)


@pytest.mark.parametrize("native", FLAVOURS)
@pytest.mark.parametrize("strength", [0.0, 330.0])
@in_shared_process
def test_the_numbers_of_the_python_api(folder, native, strength):
    """Bit for bit, also where a state is restored, with other parameters of a drum, and where a line breaks [N]."""
    line = 'to = "load"\n'
    text = TEXT.replace("winch_mass = 8", "winch_mass = 4").replace(line, f"{line}breaking_force = {strength}\n")
    (folder / str(native) / "other.toml").write_text(text, encoding="utf-8")
    system = TetherSystem.from_file(folder / str(native) / "other.toml")
    system.initialize(winch_forces={"c": 30.0})
    host = Host(folder / str(native) / "Drums.fmu").start(
        **{"power.winch_mass": 4.0, "c.winch_force": 30.0, "a.breaking_force": strength}
    )
    for k in range(20):
        given = {"steering": 200.0 + 10.0 * k, "power": 300.0 - 5.0 * k, "c": 30.0 + 8.0 * k}
        if k == 10:
            blob = blob_of(host)
            host.step(STEP, **{"power.winch_force": 700.0})
            restore(host, blob)
        host.step(STEP, **{f"{name}.winch_force": value for name, value in given.items()})
        wanted = system.step(STEP, winch_forces=given)
        for line, own in wanted.lines.items():
            assert host.get(f"{line}.tether_length") == own.tether_length
            assert host.get(f"{line}.tension_from") == own.ground_tension
            assert host.get(f"{line}.break_time") == own.break_time
        assert host.get("load.position[3]") == wanted.points["load"].position[2]
        for winch, own in wanted.winches.items():
            # sums of two products, in another order
            assert host.get(f"{winch}.payout") == pytest.approx(own.payout, abs=1e-13)
            assert host.get(f"{winch}.winch_speed") == pytest.approx(own.winch_speed, abs=1e-13)
    assert host.get("a.broken") == (strength > 0.0)
    assert host.get("power.winch_speed") != 0.0
    assert host.get("c.winch_speed") != 0.0


@pytest.mark.parametrize("native", FLAVOURS)
def test_variables(folder, native):
    """Of a winch its input and its drum; of its lines nothing of a winch."""
    names = {each.name for each in read_model_description(folder / str(native) / "Drums.fmu").modelVariables}
    assert {"steering.winch_force", "power.winch_mass", "power.winch_damping", "steering.winch_friction"} <= names
    assert {"steering.winch_speed", "power.payout", "c.winch_force", "c.winch_mass"} <= names
    assert {"a.release", "a.broken", "c.release"} <= names
    assert {"steering.winch_start", "steering.reel_out_speed"} <= names  # parameters of its start
    assert not names & {"a.winch_force", "a.winch_mass", "a.winch_start", "a.reel_out_speed"}


@pytest.mark.parametrize("native", FLAVOURS)
@in_shared_process
def test_what_is_refused(folder, native):
    """With the name of the winch; parameters that cannot be with the name of the line."""
    host = Host(folder / str(native) / "Drums.fmu").start()
    with pytest.raises(Exception, match=r"fmi|Discard"):
        host.step(STEP, **{"steering.winch_force": float("nan")})
    assert "the input steering.winch_force is nan" in str(host.messages)
    host = Host(folder / str(native) / "Drums.fmu")
    with pytest.raises(Exception, match=r"fmi|Discard"):
        host.start(**{"c.winch_control": 2, "c.longest_length": 50.0})
    assert "the line c: shortest_length or longest_length is given for a line over sheaves" in str(host.messages)


def test_their_evidence_is_met(folder, capfd):
    assert check([str(folder / str(native) / "Shared.fmu") for native in FLAVOURS]) == 0
    assert capfd.readouterr().out.count("evidence set: 100 steps") == len(FLAVOURS)
