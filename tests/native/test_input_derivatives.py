"""Derivatives of inputs that an importer gives through FMI 2: they replace what the tether would estimate, for one step."""

import math

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException

from isolation import in_shared_process
from native.flights import flown, give
from runtime.host import Host, blob_of, restore
from tetherfmu.export.archive import SLAVES
from y_of_lines import y_of_lines

STEP = 0.1
KITE, VELOCITY, ACCELERATION = np.array([300.0, 0.0, 400.0]), np.array([3.0, -20.0, 5.0]), np.array([-4.0, 2.0, 7.0])
every_fmu = pytest.mark.parametrize("name", list(SLAVES))
every_driven_fmu = pytest.mark.parametrize("name", [name for name in SLAVES if name != "TetherDynamicFree"])


@pytest.mark.parametrize("continuation", [1, 2], ids=["linear", "held"])
@every_fmu
@in_shared_process
def test_length(native_folder, name, continuation):
    """L grows by s h + a h^2/2, in the first step, too; the next step estimates again: its speed is that of before."""
    host = Host(native_folder / f"{name}.fmu").start(input_continuation=continuation)
    give(host, reel_out_speed=3.0)
    host.step(STEP, reel_out_speed=2.0)
    length = 505.0 + 2.0 * STEP + 0.5 * 3.0 * STEP**2
    assert host.get("tether_length") == pytest.approx(length, rel=1e-14)
    host.step(STEP, reel_out_speed=2.0)
    assert host.get("tether_length") == pytest.approx(length + 2.0 * STEP, rel=1e-14)


@pytest.mark.parametrize("continuation", [1, 2], ids=["linear", "held"])
@every_fmu
@in_shared_process
def test_force_of_the_winch(native_folder, name, continuation):
    """A winch without mass holds W + h dW/dt at the end of the step; without a derivative what it estimates, or W."""
    host = Host(native_folder / f"{name}.fmu")
    host.start(input_continuation=continuation, winch_control=2, initial_length=500.0, relative_tolerance=1e-8)
    for force, derivative, end in ((800.0, 3000.0, 1100.0), (900.0, -2000.0, 700.0), (950.0, None, (1000.0, 950.0))):
        if derivative is not None:
            give(host, winch_force=derivative)
        host.step(STEP, winch_force=force)
        expected = end if derivative is not None else end[continuation - 1]
        assert host.get("ground_tension") == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("end_velocities", [1, 2], ids=["given", "derived"])
@every_driven_fmu
@in_shared_process
def test_way_of_the_end(native_folder, name, end_velocities):
    """p + v h + a h^2/2; where velocities are derived from positions, v is the derivative of the position."""
    host = Host(native_folder / f"{name}.fmu").start(end_velocities=end_velocities, kite_velocity=VELOCITY)
    give(host, kite_velocity=ACCELERATION, kite_position=VELOCITY if end_velocities == 2 else VELOCITY + 100.0)
    host.step(STEP, kite_position=KITE, kite_velocity=VELOCITY if end_velocities == 1 else np.zeros(3))
    expected = KITE + STEP * VELOCITY + 0.5 * STEP**2 * ACCELERATION
    assert [host.get(f"shape[21,{i}]") for i in (1, 2, 3)] == pytest.approx(expected, abs=1e-9)


@in_shared_process
def test_wind_at_the_end_of_a_step(native_folder):
    """The straight tether feels the wind of the end of the step: w + h dw/dt."""
    wind, rate = np.array([8.0, 1.0, 0.0]), np.array([-10.0, 20.0, 0.0])
    growing, constant = (Host(native_folder / "TetherStraight.fmu").start(initial_length=490.0) for _ in range(2))
    give(growing, wind_velocity=rate)
    growing.step(STEP, wind_velocity=wind)
    constant.step(STEP, wind_velocity=wind + STEP * rate)
    assert growing.all_outputs() == pytest.approx(constant.all_outputs(), rel=1e-13)


@every_fmu
@in_shared_process
def test_error_in_a_flight_with_all_inputs_in_motion(native_folder, name):
    """Against steps of 1 ms with estimates: the error falls with the square of the step, and is a fraction of before.

    Observed: orders 1.85 to 2.4, parts of 0.05 (free kite) to 0.27 (straight).
    """
    path = native_folder / f"{name}.fmu"
    fine = flown(path, 0.001, given=False, tolerance=1e-8)

    def error(step, given):
        return np.sqrt(np.mean((flown(path, step, given) - fine) ** 2))

    smaller = error(0.025, given=True)
    assert smaller < 0.4 * error(0.025, given=False)
    assert np.log2(error(0.05, given=True) / smaller) > 1.7


