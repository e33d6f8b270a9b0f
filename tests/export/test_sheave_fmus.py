"""The FMU of a system with lines over sheaves, in all flavours: the numbers of `TetherSystem`."""

from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description

from isolation import in_shared_process
from runtime.host import STEP, Host
from tetherfmu import PlausibilityWarning, Solver, TetherSystem
from tetherfmu.export import systems
from tetherfmu.export.build_options import BuildOptions

from .flavours import FLAVOURS, assert_checks_pass, build_all, every_flavour, go_astray_and_back

FILES = Path(__file__).parents[2] / "examples" / "systems"
NAMES = {"TwoFallHoist": ("two_fall_hoist", "hoist"), "Atwood": ("atwood", "rope")}
WIND_POINTS = 3
OF_PORTIONS = {"length": "portion_length", "tension_from": "portion_tension_from", "tension_to": "portion_tension_to"}
OF_SHEAVES = {"payout": "sheave_payout", "speed": "sheave_speed"}


@pytest.fixture(scope="session")
def folder(built_once):
    """Folder with an FMU of each file and each flavour, in a folder of its own."""

    def build(folder):
        build_all(folder, *(FILES / f"{file}.toml" for file, _ in NAMES.values()))
        for native in FLAVOURS:
            options = BuildOptions(shape_points=None, wind_points=WIND_POINTS)
            systems.build(FILES / "two_fall_hoist.toml", folder / f"wind_{native}", options, native=native or None)

    return built_once("sheaves", build)


@every_flavour
@pytest.mark.parametrize("name", NAMES)
@in_shared_process
def test_the_numbers_of_the_python_api(folder, native, name):
    """Bit for bit, also where a state is restored."""
    file, line = NAMES[name]
    system = TetherSystem.from_file(FILES / f"{file}.toml")
    system.initialize()
    host = Host(folder / str(native) / f"{name}.fmu").start()
    for k in range(20):
        if k == 10:
            go_astray_and_back(host, **{f"{line}.reel_out_speed": 1.0})
        host.step(STEP, **{f"{line}.reel_out_speed": -0.01 * k})
        wanted = system.step(STEP, reel_out_speeds={line: -0.01 * k})
        own, portions = wanted.lines[line], wanted.portions[line]
        found = {"tether_length": own.tether_length, "tension_from": own.ground_tension, "tension_to": own.kite_tension}
        found |= {"max_tension": own.max_tension, "peak_tension": own.peak_tension, "winch_speed": own.winch_speed}
        for ours, theirs in (OF_PORTIONS | OF_SHEAVES).items():
            found |= {f"{theirs}[{i + 1}]": value for i, value in enumerate(getattr(portions, ours).tolist())}
        last = len(own.shape) + len(portions.payout)  # the point at a sheave ends one portion and begins the next
        found |= {f"shape[{last},3]": own.shape[-1, 2]}
        assert {each: host.get(f"{line}.{each}") for each in found} == found
        for point in wanted.points:
            if point in system._instance.free:
                assert host.get(f"{point}.position[3]") == wanted.points[point].position[2]
            else:
                assert host.get(f"{point}.force[3]") == wanted.points[point].force[2]
    assert abs(portions.payout[0]) > 1e-3


@pytest.mark.parametrize("method", ["second_order", "backward_euler"])
@every_flavour
@in_shared_process
def test_fixed_steps_have_the_numbers_of_the_python_api(folder, native, method):
    """Bit for bit, with the same work and its bound; also where a state is restored."""
    given = TetherSystem.from_file(FILES / "two_fall_hoist.toml")
    solver = Solver(fixed_step=0.005, fixed_step_method=method)
    system = TetherSystem(given.points, given.lines, solver=solver)
    system.initialize()
    host = Host(folder / str(native) / "TwoFallHoist.fmu")
    host.start(fixed_step=0.005, fixed_step_method=solver.fixed_step_method)
    for k in range(20):
        if k == 10:
            go_astray_and_back(host, **{"hoist.reel_out_speed": 1.0})
        host.step(STEP, **{"hoist.reel_out_speed": -0.01 * k})
        wanted = system.step(STEP, reel_out_speeds={"hoist": -0.01 * k})
        found = {f"hoist.sheave_payout[{i + 1}]": value for i, value in enumerate(wanted.portions["hoist"].payout.tolist())}
        found |= {"block.position[3]": wanted.points["block"].position[2]}
        assert {each: host.get(each) for each in found} == found
        assert host.get("solver_iteration_limit") == wanted.lines["hoist"].solver_iteration_limit > 0
    assert wanted.portions["hoist"].payout[0] != 0.0


