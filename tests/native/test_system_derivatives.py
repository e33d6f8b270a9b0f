"""Derivatives of native FMUs of systems: of inputs, for the next step, and of outputs by inputs.

A system of one line has what the FMU of a single tether has; the inputs of free points, and outputs of several lines, are
compared with steps that are done again with other inputs.
"""

import numpy as np
import pytest

from export.test_system_flavours import WEIGHTS, of_kites, steered
from isolation import in_shared_process
from native.flights import give, scene
from native.steps_again import assert_columns_agree, differences
from runtime.host import Host, blob_of
from y_of_lines import y_of_lines

STEP = 0.02
SINGLE = {"kite_position": "kite.position", "kite_velocity": "kite.velocity", "kite_load": "kite.load",
          "ground_position": "ground.position", "reel_out_speed": "line.reel_out_speed", "wind_velocity": "wind_velocity",
          "ground_force": "ground.force", "kite_force": "kite.force"}  # fmt: skip
LINE = """
name = "Line"
[points]
ground = {{position = [0, 0, 0]}}
kite = {{position = [360, 0, 380], velocity = [0, 30, 20]{mass}}}

[lines.line]
from = "ground"
to = "kite"
initial_length = 525.0
"""


@pytest.fixture
def driven(built):
    """Native FMU of one line between driven points; the next ones: with a free end, and of a Y."""
    return built(LINE.format(mass=""), "native")


@pytest.fixture
def free(built):
    return built(LINE.format(mass=", mass = 15.0"), "native")


@pytest.fixture
def y(built):
    return built(y_of_lines("Y"), "native")


def renamed(values):
    return {SINGLE[name]: value for name, value in values.items()}


def side_by_side(tether, system, given, **start):
    """A tether and a system of one line, paths, after 2 s of a flight in which all inputs change: the hosts of both."""
    is_free = tether.stem == "TetherDynamicFree"
    kite = {"initial_kite_position": [360.0, 0.0, 380.0], "initial_kite_velocity": [0.0, 30.0, 20.0], "kite_mass": 15.0}
    if not is_free:
        kite = {"kite_position": [360.0, 0.0, 380.0], "kite_velocity": [0.0, 30.0, 20.0]}
    one = Host(tether).start(initial_length=525.0, **start, **kite)
    other = Host(system).start(**start)
    for k in range(100):
        inputs, derivatives = scene(tether.stem, k * STEP)
        if given:
            give(one, **derivatives)
            give(other, **renamed(derivatives))
        one.step(STEP, **inputs)
        other.step(STEP, **renamed(inputs))
    return one, other


@pytest.mark.parametrize("fixed_step", [0.0, 0.01])
@pytest.mark.parametrize("given", [True, False])
@in_shared_process
def test_given_to_one_line_they_do_what_they_do_to_a_tether(native_folder, driven, given, fixed_step):
    one, other = side_by_side(native_folder / "TetherDynamic.fmu", driven, given, fixed_step=fixed_step)
    for name in ("ground_force", "kite_force"):
        assert other.get(SINGLE[name]) == one.get(name)


@pytest.mark.parametrize("fixed_step", [0.0, 0.01])
@in_shared_process
def test_a_load_does_what_it_does_to_a_free_kite(native_folder, free, fixed_step):
    """Its rate is given, estimated or 0. Another elimination, so other rounding; each time the kite comes elsewhere."""
    found = []
    for given, continuation in ((True, 1), (False, 1), (False, 2)):
        solver = {"fixed_step": fixed_step, "relative_tolerance": 1e-7, "input_continuation": continuation}
        one, other = side_by_side(native_folder / "TetherDynamicFree.fmu", free, given, **solver)
        found.append(one.get("kite_position"))
        np.testing.assert_allclose(other.get("kite.position"), found[-1], rtol=0.0, atol=1e-6)
    assert np.linalg.norm(np.subtract(found[2], found[0])) > 1e-3
    assert np.linalg.norm(np.subtract(found[1], found[0])) > 1e-5


@in_shared_process
def of_a_shared_winch(alone, held, steered):
    """They count with its ratio: of inputs bit for bit, as it is a power of 2; of outputs as differences are."""
    inputs = {alone: ("line.reel_out_speed", 1.0), held: ("drum.reel_out_speed", -0.5)}
    hosts, found = {path: Host(path).start() for path in inputs}, []
    for k in range(4):
        for path, host in hosts.items():
            own, factor = inputs[path]
            host.fmu.setRealInputDerivatives([host.reference[own]], [1], [factor * 3.0])
            host.step(STEP, **{own: factor * 0.4 * k})
    for path, host in hosts.items():
        own, factor = inputs[path]
        forces = [host.reference[f"kite.force[{i}]"] for i in (1, 3)]
        found.append(factor * np.array(host.fmu.getDirectionalDerivative(forces, [host.reference[own]], [1.0])))
    assert hosts[alone].get("line.tension_to") == hosts[held].get("line.tension_to")
    np.testing.assert_allclose(*found, rtol=1e-5)
    host = Host(steered).start(**WEIGHTS)
    place = host.reference["steering.reel_out_speed"]
    words = "the derivative of steering.reel_out_speed cannot be used: it turns a line that another winch turns, too"
    host.refuses(lambda: host.fmu.setRealInputDerivatives([place], [1], [1.0]), words)


