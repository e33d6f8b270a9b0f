"""FMUs of systems, also with winches and sheaves, in all flavours: variables, evidence, and what is refused by name.

Their numbers are those of `test_system_flavours.py`.
"""

import pytest
from fmpy import read_model_description
from fmpy.fmi1 import FMICallException

from flavours import every_flavour
from isolation import in_shared_process
from runtime.host import STEP, Host
from shared_drums import SHARED, TEXT
from tetherfmu import PlausibilityWarning, TetherSystem
from tetherfmu.check.__main__ import main as check

from .test_system_flavours import CHAIN, DRUMS, HOIST, LOADS, OF_WINCHES, WEIGHTS, WINDY, steered, text_of

FORCE, INFINITE, NO_NUMBER = 2, float("inf"), float("nan")
FILES = {
    "bridle": text_of("y_bridle"),
    "chain": CHAIN,
    "digits": HOIST.replace("top", "p2kite_position"),
    "by length": steered("length").file,
    "by speed": steered("speed").file,
    "drums": TEXT,
    "drum starts": DRUMS,
    "two winches": OF_WINCHES,
    "atwood": text_of("atwood"),
}


@pytest.fixture
def fmu(built, name, flavour):
    """Path of the FMU of a file, by the name of the file, in a flavour."""
    return built(FILES[name], flavour)


VARIABLES = {  # those that an FMU has, and lines with what they have not
    "by length": (
        {"steering.winch_length", "depower.winch_length", "steering.winch_speed", "depower.payout", "main.reel_out_speed"},
        {f"tape_left.{what}" for what in ("reel_out_speed", "winch_length", "winch_control", "winch_mass")},
    ),
    "drums": (
        {"steering.winch_force", "power.winch_mass", "power.winch_damping", "steering.winch_friction"}
        | {"steering.winch_speed", "power.payout", "c.winch_force", "c.winch_mass", "a.release", "a.broken", "c.release"}
        | {"steering.winch_start", "steering.reel_out_speed"},  # parameters of its start
        {"a.winch_force", "a.winch_mass", "a.winch_start", "a.reel_out_speed"},
    ),
}


@every_flavour
@pytest.mark.parametrize("name", VARIABLES)
def test_lines_in_winches_have_no_variables_of_a_winch(fmu, name):
    names = {each.name for each in read_model_description(fmu).modelVariables}
    has, has_not = VARIABLES[name]
    assert has <= names
    assert not names & has_not


STEPS = [  # of a file: inputs that are refused, with the name of points, lines and winches
    ("bridle", {"knot.load[1]": NO_NUMBER}, "knot.load is [nan, "),
    ("bridle", {"main.reel_out_speed": INFINITE}, "main.reel_out_speed is inf"),
    ("bridle", {"bridle_right.reel_out_speed": -1e3}, "the line bridle_right: the reel_out_speed -1000.0 m/s"),
    # the name of this point ends as the input of a tether, after a digit
    ("digits", {"p2kite_position.position[1]": NO_NUMBER}, "the line rope: the input p2kite_position.position[1] is nan"),
    ("by speed", {"steering.reel_out_speed": NO_NUMBER}, "input steering.reel_out_speed and depower.reel_out_speed is nan"),
    ("drums", {"steering.winch_force": NO_NUMBER}, "the input steering.winch_force is nan"),
]


@every_flavour
@pytest.mark.parametrize(("name", "inputs", "says"), STEPS)
@in_shared_process
def test_a_refused_step_names_what_is_wrong(fmu, name, inputs, says):
    host = Host(fmu).start(**(WEIGHTS if name == "by speed" else {}))
    before = host.outputs()
    with pytest.raises(FMICallException):
        host.step(STEP, **inputs)
    assert says in host.messages[-1]
    assert host.outputs() == before


