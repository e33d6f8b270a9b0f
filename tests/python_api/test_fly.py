"""`fly` is a loop of `step`, bit for bit: rows, peaks, node positions; refused steps keep the state and rows of before."""

import numpy as np
import pytest

from balance import VARIANTS
from scenes import CIRCLE_TETHER, circle
from tetherfmu import Outputs, StepRefused, TetherDynamic, inputs_along
from tetherfmu.python import models
from tetherfmu.python.results import SCALARS
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import by_name
from tetherfmu.runtime.parameters import Environment

STEP, STEPS = 0.02, 23
PLACES = {
    "kite_position": slice(0, 3),
    "kite_velocity": slice(3, 6),
    "ground_position": slice(6, 9),
    "ground_velocity": slice(9, 12),
    "reel_out_speed": 12,
    "wind_velocity": slice(13, 16),
    "kite_load": slice(16, 19),
}
every_variant = pytest.mark.parametrize("variant", VARIANTS)


def circle_inputs():
    """Inputs of the circle that never repeat: reel-out, gusts and a moving ground end as well."""
    inputs = np.zeros((STEPS, at.INPUTS))
    for k, row in enumerate(inputs):
        row[PLACES["kite_position"]], row[PLACES["kite_velocity"]] = circle(k * STEP)
        row[PLACES["ground_position"]] = row[PLACES["ground_velocity"]] * k * STEP
        row[PLACES["ground_velocity"]] = (0.1, 0.0, 0.0)
        row[PLACES["reel_out_speed"]] = 0.5 * np.sin(k)
        row[PLACES["wind_velocity"]] = (8.0 + np.sin(3.0 * k), 1.0, 0.0)
    return inputs


def test_rows_have_their_times():
    """At the end of the step of the row; of steps that differ, their sums; with steps left out, as if they had been done."""
    inputs, steps = circle_inputs(), np.linspace(0.01, 0.03, STEPS)
    np.testing.assert_allclose(started().fly(inputs, STEP, every=5).time, (0.1, 0.2, 0.3, 0.4), rtol=1e-12)
    np.testing.assert_allclose(started().fly(inputs, steps, every=5).time, np.cumsum(steps)[4::5], rtol=1e-12)
    assert started().fly(inputs, STEP, every=0).time.shape == (0,)
    inputs[12, PLACES["reel_out_speed"]] = np.nan
    assert len(started().fly(inputs, STEP, on_refusal="skip").time) == STEPS
    np.testing.assert_allclose(started().fly(inputs, STEP, on_refusal="stop").time, STEP * np.arange(1, 13), rtol=1e-12)


def started(variant="TetherDynamic", **options):
    model = getattr(models, variant)(CIRCLE_TETHER, **options)
    model.initialize(*circle(0.0), wind_velocity=(8.0, 1.0, 0.0))
    return model


def stepped(model, inputs):
    """Outputs and node positions after each step of a loop."""
    rows = [(model.step(STEP, **{name: row[place] for name, place in PLACES.items()}), model.positions) for row in inputs]
    return tuple(zip(*rows, strict=True))


def magnitude(force):
    return np.sqrt(force[0] * force[0] + force[1] * force[1] + force[2] * force[2])  # a power may be rounded


@every_variant
def test_equals_a_loop_of_steps(variant):
    model, twin = started(variant), started(variant)
    outputs, positions = stepped(twin, circle_inputs())
    flown = model.fly(circle_inputs(), STEP)
    for name in ("kite_force", "ground_force", "shape"):
        assert np.array_equal(getattr(flown, name), [getattr(row, name) for row in outputs])
    scalars = [[getattr(row, name) for name in Outputs._fields[2 : Outputs._fields.index("shape")]] for row in outputs]
    assert np.array_equal(flown.outputs[:, at.GROUND_TENSION : at.OUTPUT_KITE_POSITION], scalars)
    motion = [(*row.kite_position, *row.kite_velocity) for row in outputs]
    assert np.array_equal(flown.outputs[:, at.OUTPUT_KITE_POSITION : at.OUTPUT_KITE_POSITION + 6], motion)
    assert np.array_equal(flown.positions, positions)
    assert np.array_equal(flown.peak, [magnitude(row.kite_force) for row in outputs])
    assert np.array_equal(model.get_state(), twin.get_state())
    assert flown.seconds > 0.0