TOGETHER = {  # inputs of a step, and derivatives of all of them that have one
    "a tether": (
        {"kite_position": KITE, "kite_velocity": VELOCITY, "reel_out_speed": 1.0, "wind_velocity": (5.0, 1.0, 0.0)},
        dict.fromkeys(("kite_velocity", "ground_velocity", "wind_velocity"), ACCELERATION) | {"reel_out_speed": 3.0},
    ),
    "Y": (
        {"left.velocity": (0.0, 1.0, 0.0), "knot.load": (0.0, 2.0, 5.0), "main.reel_out_speed": 0.1},
        {"left.velocity": (5.0, 3.0, 1.0), "knot.load": (400.0, 0.0, 900.0), "main.reel_out_speed": 2.0},
    ),
}
driven_and_y = pytest.mark.parametrize("name", [*(name for name in SLAVES if name != "TetherDynamicFree"), "Y"])


@pytest.fixture
def native(native_folder, built, name):
    return built(y_of_lines("Y"), "native") if name == "Y" else native_folder / f"{name}.fmu"


@pytest.fixture
def by_python(fmu_folder, built, name):
    return built(y_of_lines("Y")) if name == "Y" else fmu_folder / f"{name}.fmu"


def step_with_all(host):
    host.step(STEP, **TOGETHER.get(host.name, TOGETHER["a tether"])[0])
    return host.all_outputs()


def ready(path):
    """An instance that has done two steps without derivatives."""
    host = Host(path).start()
    step_with_all(host)
    step_with_all(host)
    return host


@driven_and_y
@in_shared_process
def test_they_wait_in_a_saved_state_and_through_a_refused_step(native, by_python, name):
    """Also in a state that goes on in PythonFMU's FMU, to which nobody can give any."""
    derivatives = TOGETHER.get(name, TOGETHER["a tether"])[1]
    host = ready(native)
    give(host, **derivatives)
    blob = blob_of(host)
    expected = step_with_all(host)
    assert expected != step_with_all(ready(native))
    restore(host, blob)
    with pytest.raises(FMICallException):
        host.step(-STEP)
    assert step_with_all(host) == expected
    for path in (native, by_python):
        taker = Host(path)
        restore(taker, blob)
        assert step_with_all(taker) == expected


OF_LENGTH = [("TetherStraight", "reel_out_speed", "tether_length", 505.0)]
OF_LENGTH += [("Y", "main.reel_out_speed", "main.tether_length", 100.0)]


@pytest.mark.parametrize(("name", "speed", "length", "start"), OF_LENGTH)
@in_shared_process
def test_given_before_the_initialization_ends(native, name, speed, length, start):
    """They count in the first step; a reset forgets them."""
    host = Host(native)
    give(host, **{speed: 3.0})
    host.start().step(STEP, **{speed: 2.0})
    assert host.get(length) == pytest.approx(start + 2.0 * STEP + 0.5 * 3.0 * STEP**2, rel=1e-14)
    give(host, **{speed: 3.0})
    host.fmu.reset()
    host.start().step(STEP, **{speed: 2.0})
    assert host.get(length) == pytest.approx(start + 2.0 * STEP, rel=1e-14)


@in_shared_process
def test_none_is_taken_after_the_termination(native_folder):
    host = Host(native_folder / "TetherStraight.fmu").start()
    host.fmu.terminate()
    host.refuses(lambda: give(host, reel_out_speed=7.0), "reel_out_speed cannot be set to 7.0 after the termination")


WRONG = (
    ("reel_out_speed", 2, 1.0, "the order of the derivative of reel_out_speed is 2; it must be 1"),
    ("reel_out_speed", 0, 1.0, "the order of the derivative of reel_out_speed is 0; it must be 1"),
    ("kite_velocity[2]", 1, math.nan, "the derivative of kite_velocity[2] is nan; it must be a finite number"),
    ("kite_velocity[2]", 1, -2e9, "the derivative of kite_velocity[2] is -2000000000.0; it must be a finite number"),
    ("sag", 1, 1.0, "(sag) cannot be used here: it is not a continuous input"),
    ("diameter", 1, 1.0, "cannot be used here: it is not a continuous input"),
    ("segments", 1, 1.0, "cannot be used here: it is not a continuous input"),
    (12345, 1, 1.0, "value reference 12345 (no variable of this FMU) cannot be used here: it is not a continuous input"),
)


@pytest.mark.parametrize(("variable", "order", "value", "words"), WRONG)
@in_shared_process
def test_refused_in_words_and_none_is_kept(native_folder, variable, order, value, words):
    host = Host(native_folder / "TetherStraight.fmu").start()
    references = [host.reference["reel_out_speed"], host.reference.get(variable, variable)]
    host.refuses(lambda: host.fmu.setRealInputDerivatives(references, [1, order], [7.0, value]), words)
    host.step(STEP, reel_out_speed=2.0)
    assert host.get("tether_length") == pytest.approx(505.0 + 2.0 * STEP, rel=1e-14)
