"""The FMU of a system of tethers: the numbers of `TetherSystem`, states, refusals with names, dependencies, wrong files."""

import math
import re
import zipfile
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest
from fmpy import read_model_description
from fmpy.fmi1 import FMICallException

from isolation import in_shared_process
from runtime.host import STEP, Host, blob_of, extract_all, restore
from tetherfmu import Line, Point, TetherSystem
from tetherfmu.check.__main__ import main as check
from tetherfmu.commands.build import main
from tetherfmu.export import systems
from tetherfmu.files import system_files as files
from tetherfmu.runtime import plausibility, status
from tetherfmu.runtime.instance import OF_ALL_LINES, renamed
from tetherfmu.runtime.limits import WORST_WORK
from tetherfmu.runtime.outputs import COUNTERS
from tetherfmu.wiring import system_variables
from tetherfmu.wiring.fmu import lines_of
from tetherfmu.wiring.system import System
from tetherfmu.wiring.system_variables import ENDS, GIVEN

FILES = Path(__file__).parents[2] / "examples" / "systems"
STEPS = 30
ROUNDING = 1e-10  # a change below this part of a value, or this many m or N, is rounding
OF_A_LINE = {own: name for name, own in system_variables.OF_A_LINE.items()}


FLAVOURS = {"pythonfmu": None, "native": 2, "native_fmi3": 3}
every_flavour = pytest.mark.parametrize("folder", FLAVOURS, indirect=True)


@pytest.fixture(scope="session")
def folders(built_once):
    """Folders with the FMUs of two files, by flavour."""

    def build(folder):
        for flavour, native in FLAVOURS.items():
            for name in ("y_bridle", "two_kites"):
                systems.build(FILES / f"{name}.toml", folder / flavour, native=native)
            extract_all(folder / flavour)

    folder = built_once("system_fmus", build)
    return {flavour: folder / flavour for flavour in FLAVOURS}


@pytest.fixture
def folder(folders, request):
    """Folder with the FMUs of a flavour."""
    return folders[getattr(request, "param", "pythonfmu")]


def given_at(k):
    """What both systems are given before step k, as arguments of `TetherSystem.step` but for the file's points."""
    time = STEP * k
    y, speed = math.sin(time), math.cos(time)
    return y, speed, (3.0 * time, 1.0, 0.0), (0.0, 20.0 * time, 5.0), 0.4 * time


def step_of_fmu(host, k):
    y, speed, wind, load, reeling = given_at(k)
    host.step(
        STEP,
        **{"left.position[2]": host.left_at_start + y, "left.velocity[2]": speed, "wind_velocity": wind},
        **{"knot.load": load, "main.reel_out_speed": reeling},
    )
    return host.outputs()


def opened(path):
    """An instance that is initialized; `left_at_start` : what the second component of `left.position` is there."""
    host = Host(path)
    host.left_at_start = host.get("left.position[2]")
    return host.start()


def step_of_python(system, k):
    y, speed, wind, load, reeling = given_at(k)
    x, at_start, z = next(point.position for point in system.points if point.name == "left")
    moving = {"left": (x, at_start + y, z)}, {"left": (0.0, speed, 0.0)}, {"knot": load}
    return system.step(STEP, *moving, reel_out_speeds={"main": reeling}, wind_velocity=wind)


def as_fmu(system, outputs):
    """Outputs of `TetherSystem` by the names of an FMU."""
    found = {}
    for point in system.points:
        own = outputs.points[point.name]
        names = ("force",) if point.is_driven else ("position", "velocity")
        found |= {f"{point.name}.{name}": list(getattr(own, name)) for name in names}
    for line in system.lines:
        own = outputs.lines[line.name]
        found |= {f"{line.name}.{name}": getattr(own, OF_A_LINE[name]) for name in OF_A_LINE}
        found[f"{line.name}.shape"] = own.shape.ravel().tolist()
    found["solver_iteration_limit"] = outputs.solver_iteration_limit
    found["fallback_steps"] = next(iter(outputs.lines.values())).fallback_steps
    return {**found, **{f"solver_{name}": count for name, count in system.counters.items()}}


