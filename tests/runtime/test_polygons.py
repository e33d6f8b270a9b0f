"""Positions in polygons are said once, by a rule that no other motion meets."""

import subprocess
import sys

import numpy as np
import pytest

from isolation import in_shared_process
from runtime.host import Host, blob_of, of_every_flavour, restore
from tetherfmu.files.flights import KINDS
from tetherfmu.runtime.polygons import CORNERS, SENTENCE, Watch

STEP = 0.02
TIME = STEP * np.arange(3000)
CIRCLE = np.stack([300.0 * np.cos(0.1 * TIME), 300.0 * np.sin(0.1 * TIME), 200.0 + 0.0 * TIME], -1)


def seen(path, velocity=None, steps=None):
    """Step in which a polygon is found along positions (steps, 3), and its period; (None, 0) if in none."""
    watch = Watch()
    velocity = np.zeros_like(path) if velocity is None else velocity
    for k, (position, rate) in enumerate(zip(path.tolist(), velocity.tolist(), strict=True)):
        period = watch.period(tuple(position), tuple(rate), STEP if steps is None else steps[k])
        if period:
            return k, period
        if watch.is_over:
            break
    return None, 0


def rows_of(path, period):
    """Positions as FMPy gives them from every so many of the rows."""
    return np.stack([np.interp(TIME, TIME[::period], each[::period]) for each in path.T], -1)


@pytest.mark.parametrize("period", [2, 3, 5])
def test_polygons_are_found(period):
    k, found = seen(rows_of(CIRCLE, period))
    assert found == period
    assert k <= period * (CORNERS + 4)


@pytest.mark.parametrize("kind", [kind for name, kind in KINDS.items() if name != "free_end"])
def test_no_flight_is_one(kind):
    assert seen(kind().motion(TIME).kite) == (None, 0)


NONE = {
    "straight": np.multiply.outer(TIME, [20.0, 3.0, 1.0]),
    "at rest": np.ones((3000, 3)),
    "noise": CIRCLE + np.random.default_rng(1).normal(0.0, 0.02, CIRCLE.shape),
    "millimetres": np.round(CIRCLE, 3),
    "staircase": np.repeat(CIRCLE[::4], 4, axis=0),
    "some speeds": np.stack([np.interp(TIME, [0, 1, 2, 5, 20, 60], [0, 1, 3, 4, 30, 40])] * 3, -1),
    "to and fro": np.stack([np.abs((0.5 * TIME) % 2.0 - 1.0)] * 3, -1)[:400],
}


@pytest.mark.parametrize("name", NONE)
def test_nothing_else_is_one(name):
    assert seen(NONE[name]) == (None, 0)


def test_a_polygon_that_the_velocities_explain_is_meant():
    """A controller that holds a speed for two steps."""
    path = rows_of(CIRCLE, 2)
    velocity = np.diff(path, axis=0, append=path[-1:]) / STEP
    before = np.concatenate([velocity[:1], velocity[:-1]])
    assert seen(path, before) == (None, 0)


KITE = 300  # steps that an FMU flies
ON_A_TETHER = CIRCLE[:KITE]
BETWEEN = np.diff(ON_A_TETHER, axis=0, append=ON_A_TETHER[-1:]) / STEP
PATHS = {  # positions of the kite, and velocities where they are given
    "every second row": (rows_of(CIRCLE, 2)[:KITE], None),
    "every fifth row": (rows_of(CIRCLE, 5)[:KITE], None),
    "smooth": (ON_A_TETHER, None),
    "noise": (NONE["noise"][:KITE], None),
    "staircase": (NONE["staircase"][:KITE], None),
    "polygon from the tenth second on": (np.concatenate([CIRCLE[:100], rows_of(CIRCLE, 3)[100:KITE]]), None),
    "every second row, which the velocities do not explain": (rows_of(CIRCLE, 2)[:KITE], BETWEEN),
}


def said_in(host, positions, velocities):
    """Steps of a flight with their messages on polygons."""
    found = []
    for k, position in enumerate(positions):
        host.messages.clear()
        host.time = k * STEP
        given = {} if velocities is None else {"kite_velocity": tuple(velocities[k])}
        host.step(STEP, kite_position=tuple(position), **given)
        found += [(k, message.partition("kite_position comes")[2]) for message in host.messages if "polygons" in message]
    return found


@of_every_flavour("fmu", ("TetherDynamic", "TetherCatenary"))
@pytest.mark.parametrize("path", PATHS)
@in_shared_process
def test_all_flavours_say_the_same_in_the_same_step(fmu_folder, fmu, path):
    """In the step that the rule names, once; again after a reset."""
    positions, velocities = PATHS[path]
    k, period = seen(positions, velocities)
    expected = (
        [(k, SENTENCE.format(name="kite_position", period=period).partition("kite_position comes")[2])] if period else []
    )
    host = Host(fmu_folder / f"{fmu}.fmu")
    for _ in range(2):
        given = {"end_velocities": 1 if velocities is not None else 2, "initial_length": 365.0, "ground_height": -500.0}
        host.start(kite_position=tuple(positions[0]), **given)
        assert said_in(host, positions, velocities) == expected
        host.fmu.reset()


@of_every_flavour("fmu", ("TetherDynamic",))
@in_shared_process
def test_a_restored_state_begins_anew(fmu_folder, fmu):
    """Corners before it do not count: after so many more, in the step that the rule names for what follows."""
    positions, restored = PATHS["every second row"][0], 10
    host = Host(fmu_folder / f"{fmu}.fmu")
    host.start(kite_position=tuple(positions[0]), end_velocities=2, initial_length=365.0, ground_height=-500.0)
    assert not said_in(host, positions[:restored], None)
    restore(host, blob_of(host))
    k, _ = seen(positions[restored:])
    assert [step for step, _ in said_in(host, positions[restored:], None)] == [k]


def test_an_fmu_says_it_once(fmu_folder, tmp_path):
    """Rows of 50 ms and steps of 25 ms in FMPy; not with steps of 50 ms."""
    code = f"""
import sys
import numpy as np
from fmpy import simulate_fmu
time = np.arange(0.0, 5.01, 0.05)
rows = np.array([*zip(time, 480.0 * np.cos(0.1 * time), 480.0 * np.sin(0.1 * time))],
                dtype=[("time", float), ("kite_position[1]", float), ("kite_position[2]", float)])
start = {{"initial_length": 500.0, "kite_position[3]": 100.0, "end_velocities": 2}}
for step in (0.05, 0.025):
    print(f"step {{step}}", file=sys.stderr, flush=True)
    simulate_fmu({str(fmu_folder / "TetherDynamic.fmu")!r}, input=rows, start_values=start, stop_time=5.0,
                 output_interval=step)
"""
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=True)
    wide, narrow = done.stderr.split("step 0.025")
    assert "polygons" not in wide
    assert narrow.count("kite_position comes in polygons: it has a corner in every step number 2") == 1
