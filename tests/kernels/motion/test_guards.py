"""Guards: what a hostile step meets in the solvers, and how much work one call may do at most.

Each test fails without its guard (the constant or the condition that it names). A call does at most `layout.WORK_BUDGET`
over n internal steps (adaptive), or `limits.MOST_BUDGETS` times as many unless more are expected; or
`layout.ITERATION_BUDGET` over n iterations, plus those of one fixed step. `bounds.most_work` adds them up.
"""

from math import inf
from types import SimpleNamespace

import numpy as np
import pytest

from bounds import most_work
from solvers import MODELS
from tetherfmu import Environment, Solver, StepRefused, Tether, TetherDynamic
from tetherfmu.kernels.line import backward_euler, step_control
from tetherfmu.kernels.motion import adaptive_steps, fixed_steps
from tetherfmu.kernels.rest.compressed_chain import NUDGE
from tetherfmu.runtime import layout as at
from tetherfmu.runtime import limits, status

SOLVERS = [Solver(), Solver(fixed_step=0.01)]
KITE = (3.0, 0.0, 4.0)
HARD = Tether(segments=300, initial_length=600.0, axial_stiffness=1e7, axial_damping=0.0)
IN_WIND = {"kite_position": (300.0, 0.0, 400.0), "wind_velocity": (20.0, 0.0, 0.0)}


def started(solver, segments=4, length=5.2, **options):
    model = TetherDynamic(Tether(segments=segments, initial_length=length), solver=solver, **options)
    model.initialize(kite_position=KITE)
    return model


def nodes(model, state):
    """Views of positions and velocities in a state, (n + 1, 3) each."""
    return state[at.STATE_HEADER : at.nodes_end(model.segments)].reshape(2, model.segments + 1, 3)


@pytest.mark.parametrize("tether", MODELS)
@pytest.mark.parametrize("fixed_step", [0.0, 0.01])
def test_reeling_in_stops_at_a_centimetre_per_segment(tether, fixed_step):
    """`layout.MIN_SEGMENT_LENGTH`: without it the stiffness EA/l0 grows beyond all bounds, then changes its sign."""
    segments = 1 if tether in MODELS[2:] else 4
    solver = Solver(fixed_step=fixed_step, input_continuation="held")
    model, kite = tether(Tether(segments=4, initial_length=5.0), solver=solver), (0.03, 0.0, 0.02)
    model.initialize(kite_position=kite)
    before = model.get_state()
    shortest = at.MIN_SEGMENT_LENGTH * segments
    for rest in (0.999 * shortest, 0.0, -1.0):
        with pytest.raises(StepRefused, match=r"segments shorter than 0\.01 m .*stop reeling in earlier"):
            model.step(1.0, kite_position=kite, reel_out_speed=rest - 5.0)
        np.testing.assert_array_equal(model.get_state(), before)
    assert model.step(1.0, kite_position=kite, reel_out_speed=shortest * (1.0 + 1e-9) - 5.0).tether_length == pytest.approx(
        shortest
    )
    assert model.step(0.02, reel_out_speed=0.1).tether_length == pytest.approx(shortest + 0.002)


@pytest.mark.parametrize("solver", SOLVERS)
def test_nodes_in_one_place(solver):
    """`segment.SHORTEST`: without it the direction of a segment of length 0 is 0/0."""
    model = started(solver)
    state = model.get_state()
    positions, _ = nodes(model, state)
    positions[2] = positions[1]
    model.set_state(state)
    out = model.step(0.01, kite_position=KITE)
    assert np.isfinite(model.get_state()).all()
    assert np.isfinite(out.max_tension)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("value", [np.nan, 1e200, 1e300])
def test_a_state_out_of_the_range_of_numbers(solver, value):
    """`transaction.check_state`, and `error < inf` of the adaptive solver: refused, and the state kept bit for bit."""
    model = started(solver)
    state = model._state  # `set_state` takes no number that is not finite
    nodes(model, state)[1, 2] = value
    state = state.copy()
    with pytest.raises(StepRefused, match=r"overflowed|cannot reach the relative_tolerance"):
        model.step(0.01, kite_position=KITE)
    np.testing.assert_array_equal(model._state, state)