def test_they_count_with_the_ratio_of_a_shared_winch(built, driven):
    held = built(LINE.format(mass="") + "[winches.drum]\nlines = {line = -2}", "native")
    of_a_shared_winch(alone=driven, held=held, steered=built(steered("speed").file, "native"))


# --- of outputs by inputs


def jacobian(host, outputs, inputs):
    outputs = [host.reference[name] for name in outputs]
    columns = [host.fmu.getDirectionalDerivative(outputs, [host.reference[name]], [1.0]) for name in inputs]
    return np.array(columns).T


@pytest.mark.parametrize("fixed_step", [0.0, 0.01])
@in_shared_process
def test_those_of_one_line_are_those_of_a_tether(native_folder, driven, fixed_step):
    """The same differences of the same numbers."""
    hosts = side_by_side(native_folder / "TetherDynamic.fmu", driven, False, fixed_step=fixed_step)
    inputs = [f"{name}[{i}]" for name in ("kite_position", "kite_velocity", "wind_velocity") for i in (1, 2, 3)]
    outputs = [f"{name}[{i}]" for name in ("ground_force", "kite_force") for i in (1, 2, 3)]
    wanted = jacobian(hosts[0], outputs, inputs)
    named = [[name.replace(name[:-3], SINGLE[name[:-3]]) for name in names] for names in (outputs, inputs)]
    np.testing.assert_array_equal(jacobian(hosts[1], *named), wanted)
    assert np.abs(wanted).max() > 100.0


@pytest.mark.parametrize("fixed_step", [0.0, 0.01])
@in_shared_process
def test_differences_of_steps_of_a_y_that_are_done_again(y, fixed_step):
    """By save, restore and steps with other inputs, extrapolated; of each column the largest counts."""
    host, moves = Host(y).start(fixed_step=fixed_step), of_kites(-23.0, 0.0, 131.0)
    for k in range(20):
        before = blob_of(host)
        host.step(STEP, **moves(k))
    vectors = ("winch.force", "right.force", "knot.position", "knot.velocity")
    outputs = [f"{name}[{i}]" for name in vectors for i in (1, 2, 3)]
    outputs += ["main.tension_to", "a.tension_from", "b.max_tension", "main.tether_length"]
    changes = {"left.position[2]": 1e-5, "left.velocity[1]": 1e-3, "right.position[3]": 1e-5, "knot.load[2]": 1e-2,
               "main.reel_out_speed": 1e-3, "wind_velocity[2]": 1e-2}  # fmt: skip
    found = jacobian(host, outputs, list(changes))
    expected = differences(host, before, STEP, moves(19), outputs, changes)
    assert_columns_agree(found, expected, 1e-3)
    assert np.abs(expected).max(axis=0).min() > 0.0


@in_shared_process
def test_at_the_start_they_are_those_of_the_equilibrium(native_folder, driven):
    """In initialization mode: of one line those of a tether."""
    found = []
    for path, names in ((native_folder / "TetherDynamic.fmu", {}), (driven, SINGLE)):
        host = Host(path)
        given = {"kite_position": [360.0, 0.0, 380.0], "kite_velocity": [0.0, 30.0, 20.0]}
        host.enter_initialization(None)
        if not names:
            host.set(initial_length=525.0, **given)
        name = names.get("kite_force", "kite_force"), names.get("kite_position", "kite_position")
        found.append(jacobian(host, *([f"{each}[{i}]" for i in (1, 2, 3)] for each in name)))
    np.testing.assert_array_equal(found[1], found[0])
    assert np.abs(found[0]).max() > 1.0


@pytest.fixture
def driven_fmi3(built):
    return built(LINE.format(mass=""), "native_fmi3")


@in_shared_process
def test_fmi_3_has_them_too(driven, driven_fmi3):
    """A gradient of the force on the kite by its velocity, through arrays."""
    two, three = (Host(path).start() for path in (driven, driven_fmi3))
    for host in (two, three):
        host.step(STEP)
    wanted = jacobian(two, [f"kite.force[{i}]" for i in (1, 2, 3)], ["kite.velocity[2]"])
    force, velocity = three.reference["kite.force"], three.reference["kite.velocity"]
    found = three.fmu.getDirectionalDerivative([force], [velocity], [0.0, 1.0, 0.0], 3)
    np.testing.assert_array_equal(found, wanted[:, 0])
