"""The FMU of a system whose lines are driven by force and by length, in all flavours: the numbers of `TetherSystem`."""

import pytest

from isolation import in_shared_process
from runtime.host import Host
from tetherfmu import Solver, TetherSystem
from tetherfmu.files import system_files as files
from tetherfmu.runtime.limits import WORST_WORK_WITH_DRUM
from y_of_lines import y_of_lines

from .flavours import assert_checks_pass, build_all, every_flavour

BY_FORCE = "winch_control = 2\nwinch_mass = 20.0\nwinch_friction = 5.0"
BY_LENGTH = "winch_control = 3"
STEP = 0.02


@pytest.fixture(scope="session")
def winches(built_once):
    """Folder with the file, and an FMU of each flavour in a folder of its own."""

    def build(folder):
        (folder / "winches.toml").write_text(y_of_lines("TwoWinches", BY_FORCE, BY_LENGTH))
        build_all(folder, folder / "winches.toml")

    return built_once("system_winches", build)


@every_flavour
@pytest.mark.parametrize("fixed_step", [0.0, 0.01])
@in_shared_process
def test_the_numbers_of_the_python_api(winches, native, fixed_step):
    found = files.load(winches / "winches.toml")
    system = TetherSystem(found.points, found.lines, found.environment, Solver(fixed_step=fixed_step), found.ground)
    system.initialize(winch_lengths={"a": 39.0})
    host = Host(winches / str(native) / "TwoWinches.fmu").start(fixed_step=fixed_step)
    for k in range(20):
        force, length = 200.0 + 10.0 * k, 39.0 - 0.002 * k
        host.step(STEP, **{"main.winch_force": force, "a.winch_length": length})
        wanted = system.step(STEP, winch_forces={"main": force}, winch_lengths={"a": length})
        for name, line in wanted.lines.items():
            assert host.get(f"{name}.tether_length") == line.tether_length
            assert host.get(f"{name}.winch_speed") == line.winch_speed
            assert host.get(f"{name}.tension_to") == line.kite_tension
        assert host.get("solver_iterations") == system.counters["iterations"]
    assert wanted.lines["main"].tether_length != 100.0
    assert wanted.lines["main"].winch_speed != 0.0
    assert wanted.lines["a"].tether_length == pytest.approx(length, abs=0.01)
    assert host.get("solver_iteration_limit") == (2 * WORST_WORK_WITH_DRUM if fixed_step else 0)


@every_flavour
@in_shared_process
def test_stops_that_cross_are_refused_with_the_line(winches, native):
    host = Host(winches / str(native) / "TwoWinches.fmu")
    with pytest.raises(Exception, match="fmi"):
        host.start(**{"main.shortest_length": 50.0, "main.longest_length": 40.0})
    assert "the line main: shortest_length is 50" in str(host.messages)


def test_checks_pass(winches, capfd):
    assert_checks_pass(winches, capfd)