@every_flavour
@in_shared_process
def test_a_rope_that_lets_go(folder, native):
    """Bit for bit, also where the state of before is restored, as is whether and when it did."""
    system = TetherSystem.from_file(FILES / "atwood.toml")
    system.initialize()
    host = Host(folder / str(native) / "Atwood.fmu").start()
    for k in range(20):
        if k == 10:
            go_astray_and_back(host, **{"rope.release": True})
            assert host.get("rope.break_time") == -1.0
        host.step(STEP, **{"rope.release": k >= 10})
        wanted = system.step(STEP, releases={"rope": k >= 10})
        own, portions = wanted.lines["rope"], wanted.portions["rope"]
        found = {"broken": own.broken, "break_time": own.break_time, "tension_to": 0.0 if k >= 10 else own.kite_tension}
        found |= {"sheave_payout[1]": portions.payout[0], "portion_tension_to[2]": portions.tension_to[1]}
        assert {each: host.get(f"rope.{each}") for each in found} == found
        assert host.get("heavy.position[3]") == wanted.points["heavy"].position[2]
    assert found["broken"]
    assert found["break_time"] == pytest.approx(10 * STEP)


@every_flavour
@in_shared_process
def test_wind_points_are_those_of_the_portions(folder, native):
    """Bit for bit the Python API, which has the wind along both portions."""
    given = TetherSystem.from_file(FILES / "two_fall_hoist.toml")
    system = TetherSystem(given.points, given.lines, solver=given._records[1], wind_points=WIND_POINTS)
    wind = np.outer(np.linspace(4.0, 12.0, 2 * WIND_POINTS), (1.0, 0.3, 0.0))
    system.initialize(wind_at={"hoist": wind})
    names = [f"hoist.wind_at[{k},{i}]" for k in range(1, 2 * WIND_POINTS + 1) for i in (1, 2, 3)]
    host = Host(folder / f"wind_{native}" / "TwoFallHoist.fmu").start(**dict(zip(names, wind.ravel(), strict=True)))
    for k in range(5):
        more = (1.0 + 0.1 * k) * wind
        host.step(STEP, **dict(zip(names, more.ravel(), strict=True)))
        block = system.step(STEP, wind_at={"hoist": more}).points["block"].position
        assert [host.get(f"block.position[{i}]") for i in (1, 2, 3)] == block.tolist()
    known = {each.name for each in read_model_description(folder / f"wind_{native}" / "TwoFallHoist.fmu").modelVariables}
    assert names[-1] in known or "hoist.wind_at" in known
    assert f"hoist.wind_at[{2 * WIND_POINTS + 1},1]" not in known


@every_flavour
@in_shared_process
def test_the_parameters_of_sheaves_count(folder, native):
    """A sheave that friction holds."""
    file = folder / str(native) / "Atwood.fmu"
    portions = {"rope.initial_portions[1]": 8.0, "rope.initial_portions[2]": 12.0}
    places = {"light.initial_position[3]": -8.0, "heavy.initial_position[3]": -12.0}
    host = Host(file).start(**{"rope.sheave_friction[1]": 1.0}, **portions, **places)
    host.step(STEP)
    assert host.get("rope.portion_length[1]") == 8.0
    assert host.get("rope.sheave_payout[1]") == 0.0


@every_flavour
@in_shared_process
def test_what_is_refused_is_named(folder, native):
    for wrong, said in {
        "rope.sheave_efficiency[1]": (2.0, "rope.sheave_efficiency"),
        "rope.breaking_force": (1e5, "breaking_force is given for a line over sheaves"),
        "rope.shortest_length": (5.0, "shortest_length or longest_length is given for a line over sheaves"),
        "rope.longest_length": (90.0, "shortest_length or longest_length is given for a line over sheaves"),
    }.items():
        value, sentence = said
        host = Host(folder / str(native) / "Atwood.fmu")
        by_force = {"rope.winch_control": 2} if wrong.endswith("_length") else {}
        with pytest.raises(Exception, match=r"."):
            host.start(**{wrong: value}, **by_force)
        assert sentence in str(host.messages)


def test_their_evidence_is_met(folder, capfd):
    assert_checks_pass(folder, capfd)


@every_flavour
@in_shared_process
def test_what_is_implausible_is_said_once_of_a_line(folder, native):
    """Of the portion where it is worst; not again of another one."""
    loads = {"light": (0.0, 0.0, -2e5), "heavy": (0.0, 0.0, -3e5)}
    system = TetherSystem.from_file(FILES / "atwood.toml")
    system.initialize(loads=loads)
    with pytest.warns(PlausibilityWarning, match=r"the line rope\[2\]: a segment is stretched by"):
        system.step(STEP)
    host = Host(folder / str(native) / "Atwood.fmu").start(**{f"{name}.load": load for name, load in loads.items()})
    host.step(STEP)
    host.step(STEP, **{"light.load": (0.0, 0.0, -9e5)})
    assert sum("is stretched by" in each for each in host.messages) == 1
    assert sum("is stretched by" in each for each in system.implausible) == 1
    assert any("the line rope[2]: a segment is stretched by" in each for each in host.messages)