@every_variant
@pytest.mark.parametrize("every", [1, 4, 5, STEPS, STEPS + 1, 0])
@pytest.mark.parametrize("peaks", [True, False])
def test_rows_and_peaks(variant, every, peaks):
    """A row after every so many steps; the peak is the largest force since the row before, or that of the row."""
    outputs, positions = stepped(started(variant), circle_inputs())
    model = started(variant)
    flown = model.fly(circle_inputs(), STEP, every=every, peaks=peaks)
    kept = range(every - 1, STEPS, every) if every else []
    assert len(flown.outputs) == len(flown.peak) == len(flown.positions) == len(kept)
    forces = [magnitude(row.kite_force) for row in outputs]
    for row, k in enumerate(kept):
        assert np.array_equal(flown.kite_force[row], outputs[k].kite_force)
        assert np.array_equal(flown.positions[row], positions[k])
        assert flown.peak[row] == (max(forces[k + 1 - every : k + 1]) if peaks else forces[k])
    assert np.array_equal(model.outputs().shape, outputs[-1].shape)


@every_variant
@pytest.mark.parametrize("every", [1, 4, 0])
@pytest.mark.parametrize("kept", [{}, {"peaks": False}, {"outputs": False}])
def test_a_refused_step_keeps_the_state_of_before(variant, every, kept):
    inputs = with_gaps(9)
    model, twin = started(variant), started(variant)
    twin.fly(inputs[:9], STEP)
    with pytest.raises(StepRefused, match=r"^step 10 of 23: the input wind_velocity\[2\] is nan; it must be a finite"):
        model.fly(inputs, STEP, every=every, **kept)
    assert np.array_equal(model.get_state(), twin.get_state())
    rest = circle_inputs()[9:]
    assert np.array_equal(model.fly(rest, STEP).outputs, twin.fly(rest, STEP).outputs)


def test_a_step_is_refused_for_its_outputs_where_they_are_computed():
    """Under ground in thin air the density exp(-z/H), so the drag, exceeds all numbers: the straight line finds it."""
    inputs = circle_inputs()
    inputs[9, at.KITE_POSITION + 2] = -4000.0
    options = {"environment": Environment(air_density_scale_height=1.0)}
    for every, peaks in ((1, False), (5, False), (0, True), (4, True)):
        model, twin = started("TetherStraight", **options), started("TetherStraight", **options)
        twin.fly(inputs[:9], STEP)
        with pytest.raises(StepRefused, match=r"^step 10 of 23: an output is not a finite number"):
            model.fly(inputs, STEP, every, peaks)
        assert np.array_equal(model.get_state(), twin.get_state())
    started("TetherStraight", **options).fly(inputs, STEP, every=4, peaks=False)


@every_variant
@pytest.mark.parametrize("every", [1, 4, 0])
def test_without_outputs_the_positions_and_the_state_are_the_same(variant, every):
    model, twin = started(variant), started(variant)
    flown, expected = model.fly(circle_inputs(), STEP, every, outputs=False), twin.fly(circle_inputs(), STEP, every)
    assert np.array_equal(flown.positions, expected.positions)
    assert np.array_equal(model.get_state(), twin.get_state())
    assert np.array_equal(model.outputs().shape, twin.outputs().shape)
    assert flown.outputs is None
    assert flown.peak is None
    with pytest.raises(ValueError, match="this flight has node positions only: fly with outputs=True"):
        _ = flown.kite_force


def test_a_refusal_says_what_step_says():
    """The same sentence as that of `step`, with the speed and the length of that step."""
    inputs = circle_inputs()
    inputs[5, at.REEL_OUT_SPEED] = -1e5
    model, twin = started(), started()
    with pytest.raises(StepRefused) as alone:
        stepped(twin, inputs)
    with pytest.raises(StepRefused) as together:
        model.fly(inputs, STEP)
    assert str(together.value) == f"step 6 of {STEPS}: {alone.value}"
    assert "-100000.0 m/s over a step of 0.02 s" in str(alone.value)


def test_step_continues_after_a_flight():
    """A refused step after a flight goes back to the end of the flight."""
    inputs = circle_inputs()
    model = started()
    model.fly(inputs, STEP)
    state = model.get_state()
    with pytest.raises(StepRefused):
        model.step(-1.0)
    assert np.array_equal(model.get_state(), state)


@pytest.mark.parametrize("shape", [(at.INPUTS,), (3, at.INPUTS - 1), (3, at.INPUTS, 1)])
def test_wrong_inputs(shape):
    with pytest.raises(ValueError, match="inputs has the shape"):
        started().fly(np.zeros(shape), STEP)
    with pytest.raises(ValueError, match="every is -1; it must be a whole number of at least 0"):
        started().fly(circle_inputs(), STEP, every=-1)


def test_no_step():
    """No inputs, no rows, the state of before."""
    model = started()
    state = model.get_state()
    flown = model.fly(np.zeros((0, at.INPUTS)), STEP)
    assert len(flown.outputs) == len(flown.peak) == len(flown.positions) == len(flown.shape) == 0
    assert np.array_equal(model.get_state(), state)


