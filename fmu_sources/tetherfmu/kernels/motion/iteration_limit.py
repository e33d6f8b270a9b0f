"""The most iterations, each with one factorization of the matrix of the chain, that fixed steps can take: a bound in code.

A communication step of m fixed steps takes at most

    min(w m,  3 b + w + l m),   b = ITERATION_BUDGET/n

iterations, with w those of a hard step and l those of the steps after more than 3 b (`fixed_steps.integrate`).
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.limits import LAST_ITERATIONS, STAGES, most_of_a_step

from ..compilation import kernel
from ..line.backward_euler import count_of_steps

worst = kernel(most_of_a_step)


@kernel
def of_steps(n, steps, has_drum, duration):
    """The most iterations in a communication step of `duration` [s] of n segments with `backward_euler.FixedSteps`.

    0 with adaptive steps.
    """
    if steps.size == 0.0:
        return 0.0
    budget = at.ITERATION_BUDGET // n
    count, hard = count_of_steps(steps, duration, budget), worst(steps.method == at.BACKWARD_EULER, has_drum)
    last = 2 * LAST_ITERATIONS if has_drum else LAST_ITERATIONS
    most = min(hard * count, STAGES * budget + hard + last * count)
    return float(min(most, at.LARGEST_INTEGER))