@every_flavour
@pytest.mark.parametrize("name", ["y_bridle", "two_kites"])
@in_shared_process
def test_the_numbers_are_those_of_python(folder, name):
    """Bit for bit, also where a free point starts in equilibrium (the knot of the bridle)."""
    system = TetherSystem.from_file(FILES / f"{name}.toml")
    host = opened(folder / f"{'YBridle' if name == 'y_bridle' else 'TwoKites'}.fmu")
    assert host.outputs() == as_fmu(system, system.initialize())
    for k in range(STEPS):
        assert step_of_fmu(host, k) == as_fmu(system, step_of_python(system, k))
    assert host.get("main.tether_length") > 0.05 + host.get("main.initial_length")


@every_flavour
@in_shared_process
def test_fixed_steps_are_those_of_python(folder):
    """Bit for bit, two of order 2 in each communication step."""
    found = files.load(FILES / "two_kites.toml")
    solver = replace(found.solver, fixed_step=0.01)
    system = TetherSystem(found.points, found.lines, found.environment, solver, found.ground)
    host = Host(folder / "TwoKites.fmu")
    host.left_at_start = host.get("left.position[2]")
    host.start(fixed_step=0.01)
    system.initialize()
    for k in range(STEPS):
        assert step_of_fmu(host, k) == as_fmu(system, step_of_python(system, k))
    assert system.counters["steps"] == 2 * STEPS
    assert host.get("solver_iteration_limit") == 2 * system.most_factorizations == 2 * WORST_WORK


@every_flavour
@in_shared_process
def test_a_state_continues_bit_for_bit_after_a_refused_step_and_a_reset(folder):
    host = opened(folder / "YBridle.fmu")
    for k in range(5):
        step_of_fmu(host, k)
    blob = blob_of(host)
    rows = [step_of_fmu(host, k) for k in range(5, 10)]
    host.fmu.reset()
    restore(host, blob)
    host.time = 5 * STEP
    assert "knot.load is [nan, " in refused(host, lambda: host.step(STEP, **{"knot.load[1]": math.nan}))
    host.set(**{"knot.load[1]": 0.0})
    assert blob_of(host) == blob
    assert [step_of_fmu(host, k) for k in range(5, 10)] == rows


@every_flavour
@in_shared_process
def test_a_state_of_another_system_is_refused(folder):
    bridle, kites = opened(folder / "YBridle.fmu"), opened(folder / "TwoKites.fmu")
    blob = blob_of(bridle)
    bridle.refuses(lambda: restore(bridle, blob_of(kites)), "belongs to another tether FMU")
    assert blob_of(bridle) == blob


def refused(host, action):
    """Run an action that must be refused; returns what was said."""
    host.messages.clear()
    with pytest.raises(FMICallException):
        action()
    return " ".join(host.messages)


@every_flavour
@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        ("main.segments", 0, "main.segments is 0; it must be at least 1"),
        ("bridle_left.initial_length", 0.02, "the line bridle_left: initial_length is 0.02 m for 3 segments"),
        ("knot.mass", -1.0, "knot.mass is -1.0; it must be at least 0 kg"),
        ("knot.initial_position[2]", math.inf, "knot.initial_position[2] is inf; it must be"),
        ("gravity", math.nan, "gravity is nan; it must be at least 0 m/s2"),
        ("bridle_left.damping_law", 3, "bridle_left.damping_law is 3; it must be one of 1 (strain_rate)"),
        ("left.position[2]", math.nan, "the input left.position[2] is nan; it must be a finite number"),
    ],
)
@in_shared_process
def test_a_start_is_refused_with_the_name_of_point_or_line(folder, name, value, says):
    host = Host(folder / "YBridle.fmu")
    assert says in refused(host, lambda: host.start(**{name: value}))


@every_flavour
@in_shared_process
def test_a_step_is_refused_with_the_name_of_point_or_line(folder):
    host = opened(folder / "YBridle.fmu")
    before = host.outputs()
    assert "main.reel_out_speed is inf" in refused(host, lambda: host.step(STEP, **{"main.reel_out_speed": math.inf}))
    said = refused(host, lambda: host.step(STEP, **{"main.reel_out_speed": 0.0, "bridle_right.reel_out_speed": -1e3}))
    assert "the line bridle_right: the reel_out_speed -1000.0 m/s" in said
    assert host.outputs() == before


