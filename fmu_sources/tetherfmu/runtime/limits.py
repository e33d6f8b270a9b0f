"""Limits that shells and kernels share: of inputs, steps, and the work in one of them. The kernels freeze these numbers."""

LARGEST_INTEGER = 2**31 - 1  # of FMI 2.0
LARGEST_INPUT = 1e9  # in magnitude, any input
LONGEST_STEP = 1e6  # [s]
MAX_SEGMENTS = 300
MAX_WIND_POINTS = 1001
WORK_BUDGET = 200_000  # segments times internal steps in one communication step: 10 000 steps of 20 segments
MOST_BUDGETS = 20  # budgets per step: about a second
MOST_EXPECTED = 100  # budgets: a step that has used one and is predicted to need more than this is abandoned
COARSE_WORK = 40_000  # segments times fixed steps of a repeated communication step
ITERATION_BUDGET = 1_000_000  # segments times fixed steps in it; a third of the iterations after which they are truncated
STIFF = 1e8  # axial stiffness [N] above which the errors of positions that solvers allow show in the tension
LEAST_REMAINDER = 1e-6  # part of an internal step: a shorter rest of a communication step needs no further step
MIN_SEGMENT_LENGTH = 0.01  # [m], below which reeling in is refused
SHORTEST_PART = 0.5  # of it that fixed steps may leave where ropes stop at their ends
DEEPEST_START = 0.1  # [m] below a flat ground, beside ground_sink: where a free end may start, and a driven one may be
NO_STOP = 1e300  # unstretched length [m] at a stop of the winch that is not there

# part of the present communication step that the last one counts as at least where the rate of an input is estimated: after
# a much shorter step a jump is extrapolated to no more than four times itself
SHORTEST_LAST_STEP = 0.25

# iterations of backward Euler, see `kernels/line/backward_euler.py` and `second_order.py`
MOST_ITERATIONS = 8  # of a step and of its coarser parts
LAST_ITERATIONS = 32  # of the finest parts
PARTS = 4  # parts of a subdivided step, and of each of its parts
FINEST = PARTS**2  # parts of the finest kind in a step
WORST_SUBDIVIDED = MOST_ITERATIONS * (1 + PARTS) + LAST_ITERATIONS * FINEST  # iterations of a step and of all its parts
STAGES = 3  # of a step of order 2
WORST_WORK = STAGES * MOST_ITERATIONS + WORST_SUBDIVIDED  # factorizations for one fixed step, including rejected stages
# the same of a chain with the drum of a winch that is controlled by force: where the finest parts do not converge with it,
# the chain steps alone, see `fixed_steps.take_in_any_case`
WORST_SUBDIVIDED_WITH_DRUM = WORST_SUBDIVIDED + LAST_ITERATIONS * FINEST
WORST_WORK_WITH_DRUM = STAGES * MOST_ITERATIONS + WORST_SUBDIVIDED_WITH_DRUM


def most_of_a_step(has_one_stage, has_drum):
    """Factorizations at most [-] for one fixed step: of backward Euler alone or not, with a drum or not."""
    if has_one_stage:
        return WORST_SUBDIVIDED_WITH_DRUM if has_drum else WORST_SUBDIVIDED
    return WORST_WORK_WITH_DRUM if has_drum else WORST_WORK
