"""The most iterations, each with one factorization of the matrix of the chain, that fixed steps can take: a bound in code.

A communication step of m fixed steps takes at most

    min(w m,  3 b + w + l m),   b = ITERATION_BUDGET/n

iterations, with w those of a hard step and l those of the steps after more than 3 b (`fixed_steps.integrate`).
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.limits import LAST_ITERATIONS, STAGES, most_of_a_step

from ..compilation import kernel
from ..equations import winch
from ..line.backward_euler import count_of_steps, given_steps

worst = kernel(most_of_a_step)


@kernel
def of_one(method, has_drum):
    """Iterations of a hard fixed step, and of one after the budget of iterations is spent.

    method : of `backward_euler.FixedSteps`.  has_drum : whether a winch is controlled by force.
    """
    return worst(method == at.BACKWARD_EULER, has_drum), 2 * LAST_ITERATIONS if has_drum else LAST_ITERATIONS


@kernel
def of_steps(n, steps, has_drum, duration):
    """The most iterations in a communication step of `duration` [s] of n segments with `backward_euler.FixedSteps`.

    0 with adaptive steps.
    """
    if steps.size == 0.0:
        return 0.0
    budget = at.ITERATION_BUDGET // n
    count, (hard, truncated) = count_of_steps(steps, duration, budget), of_one(steps.method, has_drum)
    most = min(hard * count, STAGES * budget + hard + truncated * count)
    return float(min(most, at.LARGEST_INTEGER))


@kernel
def of_step(n, parameters, duration):
    """`of_steps` of a chain."""
    return of_steps(n, given_steps(parameters), winch.follows_force(parameters), duration)
