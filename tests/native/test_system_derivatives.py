"""Derivatives of native FMUs of systems: of inputs, for the next step, and of outputs by inputs.

A system of one line has what the FMU of a single tether has; the inputs of free points, and outputs of several lines, are
compared with steps that are done again with other inputs.
"""

import math
from pathlib import Path

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from isolation import in_shared_process
from native.flights import give, scene
from native.steps_again import assert_columns_agree, differences
from runtime.host import Host, blob_of, restore
from tetherfmu.commands.build import main
from tetherfmu.export import systems
from y_of_lines import y_of_lines

STEP = 0.02
STEERED_KITE = Path(__file__).parents[2] / "examples" / "systems" / "steered_kite.toml"
SINGLE = {"kite_position": "kite.position", "kite_velocity": "kite.velocity", "kite_load": "kite.load",
          "ground_position": "ground.position", "reel_out_speed": "line.reel_out_speed", "wind_velocity": "wind_velocity",
          "ground_force": "ground.force", "kite_force": "kite.force"}  # fmt: skip
LINE = """
[points]
ground = {{position = [0, 0, 0]}}
kite = {{position = [360, 0, 380], velocity = [0, 30, 20]{mass}}}

[lines.line]
from = "ground"
to = "kite"
initial_length = 525.0
"""


@pytest.fixture(scope="session")
def folder(built_once):
    """Folder with native FMUs: of one line between driven points, of one with a free end, of a Y, of single tethers."""

    def build(folder):
        texts = {"Driven": LINE.format(mass=""), "Free": LINE.format(mass=", mass = 15.0"), "Y": y_of_lines("Y")}
        for name, text in texts.items():
            (folder / f"{name}.toml").write_text(text)
            systems.build(folder / f"{name}.toml", folder, native=2)
        systems.build(folder / "Driven.toml", folder / "3", native=3)
        assert main(["TetherDynamic", "TetherDynamicFree", "--native", "--out", str(folder)]) == 0

    return built_once("system_derivatives", build)


def renamed(values):
    return {SINGLE[name]: value for name, value in values.items()}


def side_by_side(folder, single, system, given, **start):
    """A single tether and a system of one line after 2 s of a flight in which all inputs change; both are hosts."""
    is_free = single == "TetherDynamicFree"
    kite = {"initial_kite_position": [360.0, 0.0, 380.0], "initial_kite_velocity": [0.0, 30.0, 20.0], "kite_mass": 15.0}
    if not is_free:
        kite = {"kite_position": [360.0, 0.0, 380.0], "kite_velocity": [0.0, 30.0, 20.0]}
    one = Host(folder / f"{single}.fmu").start(initial_length=525.0, **start, **kite)
    other = Host(folder / f"{system}.fmu").start(**start)
    for k in range(100):
        inputs, derivatives = scene(single, k * STEP)
        if given:
            give(one, **derivatives)
            give(other, **renamed(derivatives))
        one.step(STEP, **inputs)
        other.step(STEP, **renamed(inputs))
    return one, other


@pytest.mark.parametrize("fixed_step", [0.0, 0.01])
@pytest.mark.parametrize("given", [True, False])
@in_shared_process
def test_given_to_one_line_they_do_what_they_do_to_a_tether(folder, given, fixed_step):
    one, other = side_by_side(folder, "TetherDynamic", "Driven", given, fixed_step=fixed_step)
    for name in ("ground_force", "kite_force"):
        assert other.get(SINGLE[name]) == one.get(name)


@pytest.mark.parametrize("fixed_step", [0.0, 0.01])
@in_shared_process
def test_a_load_does_what_it_does_to_a_free_kite(folder, fixed_step):
    """Its rate is given, estimated or 0. Another elimination, so other rounding; each time the kite comes elsewhere."""
    found = []
    for given, continuation in ((True, 1), (False, 1), (False, 2)):
        solver = {"fixed_step": fixed_step, "relative_tolerance": 1e-7, "input_continuation": continuation}
        one, other = side_by_side(folder, "TetherDynamicFree", "Free", given, **solver)
        found.append(one.get("kite_position"))
        np.testing.assert_allclose(other.get("kite.position"), found[-1], rtol=0.0, atol=1e-6)
    assert np.linalg.norm(np.subtract(found[2], found[0])) > 1e-3
    assert np.linalg.norm(np.subtract(found[1], found[0])) > 1e-5


