"""Notes in the state of a line, once since the start, for one warning each: from `step/plausibility.py` and the solvers."""

from math import sqrt

from tetherfmu.runtime import layout as at

from .compilation import kernel


@kernel
def note(state, kind, square, limit):
    """Store the first value beyond a limit in the state (modified); `square` is the squared value."""
    if square > limit * limit and state[at.WARNED_VALUES + kind] == 0.0:
        state[at.WARNED_VALUES + kind] = sqrt(square)
        state[at.WARNINGS] += 1 << kind


@kernel
def note_peak(state, tension):
    """Store the largest tension of the internal steps [N] in the state (modified)."""
    state[at.PEAK_SO_FAR] = max(state[at.PEAK_SO_FAR], tension)
