"""What is noted in the state of a line, once since the start, for one warning: `step/plausibility.py` and the solvers do."""

from math import sqrt

from tetherfmu.runtime import layout as at

from .compilation import kernel


@kernel
def note(state, kind, square, limit):
    """Keep the first value beyond a limit in the state (modified); `square` is that of the value."""
    if square > limit * limit and state[at.WARNED_VALUES + kind] == 0.0:
        state[at.WARNED_VALUES + kind] = sqrt(square)
        state[at.WARNINGS] += 1 << kind


@kernel
def note_peak(state, tension):
    """Keep the largest tension of the internal steps [N] in the state (modified)."""
    state[at.PEAK_SO_FAR] = max(state[at.PEAK_SO_FAR], tension)
