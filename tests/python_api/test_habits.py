"""What users of the Python API expect: inputs stay, the short form, states, node positions, lengths, refusals in words."""

import numpy as np
import pytest

from scenes import same
from tetherfmu import (
    Environment,
    Solver,
    StepRefused,
    Tether,
    TetherCatenary,
    TetherDynamic,
    TetherDynamicFree,
    TetherQuasiSteady,
    TetherStraight,
    inputs_along,
)
from tetherfmu.runtime import status
from tetherfmu.runtime.inputs import COUNT
from tetherfmu.runtime.variants import TABLE

KITE, WIND = (300.0, 0.0, 400.0), (8.0, 1.0, 0.0)
EVERY = (TetherStraight, TetherCatenary, TetherQuasiSteady, TetherDynamic)
every_model = pytest.mark.parametrize("model", EVERY, ids=lambda model: model.variant)


@every_model
def test_an_input_that_is_not_given_stays(model):
    given, kept = model(initial_length=520.0), model(initial_length=520.0)
    inputs = {"kite_position": (310.0, 5.0, 390.0), "kite_velocity": (1.0, 0.0, 0.0), "wind_velocity": WIND}
    for tether in (given, kept):
        tether.initialize(KITE, wind_velocity=WIND)
        tether.step(0.02, **inputs, ground_velocity=(0.1, 0.0, 0.0), reel_out_speed=0.5)
    for _ in range(5):
        one = given.step(0.02, **inputs, ground_velocity=(0.1, 0.0, 0.0), reel_out_speed=0.5)
        assert same(one, kept.step(0.02))


@every_model
def test_a_refused_step_keeps_the_inputs_too(model):
    refused, twin = model(), model()
    for tether in (refused, twin):
        tether.initialize(KITE, wind_velocity=WIND)
    with pytest.raises(StepRefused, match="reel_out_speed") as refusal:
        refused.step(0.02, kite_position=(310.0, 0.0, 400.0), reel_out_speed=-1e6)
    assert refusal.value.status == status.REELED_TOO_SHORT
    with pytest.raises(ValueError, match=r"wind_velocity has the shape \(\); it must be \(3,\)"):
        refused.step(0.02, kite_position=(310.0, 0.0, 400.0), wind_velocity=3.0)
    assert same(refused.step(0.02), twin.step(0.02))


@every_model
def test_nothing_before_the_start(model):
    tether = model()
    asked = [
        lambda: tether.step(0.02),
        tether.outputs,
        lambda: tether.fly(np.zeros((1, COUNT)), 0.02),
        lambda: tether.positions,
    ]
    for ask in asked:
        with pytest.raises(StepRefused, match=f"this {model.__name__} is not initialized: call initialize first") as refusal:
            ask()
        assert refusal.value.status is None
    assert repr(tether).endswith("505 m unstretched, not initialized>")
    tether.initialize(KITE)
    assert repr(tether).endswith("505 m unstretched, running>")


@every_model
def test_the_short_form_is_the_long_one(model):
    long = model(Tether(initial_length=525.0, segments=7), Environment(wind_profile=2), Solver(relative_tolerance=1e-3))
    short = model(initial_length=525.0, segments=7, wind_profile="power_law", relative_tolerance=1e-3)
    assert same(long.initialize(KITE, wind_velocity=WIND), short.initialize(KITE, wind_velocity=WIND))
    base = model(Tether(initial_length=525.0), segments=7, wind_profile="power_law", relative_tolerance=1e-3)
    assert same(long.outputs(), base.initialize(KITE, wind_velocity=WIND))


def test_enumerations_have_names():
    assert Tether(damping_law="stretch_rate") == Tether(damping_law=2)
    assert Environment(wind_profile="explog").wind_profile == 4
    assert Solver(initial_shape="straight").initial_shape == 3
    with pytest.raises(ValueError, match=r"damping_law is 'rate'; it must be one of 1 \(strain_rate\), 2 \(stretch_rate\)"):
        Tether(damping_law="rate")