@in_shared_process
def test_the_first_outputs_depend_on_what_is_declared(folder):
    """Each input and parameter is changed, one at a time: an output that changes must declare it, or say nothing.

    With a free point that may be sought, whatever belongs to a shape depends on all that is given.
    """
    host = Host(folder / "YBridle.fmu")
    given = {"wind_velocity": (8.0, 1.0, 0.5), "main.reel_out_speed": 0.3, "wind_profile": 4, "surface_roughness": 0.1}
    names = {reference: name for name, reference in host.reference.items()}
    unknowns = host.description.initialUnknowns
    declared = {each.variable.name: {one.name for one in each.dependencies or ()} for each in unknowns}
    free = {each.variable.name for each in unknowns if each.dependencies is None}

    def outputs_with(**values):
        host.fmu.reset()
        host.enter_initialization(None)
        host.set(**{**given, **values})
        found = dict(zip(map(names.get, host.real_outputs), host.all_outputs(), strict=True))
        return {name: found[name] for name in found if name in declared}

    usual, seen = outputs_with(), set()
    for known in host.description.modelVariables:
        if known.causality not in ("input", "parameter") or known.type == "Boolean":
            continue
        value = given.get(known.name, float(known.start))
        other = (value % 2 + 1 if known.declaredType else value + 2) if known.type != "Real" else 0.98 * value + 0.01
        kind = int if known.type != "Real" else float
        for name, number in outputs_with(**{known.name: kind(other)}).items():
            if abs(number - usual[name]) > ROUNDING * (1.0 + abs(usual[name])):
                assert name in free or known.name in declared[name], (known.name, name)
                seen.add((known.name, name))
    assert {("left.position[1]", "left.force[1]"), ("main.diameter", "ground.force[3]")} <= seen
    assert {("main.diameter", "left.force[1]"), ("knot.start", "knot.position[3]")} <= seen
    assert free.isdisjoint({"knot.velocity[1]", "solver_steps"})


def test_between_driven_points_the_first_outputs_depend_on_their_line():
    ends = tuple(Point(name, (0.0, 0.0, 10.0 * k)) for k, name in enumerate("abc"))
    lines = tuple(Line(name, *name) for name in ("ab", "bc"))
    table = system_variables.table_of(System("Row", ends, lines, shape_points=0))
    declared = {each.name: set(each.depends_on or ()) for each in table}
    assert {"ab.diameter", "gravity", "b.position[2]"} <= declared["a.force[1]"]
    assert {"ab.diameter", "bc.diameter", "c.position[2]"} <= declared["b.force[1]"]
    assert declared["a.force[1]"].isdisjoint({"bc.diameter", "c.position[2]"})


@in_shared_process
def test_a_state_goes_from_one_flavour_to_the_other(folders):
    hosts = [opened(folders[flavour] / "YBridle.fmu") for flavour in ("pythonfmu", "native")]
    for k in range(5):
        step_of_fmu(hosts[0], k)
    for giver, taker in (hosts, hosts[::-1]):
        restore(taker, blob_of(giver))
        taker.time = giver.time
        rows = [[step_of_fmu(host, k) for k in range(5, 8)] for host in hosts]
        assert rows[0] == rows[1]


def test_points_are_terminals(folders):
    with zipfile.ZipFile(folders["native_fmi3"] / "YBridle.fmu") as opened_file:
        root = ElementTree.fromstring(opened_file.read("terminalsAndIcons/terminalsAndIcons.xml"))
    found = {each.get("name"): [one.get("variableName") for one in each] for each in root.iter("Terminal")}
    winches = ["main", "bridle_left", "bridle_right"]
    assert list(found) == ["ground", "knot", "left", "right", *winches, "wind"]
    assert found["knot"] == ["knot.position", "knot.velocity", "knot.load"]
    assert found["left"] == ["left.position", "left.velocity", "left.force"]
    assert found["main"] == [f"main.{name}" for name in (*GIVEN, "tether_length", "winch_speed")]
    assert found["wind"] == ["wind_velocity"]


def test_winches_are_groups_of_the_open_simulation_platform(folders):
    root = ElementTree.parse(folders["native"] / "YBridle_OspModelDescription.xml").getroot()
    groups = {each.get("name"): [one.get("ref") for one in each] for each in root.iter() if each.get("name")}
    found = [references for name, references in groups.items() if name.startswith("main_")]
    assert found == [[f"main.{name}"] for name in (*GIVEN, "winch_speed", "tether_length")]


def test_shapes_and_counters_are_local(folders):
    for folder in folders.values():
        variables = read_model_description(str(folder / "YBridle.fmu")).modelVariables
        local = {each.name.partition("[")[0] for each in variables if each.causality == "local"}
        assert local == {*(f"{line}.shape" for line in ("main", "bridle_left", "bridle_right")), *COUNTERS}


