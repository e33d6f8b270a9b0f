"""What one communication step may cost at most, whatever the inputs are: from the limits that are in code."""

from tetherfmu.runtime import limits


def most_work(segments):
    """Segments times internal steps and iterations of a step whose winch is told a speed or a length, adaptive.

    All budgets of the adaptive solver; then the fixed steps of a step that was given up, with their iterations until they
    are truncated, and those of the truncated ones.
    """
    adaptive = limits.MOST_BUDGETS * limits.WORK_BUDGET
    until_truncated = limits.STAGES * limits.ITERATION_BUDGET + limits.WORST_WORK * segments
    return adaptive + until_truncated + (2 + limits.LAST_ITERATIONS) * limits.COARSE_WORK
