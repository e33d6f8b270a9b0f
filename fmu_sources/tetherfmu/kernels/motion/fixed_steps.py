"""Stub."""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.limits import LAST_ITERATIONS, STAGES, most_of_a_step
from tetherfmu.runtime.status import STATE_NOT_FINITE

from ..compilation import kernel
from ..line import backward_euler


@kernel
def integrate(system, steps, duration):
    """Stub."""
    return STATE_NOT_FINITE


# --- the bound

worst = kernel(most_of_a_step)


@kernel
def most_iterations(n, steps, has_drum, duration):
    """The most iterations, each with one factorization, in a communication step of `duration` [s]: a bound in code.

        min(w m,  3 b + w + l m),   b = ITERATION_BUDGET/n

    of m `backward_euler.FixedSteps` of n segments; w : those of a hard step, l : of one after more than 3 b. 0 : adaptive.
    """
    if steps.size == 0.0:
        return 0.0
    budget = at.ITERATION_BUDGET // n
    count, hard = backward_euler.count_of_steps(steps, duration, budget), worst(steps.method == at.BACKWARD_EULER, has_drum)
    last = 2 * LAST_ITERATIONS if has_drum else LAST_ITERATIONS
    most = min(hard * count, STAGES * budget + hard + last * count)
    return float(min(most, at.LARGEST_INTEGER))
