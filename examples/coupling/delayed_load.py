"""Up to which communication step may the load on a free kite end be delayed? Linear theory. Helper of the examples.

A mass M with a load -d v, a load that changes by d per speed, and no tether. `TetherDynamicFree` applies the load L[n] that
it gets at t[n] over the step h: linearly extrapolated from its last two values, 3/2 L[n] - 1/2 L[n-1] on average, or held.
The kite that computes it

    after the tether  steps when the tether has, and gives the load of the end of the step: L[n] = -d v[n]
    extrapolating     steps at the same time, continues the motion linearly:              L[n] = -d (2 v[n-1] - v[n-2])
    holding           steps at the same time, holds the motion:                           L[n] = -d v[n-1]

So v[n+1] = v[n] - (h d/M) sum c[k] v[n-k], whose deviations grow where |z| > 1 for a root of z = 1 - (h d/M) sum c[k] z^-k.
"""

import numpy as np

KITES = {"after the tether": (1.0,), "extrapolating": (0.0, 2.0, -1.0), "holding": (0.0, 1.0)}
CONTINUATIONS = {"linear": (1.5, -0.5), "held": (1.0,)}  # of the load, by the tether
GROWS = 1e-9  # |root| - 1 of a deviation that is not rounding
RATIOS = np.linspace(0.001, 3.0, 3000)  # of h d/M, among which the first that grows is looked for


def growth(continuation, kite, ratio):
    """By how much a deviation grows in a step of h = ratio M/d [-]."""
    delays = np.convolve(CONTINUATIONS[continuation], KITES[kite])
    polynomial = np.zeros(len(delays) + 1)
    polynomial[:2] = 1.0, -1.0
    polynomial[1:] += ratio * delays
    return np.abs(np.roots(polynomial)).max()


def largest_step(continuation, kite):
    """Largest communication step over M/d [-] up to which nothing grows."""
    return next(ratio for ratio in RATIOS if growth(continuation, kite, ratio) > 1.0 + GROWS)