@pytest.mark.parametrize("name", ["ground_contact", "segments", "axial_damping"])
def test_a_truth_value_is_no_number(name):
    """`ground_contact=True` would be choice 1, which is "none"."""
    with pytest.raises(ValueError, match=f"{name} is True; it must be "):
        TetherDynamic(**{name: True})


@every_model
def test_slack_is_a_share_of_the_distance(model):
    tether = model(initial_length=123.0)
    outputs = tether.initialize(KITE, ground_position=(0.0, 0.0, 100.0), slack=0.02)
    assert outputs.tether_length == pytest.approx(1.02 * np.hypot(300.0, 300.0), rel=1e-15)
    again = model(initial_length=outputs.tether_length).initialize(KITE, ground_position=(0.0, 0.0, 100.0))
    # the shares of the segments are rounded for another length
    np.testing.assert_allclose(outputs.kite_force, again.kite_force, rtol=1e-9, atol=1e-9)
    with pytest.raises(ValueError, match=r"slack is -1.0: the tether would be 0 m long; it must be at least 0\.\d+ m"):
        tether.initialize(KITE, slack=-1.0)
    assert same(tether.outputs(), outputs)
    assert tether.initialize((100.0, 0.0, 0.0)).tether_length == 123.0


@pytest.mark.parametrize("model", EVERY[:3], ids=lambda model: model.variant)
def test_the_length_may_be_given_where_there_are_no_waves(model):
    """As if the tether had had that length from the start; and reeling material changes nothing at that."""
    tether = model(initial_length=520.0)
    tether.initialize(KITE, wind_velocity=WIND)
    outputs = tether.step(0.02, tether_length=510.0)
    assert outputs.tether_length == 510.0
    new = model(initial_length=510.0)
    new.initialize(KITE, wind_velocity=WIND)
    # the shape in equilibrium is found from another start: to the tolerance of Newton's method
    np.testing.assert_allclose(outputs.kite_force, new.step(0.02).kite_force, rtol=1e-8)
    assert tether.step(0.02, tether_length=500.0, reel_out_speed=-1.0).tether_length == pytest.approx(500.0, rel=1e-15)
    kept = tether.outputs()
    with pytest.raises(StepRefused):
        tether.step(0.02, tether_length=-1.0)
    assert same(tether.outputs(), kept)


def test_node_positions_and_velocities_at_the_start():
    tether = TetherDynamic(initial_length=505.0, segments=4)
    positions = np.linspace((0.0, 0.0, 10.0), (300.0, 0.0, 400.0), 5) + np.array([0, 1, 3, 1, 0])[:, None]
    velocities = np.arange(15.0).reshape(5, 3)
    outputs = tether.initialize(positions=positions, velocities=velocities)
    np.testing.assert_array_equal(tether.positions, positions)
    np.testing.assert_array_equal(tether.velocities, velocities)
    np.testing.assert_array_equal(outputs.shape[[0, -1]], positions[[0, -1]])
    twin = TetherDynamic(initial_length=505.0, segments=4)
    twin.initialize(positions=positions, velocities=velocities)
    assert same(tether.step(0.02), twin.step(0.02))
    assert np.abs(tether.positions[1:-1] - positions[1:-1] - 0.02 * velocities[1:-1]).max() < 1.0


@pytest.mark.parametrize("model", EVERY[2:], ids=lambda model: model.variant)
def test_segments_have_lengths_and_tensions(model):
    """Hooke's law for what is taut at rest, the slack ratio for what is not; the largest is the output max_tension."""
    tether = model(initial_length=505.0, segments=6, axial_damping=0.0)
    for length in (505.0, 499.0):
        outputs = model(initial_length=length, segments=6, axial_damping=0.0)
        result = outputs.initialize(KITE)
        strain = outputs.segment_lengths * 6 / length - 1.0
        expected = 614600.0 * strain * np.where(strain > 0.0, 1.0, 0.01)
        np.testing.assert_allclose(outputs.segment_tensions, expected, rtol=1e-9, atol=1e-6)
        assert result.max_tension == pytest.approx(outputs.segment_tensions.max(), rel=1e-12)
        assert (result.ground_tension, result.kite_tension) == pytest.approx(outputs.segment_tensions[[0, -1]], rel=1e-12)
    with pytest.raises(StepRefused, match="not initialized"):
        tether.segment_tensions  # noqa: B018