def motion_of_y(k):
    time = STEP * k
    return {
        "left.position": [-23.0, math.sin(time), 131.0],
        "left.velocity": [0.0, math.cos(time), 0.0],
        "knot.load": [0.0, 20.0 * time, 5.0],
        "main.reel_out_speed": 0.4 * time,
        "wind_velocity": [3.0 * time, 1.0, 0.0],
    }


def ready(path):
    """An instance to which derivatives of inputs are given, after two steps without."""
    host = Host(path).start()
    for k in range(2):
        host.step(STEP, **motion_of_y(k))
    give(host, **{"left.velocity": [5.0, 3.0, 1.0], "knot.load": [400.0, 0.0, 900.0], "main.reel_out_speed": 2.0})
    return host


@in_shared_process
def test_they_wait_in_a_saved_state_and_through_a_refused_step(folder):
    path = folder / "Y.fmu"
    host = ready(path)
    host.step(STEP, **motion_of_y(2))
    expected = host.all_outputs()
    plain = Host(path).start()
    for k in range(3):
        plain.step(STEP, **motion_of_y(k))
    assert plain.all_outputs() != expected
    host = ready(path)
    blob = blob_of(host)
    with pytest.raises(FMICallException):
        host.step(STEP, **{"knot.load": [math.nan, 0.0, 0.0]})
    host.step(STEP, **motion_of_y(2))
    assert host.all_outputs() == expected
    host = Host(path)
    restore(host, blob)
    host.step(STEP, **motion_of_y(2))
    assert host.all_outputs() == expected


@in_shared_process
def test_given_before_the_initialization_ends(folder):
    """They count in the first step, L = L0 + v h + a h^2/2; a reset forgets them."""
    host = Host(folder / "Y.fmu")
    give(host, **{"main.reel_out_speed": 3.0})
    host.start().step(STEP, **{"main.reel_out_speed": 2.0})
    assert host.get("main.tether_length") == pytest.approx(100.0 + 2.0 * STEP + 1.5 * STEP**2, rel=1e-14)
    give(host, **{"main.reel_out_speed": 3.0})
    host.fmu.reset()
    host.start().step(STEP, **{"main.reel_out_speed": 2.0})
    assert host.get("main.tether_length") == pytest.approx(100.0 + 2.0 * STEP, rel=1e-14)
    mass = [host.reference["knot.mass"]]
    host.refuses(lambda: host.fmu.setRealInputDerivatives(mass, [1], [1.0]), "not a continuous input")


@in_shared_process
def test_they_count_with_the_ratio_of_a_shared_winch(tmp_path):
    """Of inputs bit for bit, as the ratio is a power of 2; of outputs as differences are."""
    hosts = {}
    for name, winch in {"Alone": "", "Held": "[winches.drum]\nlines = {line = -2}"}.items():
        (tmp_path / f"{name}.toml").write_text(LINE.format(mass="") + winch, encoding="utf-8")
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
    steered = tmp_path / "steered.toml"
    steered.write_text(STEERED_KITE.read_text(encoding="utf-8").replace('"length"', '"speed"'), encoding="utf-8")
    weights = {"left.load": (-900.0, 0.0, 1500.0), "right.load": (900.0, 0.0, 1500.0)}
    steered = Host(systems.build(steered, tmp_path, native=2)).start(**weights)
    place = steered.reference["steering.reel_out_speed"]
    steered.refuses(
        lambda: steered.fmu.setRealInputDerivatives([place], [1], [1.0]),
        "the derivative of steering.reel_out_speed cannot be used: it turns a line that another winch turns, too",
    )