def test_the_check_finds_no_problem(folders, capsys):
    assert check([str(folders[flavour] / "YBridle.fmu") for flavour in ("pythonfmu", "native_fmi3")]) == 0
    assert capsys.readouterr().out.count("evidence set: 100 steps") == 2  # of which none deviates too much


@every_flavour
def test_equal_files_give_equal_bytes(folder, tmp_path):
    native = FLAVOURS[folder.name]
    made = systems.build(FILES / "y_bridle.toml", tmp_path, native=native)
    assert made.read_bytes() == (folder / "YBridle.fmu").read_bytes()


WRONG = {
    "no file": (None, "nowhere.toml: cannot be read"),
    "key": ("mass =", "weight =", "unknown key points.knot.weight"),
    "clash": ("[points.knot]", "[points.gravity]", "gravity is a name of the whole system"),
    "terminal": ("[points.knot]", "[points.wind]", "wind is a name of the whole system"),
    "name": ('"YBridle"', '"TetherDynamic"', "must not be that of the FMU of a single tether"),
    "material": ('"dyneema_sk75"', '"rubber"', "lines.main.material is 'rubber'"),
}


@pytest.mark.parametrize("wrong", WRONG.values(), ids=WRONG)
def test_a_wrong_file_is_told_in_one_line(tmp_path, capsys, wrong):
    *change, says = wrong
    path = tmp_path / "nowhere.toml"
    if change != [None]:
        path.write_text((FILES / "y_bridle.toml").read_text(encoding="utf-8").replace(*change, 1), encoding="utf-8")
    assert main(["--system", str(path), "--out", str(tmp_path)]) == 2
    told = capsys.readouterr().err
    assert says in told
    assert told.count("\n") == 1


@pytest.mark.parametrize("other", [["TetherDynamic"], ["--segments", "5"], ["--header"], ["--examples"]])
def test_options_that_do_not_go_with_a_system(other, capsys):
    with pytest.raises(SystemExit) as ended:
        main(["--system", str(FILES / "y_bridle.toml"), *other])
    assert ended.value.code == 2
    assert capsys.readouterr().err.count("\n") == 1


OF_A_LINE_ALONE = {status.RELEASED_WITHOUT_MASS}  # no status of all lines
OF_A_TETHER_ALONE = {status.NO_EQUILIBRIUM_OF_KITE}  # its kite is a free point in a system
OF_ENDS = ("kite_", "ground_", "initial_kite_")  # what names of ends begin with


def test_sentences_name_the_ends_and_the_winches_of_the_system():
    """Of those on a line and on all lines: each name of an end of a tether is one of the system."""
    system = systems.read(FILES / "steered_kite.toml")
    known = {each.name.partition("[")[0] for each in system_variables.table_of(system)}
    codes = status.SENTENCES.keys() - OF_A_TETHER_ALONE
    of_lines = [*plausibility.SENTENCES.values(), *(status.SENTENCES[code] for code in codes)]
    told = [renamed(status.SENTENCES[code], OF_ALL_LINES) for code in codes - OF_A_LINE_ALONE]
    told += [
        renamed(said.replace("{end}", end), line.words) for said in of_lines for line in lines_of(system) for end in ENDS
    ]
    for said in told:
        found = {word for word in re.findall(r"(?<!\{)\b\w[\w.]+\w", said) if word.startswith(OF_ENDS)}
        assert found <= known, said
    tape = next(line for line in lines_of(system) if line.name == "tape_left")
    assert renamed("check winch_length", tape.words) == "check steering.winch_length and depower.winch_length"
    assert {"steering.winch_length", "depower.winch_length"} <= known


@every_flavour
@in_shared_process
def test_a_refused_step_and_its_warnings_name_variables_of_the_system(folder):
    host = opened(folder / "YBridle.fmu")
    far = {"left.position": (150.0, -3.0, 1e9)}
    said = refused(host, lambda: host.step(STEP, **far))
    assert "the motion of an end (POINT.position) or a load (POINT.load) jumps too far" in said
    host.messages.clear()
    host.step(STEP, **{"left.position": (150.0, -3.0, 300.0)})
    said += " ".join(host.messages)
    assert "put its end at left; set left.position before the initialization ends" in said
    assert not re.search(r"(kite|ground)_(position|velocity|load)", said)
