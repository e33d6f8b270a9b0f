"""The FMU of a system of tethers: dependencies, descriptions, wrong files; refusals: `test_winch_and_sheave_fmus.py`."""

import re
import zipfile
from xml.etree import ElementTree

import pytest
from fmpy import read_model_description
from fmpy.fmi1 import FMICallException

from flavours import FLAVOURS, every_flavour
from isolation import in_shared_process
from runtime.host import STEP, Host, blob_of, restore
from tetherfmu import Line, Point, TetherSystem
from tetherfmu.check.__main__ import main as check
from tetherfmu.commands.build import main
from tetherfmu.export import system_fmus
from tetherfmu.runtime import plausibility, status
from tetherfmu.runtime.instance import OF_ALL_LINES, renamed
from tetherfmu.runtime.outputs import COUNTERS
from tetherfmu.wiring import system_variables
from tetherfmu.wiring.fmu import lines_of
from tetherfmu.wiring.system import System
from tetherfmu.wiring.system_variables import ENDS
from tetherfmu.wiring.system_variables import GIVEN as GIVEN_INPUTS

from .test_system_flavours import CHAIN, GIVEN, text_of
from .test_system_flavours import EXAMPLES as FILES

EQUILIBRIUM = 2
ROUNDING = 1e-10  # a change below this part of a value, or this many m or N, is rounding


@pytest.fixture
def flavour():
    """Of tests that are for one."""
    return "pythonfmu"


@pytest.fixture
def bridle(built, flavour):
    return built(text_of("y_bridle"), flavour, with_evidence=True)


@pytest.fixture
def kites(built, flavour):
    return built(text_of("two_kites"), flavour)


@pytest.fixture
def chain(built, flavour):
    return built(CHAIN, flavour)


@every_flavour
@in_shared_process
def test_a_state_of_another_system_is_refused(bridle, kites, flavour):
    host, other = Host(bridle).start(), Host(kites).start()
    blob = blob_of(host)
    host.refuses(lambda: restore(host, blob_of(other)), "belongs to another tether FMU")
    assert blob_of(host) == blob


def refused(host, action):
    """Run an action that must be refused; returns what was said."""
    host.messages.clear()
    with pytest.raises(FMICallException):
        action()
    return " ".join(host.messages)


@in_shared_process
def test_the_first_outputs_depend_on_what_is_declared(bridle):
    """Each input and parameter is changed, one at a time: an output that changes must declare it, or say nothing.

    With a free point that may be sought, whatever belongs to a shape depends on all that is given.
    """
    host = Host(bridle)
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


@every_flavour
@in_shared_process
def test_points_start_where_they_are_in_balance_unless_they_are_given(chain, flavour):
    """A point of the file without a position has that of calm air to begin with."""
    host = Host(chain)
    assert (host.get("top.start"), host.get("knot.start"), host.get("load.start")) == (GIVEN, EQUILIBRIUM, EQUILIBRIUM)
    calm = TetherSystem.from_file(chain.with_name("system.toml")).initialize()
    assert host.get("load.initial_position") == calm.points["load"].position.tolist()


@pytest.mark.parametrize("flavour", ["native_fmi3"])
def test_points_are_terminals(bridle, flavour):
    with zipfile.ZipFile(bridle) as opened_file:
        root = ElementTree.fromstring(opened_file.read("terminalsAndIcons/terminalsAndIcons.xml"))
    found = {each.get("name"): [one.get("variableName") for one in each] for each in root.iter("Terminal")}
    winches = ["main", "bridle_left", "bridle_right"]
    assert list(found) == ["ground", "knot", "left", "right", *winches, "wind"]
    assert found["knot"] == ["knot.position", "knot.velocity", "knot.load"]
    assert found["left"] == ["left.position", "left.velocity", "left.force"]
    assert found["main"] == [f"main.{name}" for name in (*GIVEN_INPUTS, "tether_length", "winch_speed")]
    assert found["wind"] == ["wind_velocity"]


def test_winches_are_groups_of_the_open_simulation_platform(bridle):
    root = ElementTree.parse(bridle.with_name("YBridle_OspModelDescription.xml")).getroot()
    groups = {each.get("name"): [one.get("ref") for one in each] for each in root.iter() if each.get("name")}
    found = [references for name, references in groups.items() if name.startswith("main_")]
    assert found == [[f"main.{name}"] for name in (*GIVEN_INPUTS, "winch_speed", "tether_length")]


@every_flavour
def test_shapes_and_counters_are_local(bridle, flavour):
    variables = read_model_description(str(bridle)).modelVariables
    local = {each.name.partition("[")[0] for each in variables if each.causality == "local"}
    assert local == {*(f"{line}.shape" for line in ("main", "bridle_left", "bridle_right")), *COUNTERS}


@every_flavour
def test_the_check_finds_no_problem(bridle, flavour, capsys):
    assert check([str(bridle)]) == 0
    assert "evidence set: 100 steps" in capsys.readouterr().out  # of which none deviates too much


@every_flavour
def test_equal_files_give_equal_bytes(bridle, flavour, tmp_path):
    made = system_fmus.build(FILES / "y_bridle.toml", tmp_path, native=FLAVOURS[flavour])
    assert made.read_bytes() == bridle.read_bytes()


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
    system = system_fmus.read(FILES / "steered_kite.toml")
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
def test_a_refused_step_and_its_warnings_name_variables_of_the_system(bridle, flavour):
    host = Host(bridle).start()
    far = {"left.position": (150.0, -3.0, 1e9)}
    said = refused(host, lambda: host.step(STEP, **far))
    assert "the motion of an end (POINT.position) or a load (POINT.load) jumps too far" in said
    host.messages.clear()
    host.step(STEP, **{"left.position": (150.0, -3.0, 300.0)})
    said += " ".join(host.messages)
    assert "put its end at left; set left.position before the initialization ends" in said
    assert not re.search(r"(kite|ground)_(position|velocity|load)", said)