def test_lines_without_nodes_say_so():
    for variant in (each.name for each in TABLE if not each.has_nodes):
        tether = next(model for model in EVERY if model.variant == variant)()
        tether.initialize(KITE)
        with pytest.raises(ValueError, match="has no nodes, so no energy and no tensions of segments"):
            tether.segment_tensions  # noqa: B018


def test_states_start_a_tether_too():
    first, second = TetherDynamic(), TetherDynamic()
    first.initialize(KITE, wind_velocity=WIND)
    second.set_state(first.get_state())
    assert same(first.outputs(), second.outputs())


# --- TetherDynamicFree: the dynamic tether with a free end and a point mass there, by shorter words


LOAD = (150.0, 20.0, 300.0)


def started(segments=8, **options):
    tether = TetherDynamicFree(segments=segments, **options)
    tether.initialize(KITE, wind_velocity=WIND)
    return tether


def test_is_the_dynamic_tether_with_a_free_end_and_a_point_mass():
    short = started(kite_mass=12.0, point_masses={3: 1.0, 8: 2.0})
    long = TetherDynamic(segments=8, free_ends=(False, True), point_masses={3: 1.0, 8: 14.0})
    long.initialize(KITE, wind_velocity=WIND)
    for _ in range(20):
        assert same(short.step(0.02, kite_load=LOAD), long.step(0.02, kite_load=LOAD))


def test_outputs_have_the_motion_of_the_kite():
    tether = started()
    assert tether.outputs().kite_position.tolist() == list(KITE)
    outputs = tether.step(0.02, LOAD)
    np.testing.assert_array_equal(outputs.kite_position, tether.positions[-1])
    np.testing.assert_array_equal(outputs.kite_velocity, tether.velocities[-1])
    assert np.linalg.norm(outputs.kite_velocity) > 0.0


def test_a_load_stays_and_is_none_after_a_new_start():
    kept, given, without = started(), started(), started()
    for tether in (kept, given):
        tether.step(0.02, kite_load=LOAD)
    assert same(kept.step(0.02), given.step(0.02, kite_load=LOAD))
    kept.initialize(KITE, wind_velocity=WIND)
    assert same(kept.step(0.02), without.step(0.02))


def test_the_motion_of_the_kite_is_no_input():
    tether = started()
    with pytest.raises(TypeError, match="kite_position"):
        tether.step(0.02, kite_position=KITE)
    with pytest.raises(ValueError, match=r"kite_load is 3\.0; it must be three numbers"):
        tether.step(0.02, kite_load=3.0)


def test_a_load_that_is_no_number_is_refused():
    refused, twin = started(), started()
    with pytest.raises(StepRefused, match=r"the input kite_load\[3\] is nan; it must be a finite number"):
        refused.step(0.02, kite_load=(0.0, 0.0, np.nan))
    assert same(refused.step(0.02), twin.step(0.02))


@pytest.mark.parametrize("mass", [-1.0, np.nan, 1e10, "heavy"])
def test_a_mass_out_of_range_is_refused(mass):
    with pytest.raises(ValueError, match=f"kite_mass is {mass!r}; it must be at least 0 kg and at most 1e"):
        TetherDynamicFree(kite_mass=mass)


def test_a_flight_in_compiled_code_equals_a_loop():
    def load(time):
        return np.add(LOAD, (10.0 * time, 0.0, 0.0))

    looped, flown = started(), started()
    rows = [looped.step(0.02, kite_load=load(0.02 * k), wind_velocity=WIND) for k in range(30)]
    flight = flown.fly(inputs_along(30, 0.02, wind_velocity=WIND, kite_load=load), 0.02)
    np.testing.assert_array_equal(flight.kite_force, [row.kite_force for row in rows])
    np.testing.assert_array_equal(flight.positions[:, -1], [row.kite_position for row in rows])