def skipped(model, inputs):
    """What `on_refusal="skip"` is, as a loop: outputs and positions of each step, None where it was refused."""
    rows = []
    for row in inputs:
        try:
            rows.append((model.step(STEP, **{name: row[place] for name, place in PLACES.items()}), model.positions))
        except StepRefused:
            rows.append(None)
    return rows


def with_gaps(*places):
    inputs = circle_inputs()
    for place in places:
        inputs[place, at.WIND_VELOCITY + 1] = np.nan
    return inputs


@every_variant
@pytest.mark.parametrize("every", [1, 4, 0])
@pytest.mark.parametrize("outputs", [True, False])
def test_rows_before_a_refused_step_are_kept(variant, every, outputs):
    inputs = with_gaps(9, 15)
    good = started(variant).fly(inputs[:9], STEP, every, outputs=outputs)
    with pytest.raises(StepRefused, match=r"^step 10 of 23: ") as refused:
        started(variant).fly(inputs, STEP, every, outputs=outputs)
    stopped = started(variant).fly(inputs, STEP, every, outputs=outputs, on_refusal="stop")
    for flown in (refused.value.flown, stopped):
        assert np.array_equal(flown.positions, good.positions)
        assert len(flown.positions) == (9 // every if every else 0)
        assert outputs is (flown.outputs is not None)
        if outputs:
            assert np.array_equal(flown.outputs, good.outputs)
            assert np.array_equal(flown.peak, good.peak)
        ((place, reason, status),) = flown.refusals
        assert (place, status) == (9, refused.value.status)
        assert reason.startswith("the input wind_velocity[2] is nan; it must be a finite number")
        assert f"1 refused, the first is step 10: {reason}" in repr(flown)


@every_variant
@pytest.mark.parametrize("every", [1, 4, 0])
@pytest.mark.parametrize("span", [1000, 4, 1])
@pytest.mark.parametrize("gaps", [(0,), (9, 10, 15), (3, 22), tuple(range(STEPS))])
def test_a_skipped_step_is_left_out(variant, every, span, gaps, monkeypatch):
    monkeypatch.setattr("tetherfmu.python.compiled_flight.SPAN", span)
    inputs = with_gaps(*gaps)
    model, twin = started(variant), started(variant)
    expected = skipped(twin, inputs)
    flown = model.fly(inputs, STEP, every, on_refusal="skip")
    assert tuple(each.step for each in flown.refusals) == gaps
    kept = range(every - 1, STEPS, every) if every else []
    assert len(flown.outputs) == len(flown.peak) == len(flown.positions) == len(kept)
    for row, k in enumerate(kept):
        if expected[k] is None:
            assert np.isnan(flown.outputs[row]).all()
            assert np.isnan(flown.positions[row]).all()
            assert np.isnan(flown.peak[row])
        else:
            assert np.array_equal(flown.kite_force[row], expected[k][0].kite_force)
            assert np.array_equal(flown.positions[row], expected[k][1])
            done = [each for each in expected[k + 1 - every : k + 1] if each is not None]
            assert flown.peak[row] == max(magnitude(each[0].kite_force) for each in done)
    assert np.array_equal(model.get_state(), twin.get_state())  # with the inputs of the last step that was done
    assert model.step(STEP).kite_tension == twin.step(STEP).kite_tension


@every_variant
def test_skipping_without_a_refusal_is_a_flight(variant):
    for options in ({}, {"every": 4}, {"every": 5, "peaks": False}, {"every": 4, "outputs": False}):
        plain, skipping = (
            started(variant).fly(circle_inputs(), STEP, on_refusal=way, **options) for way in ("raise", "skip")
        )
        assert np.array_equal(plain.positions, skipping.positions)
        assert np.array_equal(plain.peak, skipping.peak)
        assert np.array_equal(plain.outputs, skipping.outputs)
        assert plain.refusals == skipping.refusals == ()


@pytest.mark.parametrize("every", [0, 1, 3])
@pytest.mark.parametrize("control", ["speed", "force", "length"])
def test_uneven_steps_and_winds_at_the_nodes_equal_a_loop(every, control):
    count, segments = 12, 4
    random = np.random.default_rng(7)
    steps, winds = random.uniform(0.005, 0.03, count), random.uniform(-5.0, 12.0, (count, segments + 1, 3))
    time = np.concatenate(([0.0], np.cumsum(steps)[:-1]))
    rows = inputs_along(count, 0.02)
    told = {"force": {"winch_force": 150.0 + 5.0 * time}, "length": {"winch_length": 505.0 + 0.1 * time}}.get(control, {})
    for name, values in told.items():
        by_name(rows)[name][:, 0] = values
    one, other = (TetherDynamic(segments=segments, winch_control=control) for _ in range(2))
    for tether in (one, other):
        tether.initialize()
    flown = one.fly(rows, steps, every, node_winds=winds)
    found = []
    for k in range(count):
        given = {name: by_name(rows)[name][k] for name in ("kite_position", "kite_velocity")}
        given |= {name: values[k] for name, values in told.items()}
        found.append(other.step(steps[k], wind_velocity=winds[k], **given).kite_force)
    assert np.array_equal(one.get_state(), other.get_state())
    if every:
        assert np.array_equal(flown.kite_force, found[every - 1 :: every])
        peaks = np.linalg.norm(found, axis=1).reshape(-1, every).max(axis=1)
        np.testing.assert_allclose(flown.peak, peaks, rtol=1e-15)


def test_a_refused_uneven_step_keeps_the_state_and_the_winds_of_before():
    rows, steps = inputs_along(6, 0.02), np.array((0.01, 0.02, 0.03, -1.0, 0.02, 0.01))
    winds = np.arange(6.0)[:, None, None] * np.ones((6, 5, 3))
    one, other = (TetherDynamic(segments=4) for _ in range(2))
    for tether in (one, other):
        tether.initialize()
    with pytest.raises(StepRefused, match="step 4 of 6") as refused:
        one.fly(rows, steps, node_winds=winds)
    assert len(refused.value.flown.kite_force) == 3
    other.fly(rows[:3], steps[:3], node_winds=winds[:3])
    assert np.array_equal(one.get_state(), other.get_state())
    skipped = one.fly(rows, steps, node_winds=winds, on_refusal="skip")
    assert np.flatnonzero(np.isnan(skipped.kite_force[:, 0])).tolist() == [3]


@pytest.mark.parametrize(
    ("given", "problem"),
    [
        ({"step": np.full(5, 0.02)}, "step has the shape"),
        ({"step": 0.02, "node_winds": np.zeros((6, 4, 3))}, "node_winds has the shape"),
        ({"step": 0.02, "node_winds": np.full((6, 5, 3), np.nan)}, "not finite"),
    ],
)
def test_wrong_steps_and_winds(given, problem):
    tether = TetherDynamic(segments=4)
    tether.initialize()
    with pytest.raises(ValueError, match=problem):
        tether.fly(inputs_along(6, 0.02), **given)


# --- scalar outputs by their names


COUNT = 20


def test_columns_are_the_outputs_of_the_steps():
    """Bit for bit, since `fly` equals a loop of `step`; the speeds give each output another value."""
    flying, stepping = (TetherDynamic(segments=5) for _ in range(2))
    flying.initialize()
    stepping.initialize()
    flown = flying.fly(inputs_along(COUNT, STEP, reel_out_speed=0.5, wind_velocity=(8.0, 1.0, 0.0)), STEP)
    rows = [stepping.step(STEP, reel_out_speed=0.5, wind_velocity=(8.0, 1.0, 0.0)) for _ in range(COUNT)]
    for name in SCALARS:
        np.testing.assert_array_equal(flown.of(name), [getattr(row, name) for row in rows])


def test_scalars_are_all_outputs_but_vectors():
    assert set(SCALARS) == {
        "ground_tension", "kite_tension", "max_tension", "tether_length", "ground_elevation", "ground_azimuth",
        "slack_segments", "kite_end_mass", "kite_stiffness", "kite_damping", "wave_time", "sag", "winch_speed",
        "solver_steps", "solver_rejections", "solver_iterations", "grounded_length",
        "solver_iteration_limit", "fallback_steps", "peak_tension", "broken", "break_time",
    }  # fmt: skip


def test_another_name_is_refused_with_those_that_exist():
    tether = TetherDynamic(segments=5)
    tether.initialize()
    flown = tether.fly(inputs_along(1, STEP), STEP)
    with pytest.raises(
        ValueError, match=r"^there is no scalar output 'tension'; did you mean ground_tension, kite_tension, max_tens"
    ):
        flown.of("tension")
    with pytest.raises(ValueError, match=r"^there is no scalar output 'lift'; there are ground_tension, kite_tension, "):
        flown.of("lift")


def test_it_is_printed_in_one_line():
    tether = TetherDynamic(segments=5)
    tether.initialize()
    assert repr(tether.fly(inputs_along(4, STEP), STEP)) == "<Flown: 4 rows, 6 nodes, all outputs>"
    assert repr(tether.fly(inputs_along(4, STEP), STEP, outputs=False)) == "<Flown: 4 rows, 6 nodes, node positions only>"