# --- of outputs by inputs


def jacobian(host, outputs, inputs):
    outputs = [host.reference[name] for name in outputs]
    columns = [host.fmu.getDirectionalDerivative(outputs, [host.reference[name]], [1.0]) for name in inputs]
    return np.array(columns).T


@pytest.mark.parametrize("fixed_step", [0.0, 0.01])
@in_shared_process
def test_those_of_one_line_are_those_of_a_tether(folder, fixed_step):
    """The same differences of the same numbers."""
    hosts = side_by_side(folder, "TetherDynamic", "Driven", False, fixed_step=fixed_step)
    inputs = [f"{name}[{i}]" for name in ("kite_position", "kite_velocity", "wind_velocity") for i in (1, 2, 3)]
    outputs = [f"{name}[{i}]" for name in ("ground_force", "kite_force") for i in (1, 2, 3)]
    wanted = jacobian(hosts[0], outputs, inputs)
    named = [[name.replace(name[:-3], SINGLE[name[:-3]]) for name in names] for names in (outputs, inputs)]
    np.testing.assert_array_equal(jacobian(hosts[1], *named), wanted)
    assert np.abs(wanted).max() > 100.0


@pytest.mark.parametrize("fixed_step", [0.0, 0.01])
@in_shared_process
def test_differences_of_steps_of_a_y_that_are_done_again(folder, fixed_step):
    """By save, restore and steps with other inputs, extrapolated; of each column the largest counts."""
    host = Host(folder / "Y.fmu").start(fixed_step=fixed_step)
    for k in range(20):
        before = blob_of(host)
        host.step(STEP, **motion_of_y(k))
    vectors = ("winch.force", "right.force", "knot.position", "knot.velocity")
    outputs = [f"{name}[{i}]" for name in vectors for i in (1, 2, 3)]
    outputs += ["main.tension_to", "a.tension_from", "b.max_tension", "main.tether_length"]
    changes = {"left.position[2]": 1e-5, "left.velocity[1]": 1e-3, "right.position[3]": 1e-5, "knot.load[2]": 1e-2,
               "main.reel_out_speed": 1e-3, "wind_velocity[2]": 1e-2}  # fmt: skip
    found = jacobian(host, outputs, list(changes))
    expected = differences(host, before, STEP, motion_of_y(19), outputs, changes)
    assert_columns_agree(found, expected, 1e-3)
    assert np.abs(expected).max(axis=0).min() > 0.0


@in_shared_process
def test_at_the_start_they_are_those_of_the_equilibrium(folder):
    """In initialization mode: of one line those of a tether."""
    found = []
    for path, names in ((folder / "TetherDynamic.fmu", {}), (folder / "Driven.fmu", SINGLE)):
        host = Host(path)
        given = {"kite_position": [360.0, 0.0, 380.0], "kite_velocity": [0.0, 30.0, 20.0]}
        host.enter_initialization(None)
        if not names:
            host.set(initial_length=525.0, **given)
        name = names.get("kite_force", "kite_force"), names.get("kite_position", "kite_position")
        found.append(jacobian(host, *([f"{each}[{i}]" for i in (1, 2, 3)] for each in name)))
    np.testing.assert_array_equal(found[1], found[0])
    assert np.abs(found[0]).max() > 1.0


@in_shared_process
def test_fmi_3_has_them_too(folder):
    """A gradient of the force on the kite by its velocity, through arrays."""
    two, three = (Host(path).start() for path in (folder / "Driven.fmu", folder / "3" / "Driven.fmu"))
    for host in (two, three):
        host.step(STEP)
    wanted = jacobian(two, [f"kite.force[{i}]" for i in (1, 2, 3)], ["kite.velocity[2]"])
    force, velocity = three.reference["kite.force"], three.reference["kite.velocity"]
    found = three.fmu.getDirectionalDerivative([force], [velocity], [0.0, 1.0, 0.0], 3)
    np.testing.assert_array_equal(found, wanted[:, 0])
