"""How do a tether with a free kite end and its kite agree on the load at the end of a step? For `winch_inside.py`."""

import numpy as np

from power_system.pumping_cycle import gauss_seidel

AGREED, MOST = 1.0, 50  # largest residual [N], number of iterations
SHARE = 0.6  # of the residual in the next guess: lift and drag of a kite that is pushed come back with -0.8 of it in 0.1 s


def together(pair, signals, load, guess, time, step):
    """Tether and kite step until the load at the end is the guess [N]; the next guess, and the number of iterations.

    The tether gets the mean of the loads at the start and at the end; load : its places in `signals`, which are modified.
    """
    begin, before = np.array(signals[load]), [part.fmu.getFMUState() for part in pair]
    for count in range(1, MOST + 1):
        signals[load] = 0.5 * (begin + guess)
        gauss_seidel(pair, signals, time, step)
        end = np.array(signals[load])
        agreed = np.linalg.norm(end - guess) < AGREED
        for part, state in zip(pair, before, strict=True):
            part.fmu.freeFMUState(state) if agreed else part.fmu.setFMUState(state)
        if agreed:
            return 2.0 * end - begin, count
        guess = guess + SHARE * (end - guess)
    raise RuntimeError(f"tether and kite do not agree after {MOST} iterations at {time:.1f} s: take a shorter step")
