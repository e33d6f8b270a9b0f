"""The most iterations, each with one factorization of the matrix of the chain, that fixed steps can take: a bound in code.

A communication step of m fixed steps takes at most

    min(w m,  3 b + w + l m),   b = ITERATION_BUDGET/n

iterations, with w those of a hard step and l those of the steps after more than 3 b (`second_order.integrate`).
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.limits import (
    LAST_ITERATIONS,
    STAGES,
    WORST_CAREFUL,
    WORST_CAREFUL_WITH_DRUM,
    WORST_WORK,
    WORST_WORK_WITH_DRUM,
)

from ..compilation import kernel
from ..equations import winch
from .backward_euler import count_in


@kernel
def of_one(parameters):
    """Iterations of a hard fixed step, and of one after the budget of iterations is spent."""
    has_drum = winch.follows_force(parameters)
    if parameters[at.FIXED_STEP_METHOD] == at.BACKWARD_EULER:
        most = WORST_CAREFUL_WITH_DRUM if has_drum else WORST_CAREFUL
    else:
        most = WORST_WORK_WITH_DRUM if has_drum else WORST_WORK
    return most, 2 * LAST_ITERATIONS if has_drum else LAST_ITERATIONS


@kernel
def of_step(n, parameters, duration):
    """The most iterations in a communication step of `duration` [s] of a chain of n segments; 0 with adaptive steps."""
    if parameters[at.FIXED_STEP] == 0.0:
        return 0.0
    budget = at.ITERATION_BUDGET // n
    count, (hard, hurried) = count_in(parameters, duration, budget), of_one(parameters)
    most = min(hard * count, STAGES * budget + hard + hurried * count)
    return float(min(most, at.LARGEST_INTEGER))