ENDS = "the unstretched length is {} m at the start, beyond a stop of the winch"
NOT_IN_BALANCE = "lift.winch_force, 1.0 N, with trim.winch_start and lift.winch_start 2 (equilibrium)"
SOFT = {"upper.axial_stiffness": 1.0, "lower.axial_stiffness": 1.0, "air_density": 50.0}
STARTS = [
    ("bridle", {"main.segments": 0}, "main.segments is 0; it must be at least 1"),
    ("bridle", {"bridle_left.initial_length": 0.02}, "the line bridle_left: initial_length is 0.02 m for 3 segments"),
    ("bridle", {"knot.mass": -1.0}, "knot.mass is -1.0; it must be at least 0 kg"),
    ("bridle", {"knot.initial_position[2]": INFINITE}, "knot.initial_position[2] is inf; it must be"),
    ("bridle", {"gravity": NO_NUMBER}, "gravity is nan; it must be at least 0 m/s2"),
    ("bridle", {"bridle_left.damping_law": 3}, "bridle_left.damping_law is 3; it must be one of 1 (strain_rate)"),
    ("bridle", {"left.position[2]": NO_NUMBER}, "the input left.position[2] is nan; it must be a finite number"),
    ("chain", SOFT, "for the free point"),
    ("chain", {"top.start": 2}, "no point of the system is driven or has a position: give one where it starts"),
    ("chain", {"knot.load[2]": NO_NUMBER}, "the input knot.load is [30.0, nan, 0.0]"),
    ("chain", {"knot.start": 3}, "knot.start is 3; it must be one of 1 (given), 2 (equilibrium)"),
    ("drums", {"c.winch_control": FORCE, "c.longest_length": 20.0}, f"the line c: {ENDS.format(22.6)}"),
    ("drum starts", {"lift.winch_force": 1.0}, NOT_IN_BALANCE),
    ("drum starts", {"trim.winch_start": 3}, "winch_start is 3; it must be one of 1 (given), 2 (equilibrium)"),
    ("drum starts", {"trim.reel_out_speed": NO_NUMBER}, "trim.reel_out_speed"),
    ("two winches", {"main.shortest_length": 50.0, "main.longest_length": 40.0}, "the line main: shortest_length is 50"),
    ("atwood", {"rope.sheave_efficiency[1]": 2.0}, "rope.sheave_efficiency"),
    ("atwood", {"rope.breaking_force": 1e5, "rope.segments": 2}, "breaking_force is given for a line over sheaves"),
    ("atwood", {"rope.shortest_length": 25.0, "rope.winch_control": FORCE}, ENDS.format(20.0)),
    ("atwood", {"rope.longest_length": 15.0, "rope.winch_control": FORCE}, ENDS.format(20.0)),
]


@every_flavour
@pytest.mark.parametrize(("name", "values", "says"), STARTS)
@in_shared_process
def test_a_refused_start_names_what_is_wrong(fmu, name, values, says):
    blown = {"wind_velocity": (9.0, 2.0, 0.0), **LOADS} if name == "chain" else {}
    Host(fmu).refuses_to_start(says, **blown, **values)


WITH_EVIDENCE = {name: (FILES[name], 0) for name in ("by length", "by speed", "two winches")}
WITH_EVIDENCE |= {"drums beside a sheave": (SHARED, 0), "hoist in wind at points": (text_of("two_fall_hoist"), WINDY)}


@pytest.mark.parametrize("name", WITH_EVIDENCE)
def test_their_evidence_is_met(built, name, capsys):
    """Of the native FMU; the others give the same numbers."""
    text, wind_points = WITH_EVIDENCE[name]
    assert check([str(built(text, "native", wind_points, with_evidence=True))]) == 0
    assert "evidence set: 100 steps" in capsys.readouterr().out


@pytest.mark.parametrize("name", ["atwood"])
@every_flavour
@in_shared_process
def test_the_parameters_of_sheaves_count(fmu, name):
    """A sheave that friction holds."""
    portions = {"rope.initial_portions[1]": 8.0, "rope.initial_portions[2]": 12.0}
    places = {"light.initial_position[3]": -8.0, "heavy.initial_position[3]": -12.0}
    host = Host(fmu).start(**{"rope.sheave_friction[1]": 1.0}, **portions, **places)
    host.step(STEP)
    assert host.get("rope.portion_length[1]") == 8.0
    assert host.get("rope.sheave_payout[1]") == 0.0


@pytest.mark.parametrize("name", ["atwood"])
@every_flavour
@in_shared_process
def test_what_is_implausible_is_said_once_of_a_line(fmu, name):
    """Of the portion where it is worst; not again of another one."""
    loads = {"light": (0.0, 0.0, -2e5), "heavy": (0.0, 0.0, -3e5)}
    system = TetherSystem.from_file(fmu.with_name("system.toml"))
    system.initialize(loads=loads)
    with pytest.warns(PlausibilityWarning, match=r"the line rope\[2\]: a segment is stretched by"):
        system.step(STEP)
    host = Host(fmu).start(**{f"{name}.load": load for name, load in loads.items()})
    host.step(STEP)
    host.step(STEP, **{"light.load": (0.0, 0.0, -9e5)})
    assert sum("is stretched by" in each for each in host.messages) == 1
    assert sum("is stretched by" in each for each in system.implausible) == 1
    assert any("the line rope[2]: a segment is stretched by" in each for each in host.messages)