def test_a_singular_matrix_makes_the_step_shorter():
    """M/d - d K is exactly 0 across a compressed line at h = 0.5 s, d = h/4: m/d = 8, 2 d r k (l0 - l)/l = 8."""
    tether = Tether(
        segments=2,
        initial_length=2.0,
        axial_stiffness=64.0,
        axial_damping=0.0,
        drag_coefficient=0.0,
        slack_stiffness_ratio=0.5,
    )
    model = TetherDynamic(tether, Environment(gravity=0.0), Solver(relative_tolerance=0.1, initial_shape=3))
    model._parameters[at.PARAMETER_SCALARS + at.LINE_DENSITY * 2 : at.PARAMETER_SCALARS + at.DRAG_WIDTH * 2] = 1.0
    kite = (1.0, 0.0, 0.0)
    model.initialize(kite_position=kite)
    model.step(0.5, kite_position=kite)
    assert model.counters["rejections"] >= 1
    # at the end of the step the compressed chain is moved sideways, so that it does not stay
    np.testing.assert_allclose(model.positions, [(0.0, 0.0, 0.0), (0.5, NUDGE, 0.0), kite], atol=1e-12)


def steps_of_one_size(monkeypatch, segments, part, last_error=0.0):
    """Status and number of internal steps of the adaptive solver, each of them this part of the communication step.

    last_error : what the last communication step has left.
    """
    tried = []
    monkeypatch.setattr(adaptive_steps, "attempt", lambda *arguments: tried.append(arguments) or 1.0)
    monkeypatch.setattr(adaptive_steps, "next_step", lambda h, done, *others: max(h, done))
    monkeypatch.setattr(adaptive_steps, "begin_breaks", lambda system: False)
    monkeypatch.setattr(adaptive_steps, "count_of", lambda system: 0)
    monkeypatch.setattr(adaptive_steps, "count_free", lambda system: 0)
    monkeypatch.setattr(adaptive_steps, "part_to_slack", lambda *arguments: inf)
    monkeypatch.setattr(adaptive_steps, "accept", lambda *arguments: None)
    monkeypatch.setattr(adaptive_steps, "check_ends", lambda system: status.OK)
    monkeypatch.setattr(adaptive_steps, "state_of", lambda system, k: system.state)
    monkeypatch.setattr(adaptive_steps, "work_of", lambda system: segments)
    state = np.zeros(at.STATE_HEADER)
    state[at.SOLVER_STEP], state[at.SOLVER_ERROR] = part, last_error
    return adaptive_steps.integrate.py_func(SimpleNamespace(state=state), 1.0), len(tried)


@pytest.mark.parametrize("segments", [2, 20, 300])
def test_a_step_on_course_to_too_many_is_refused_at_its_budget(monkeypatch, segments):
    """With a billionth of the communication step: after the work of 10 000 internal steps of 20 segments."""
    result, tried = steps_of_one_size(monkeypatch, segments, 1e-9)
    assert (result, tried) == (status.STEP_BUDGET_SPENT, 10_000 * 20 // segments)


@pytest.mark.parametrize(("budgets", "expected"), [(0.5, 0.5), (19.0, 19.0), (21.0, 20.0), (99.0, 20.0), (101.0, 1.0)])
def test_a_step_on_course_may_take_some_budgets(monkeypatch, budgets, expected):
    """Up to MOST_BUDGETS = 20; one that would take more than MOST_EXPECTED = 100 is refused after one."""
    result, tried = steps_of_one_size(monkeypatch, 200, 1.0 / (1000.0 * budgets))
    assert result == (status.OK if budgets == expected else status.STEP_BUDGET_SPENT)
    assert tried == pytest.approx(1000.0 * expected, rel=0.01)


def test_after_a_step_that_was_given_up_the_next_has_one_budget(monkeypatch):
    result, tried = steps_of_one_size(monkeypatch, 200, 1.0 / 19_000.0, last_error=step_control.UNRESOLVED)
    assert (result, tried) == (status.STEP_BUDGET_SPENT, 1000)


def test_a_step_that_is_given_up_is_done_with_fixed_steps():
    """An undamped straight line of 300 slack segments buckles: within a second of it the solver has spent its budget.

    The step is then that of a tether with 40 000/300 fixed steps, bit for bit, and that is told; the next one is again one
    of the adaptive solver.
    """
    model = TetherDynamic(HARD, solver=Solver(relative_tolerance=1e-6, initial_shape=3))
    model.initialize(**IN_WIND)
    fixed = TetherDynamic(HARD, solver=Solver(fixed_step=300.0 / limits.COARSE_WORK, initial_shape=3))
    fixed.initialize(**IN_WIND)
    for step in (model.step, fixed.step):
        step(1.0, **IN_WIND)
    np.testing.assert_array_equal(model.positions, fixed.positions)
    np.testing.assert_array_equal(model.velocities, fixed.velocities)
    assert any("was done with fixed steps of 0.0075 s" in each for each in model.implausible)
    assert limits.WORK_BUDGET <= HARD.segments * sum(model.counters.values()) <= most_work(HARD.segments)
    before = model.counters["steps"]
    model.step(1e-4, **IN_WIND)
    assert 0 < model.counters["steps"] - before < 100


def test_a_slack_line_that_is_given_up_comes_to_rest_where_it_hangs():
    """Given up at first; a hundred times the drag takes the energy, and the ends pull as those of a hanging tether."""
    tether = Tether(segments=60, initial_length=12.0, axial_stiffness=1e8, axial_damping=0.0, drag_coefficient=100.0)
    model = TetherDynamic(tether, solver=Solver(relative_tolerance=1e-6, initial_shape=3))
    still = {"kite_position": (10.0, 0.0, 0.0)}
    model.initialize(**still)
    hanging = TetherDynamic(tether).initialize(**still)
    for _ in range(12):
        out = model.step(1.0, **still)
    assert any("was done with fixed steps" in each for each in model.implausible)
    np.testing.assert_allclose(out.kite_force, hanging.kite_force, rtol=0, atol=0.005 * np.linalg.norm(hanging.kite_force))


def largest_on_a_short_circle(tolerance):
    """Largest node speed [m/s] and tension [N] of a slack tether of 1.7 m with stiff dampers, kite at 20 m/s, in 0.12 s."""
    tether = Tether(segments=22, initial_length=1.68, axial_stiffness=1.2e5, axial_damping=2100.0)
    model = TetherDynamic(tether, Environment(gravity=0.0), Solver(relative_tolerance=tolerance))
    step, radius, speed = 0.004, 0.65, 20.0
    fastest = strongest = 0.0
    for k in range(30):
        angle = speed / radius * step * max(0, k - 1)
        inputs = {
            "kite_position": (radius * np.cos(angle), radius * np.sin(angle), 1.46),
            "kite_velocity": (-speed * np.sin(angle), speed * np.cos(angle), 0.0),
            "reel_out_speed": -1.6,
        }
        out = model.step(step, **inputs) if k else model.initialize(**inputs)
        fastest = max(fastest, np.linalg.norm(model.velocities, axis=1).max())
        strongest = max(strongest, out.max_tension)
    return fastest, strongest


def test_loose_tolerances_do_not_feed_on_the_speed_of_stiff_dampers():
    """`step_control.damper_error`: without it the loosest tolerance gives 40 MN and 80 km/s instead of 11 kN and 74 m/s."""
    np.testing.assert_allclose(largest_on_a_short_circle(1e-2), largest_on_a_short_circle(1e-6), rtol=0.02)


def test_more_fixed_steps_than_the_budget_are_refused():
    model = TetherDynamic(HARD, solver=Solver(fixed_step=1e-4, initial_shape=3))
    model.initialize(**IN_WIND)
    before = model.get_state()
    said = rf"more than {limits.ITERATION_BUDGET // 300} iterations .*fixed_step 0\.0001 s.* longer fixed_step or a shorter"
    with pytest.raises(StepRefused, match=said):
        model.step(1.0, **IN_WIND)
    np.testing.assert_array_equal(model.get_state(), before)


def test_fixed_steps_are_hurried_when_their_iterations_have_spent_the_budget():
    """Not refused: each step that is left takes at most 32 iterations, and that is told."""
    model = TetherDynamic(HARD, solver=Solver(fixed_step=1e-3, initial_shape=3))
    model.initialize(**IN_WIND)
    budget = limits.STAGES * (limits.ITERATION_BUDGET // HARD.segments)
    before = model.counters["iterations"]
    model.step(1.0, **IN_WIND)
    spent = model.counters["iterations"] - before
    assert model.counters["steps"] == 1000
    assert budget < spent <= budget + limits.WORST_WORK + limits.LAST_ITERATIONS * 1000
    assert any("was ended at its bound on factorizations" in each for each in model.implausible)


def test_too_many_fixed_steps_are_refused_before_the_first(monkeypatch):
    monkeypatch.setattr(backward_euler, "count_of_steps", backward_euler.count_of_steps.py_func)
    monkeypatch.setattr(fixed_steps, "step", lambda *arguments: pytest.fail("a step was done"))
    monkeypatch.setattr(fixed_steps, "work_of", lambda system: 300)
    steps = backward_euler.FixedSteps(1e-4, float(at.SECOND_ORDER))
    assert fixed_steps.integrate.py_func(None, steps, 1.0) == status.FIXED_STEPS_TOO_MANY


@pytest.mark.parametrize(
    ("method", "control", "bound"),
    [
        ("backward_euler", "speed", limits.WORST_SUBDIVIDED),
        ("second_order", "speed", limits.WORST_WORK),
        ("backward_euler", "force", limits.WORST_SUBDIVIDED_WITH_DRUM),
        ("second_order", "force", limits.WORST_WORK_WITH_DRUM),
    ],
)
def test_a_fixed_step_takes_a_bounded_number_of_iterations(method, control, bound):
    """The bound holds also where the iteration does not come to rest, and that is told: a slack line in a hurricane.

    Steps of order 2 that are left in the first stage spend a third of what three stages may.
    """
    tether = {"segments": 100, "initial_length": 20.0, "axial_stiffness": 1e7, "axial_damping": 0.0}
    solver = {"fixed_step": 0.1, "fixed_step_method": method, "initial_shape": "straight"}
    drum = {"winch_mass": 1e4} if control == "force" else {}
    model = TetherDynamic(**tether, **solver, winch_control=control, **drum)
    inputs = {"kite_position": (6.0, 0.0, 8.0), "wind_velocity": (60.0, 10.0, 0.0)}
    model.initialize(**inputs)
    most = 0
    for _ in range(50):
        before = model.counters["iterations"]
        model.step(0.1, **inputs)
        most = max(most, model.counters["iterations"] - before)
    assert bound - (limits.STAGES - 1) * limits.MOST_ITERATIONS <= most <= bound == model.most_factorizations
    assert any("a fixed step of 0.1 s was ended at its bound" in each for each in model.implausible)


def test_the_bound_of_a_communication_step_is_an_output():
    """And what a step has taken: never more, whatever the steps, so that a rig can plan with it. 0 with adaptive steps."""
    solver = {"fixed_step": 1e-3, "fixed_step_method": "second_order", "initial_shape": "straight"}
    model = TetherDynamic(segments=300, initial_length=600.0, axial_stiffness=1e7, axial_damping=0.0, **solver)
    assert model.initialize(**IN_WIND).solver_iteration_limit == model.most_factorizations == limits.WORST_WORK
    assert model.step(0.004, **IN_WIND).solver_iteration_limit == 4 * limits.WORST_WORK
    spent = limits.STAGES * (limits.ITERATION_BUDGET // 300)
    most = spent + limits.WORST_WORK + 50 * limits.LAST_ITERATIONS
    assert model.step(0.05, **IN_WIND).solver_iteration_limit == min(50 * limits.WORST_WORK, most) == most
    adaptive = TetherDynamic()
    assert adaptive.initialize().solver_iteration_limit == adaptive.step(0.02).solver_iteration_limit == 0
    assert adaptive.most_factorizations == 0


def test_the_most_iterations_are_what_the_refusal_says():
    assert f"2 to {limits.WORST_WORK} for each" in status.SENTENCES[status.FIXED_STEPS_TOO_MANY]
