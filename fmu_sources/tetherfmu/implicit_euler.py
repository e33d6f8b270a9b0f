"""Linearly implicit Euler with a fixed step: bounded at any step, for real time.

    (M/h - B - h K) q = F + M v0/h - B v0 + (motion of driven ends) + h dF/dt,   v1 = q,   x1 = x0 + h q

The known displacement and velocity change of a driven end enter exactly, not as its velocity times h: at 40 m/s and 20 ms
the difference is several newtons in a stiff tether. Source: Hairer and Wanner, Solving Ordinary Differential Equations II,
section IV.9.
"""

from math import ceil

from . import chain, segment
from . import layout as at
from .block_tridiagonal import factorize, solve
from .compilation import kernel
from .end_motion import position_at, velocity_at
from .status import FIXED_STEPS_TOO_MANY, OK, STATE_NOT_FINITE
from .vectors import add, get, put, sub
from .workspace import place_ends


@kernel
def step(n, drive, time, h, x, v, parameters, w):
    """One step of h [s] of (x, v) (modified) at a time [s] of the communication step; False if the matrix is singular."""
    length = drive.length + drive.reeling * time
    chain.node_masses(n, length, parameters, w.mass)
    chain.linearize(n, x, v, length, drive.reeling, drive.wind, parameters, w.records, w.force_rate)
    for s in range(n):
        w.branches[s] = segment.BY_LENGTH
    chain.node_forces(n, w.branches, x, v, length, drive.reeling, drive.wind, w.mass, parameters, w.b)
    put(w.b, n, add(get(w.b, n), drive.load))
    chain.assemble(n, 1.0 / h, 1.0, h, w.mass, w.records, w.diagonal, w.lower, w.upper)
    if not factorize(drive.first, drive.last, w.diagonal, w.lower, w.upper):
        return False
    later = time + h
    if drive.first == 1:
        dx = sub(position_at(drive.ground, later), get(x, 0))
        chain.add_end_motion(n, False, dx, sub(velocity_at(drive.ground, later), get(v, 0)), w.records, w.b)
        put(w.r, 0, (0.0, 0.0, 0.0))
    if drive.last == n - 1:
        dx = sub(position_at(drive.kite, later), get(x, n))
        chain.add_end_motion(n, True, dx, sub(velocity_at(drive.kite, later), get(v, n)), w.records, w.b)
        put(w.r, n, (0.0, 0.0, 0.0))
    for k in range(3 * drive.first, 3 * drive.last + 3):
        w.r[k] = v[k]
        w.b[k] += h * w.force_rate[k] + w.mass[k // 3] / h * v[k]
    chain.add_damping_product(n, -1.0, w.r, w.records, w.b)
    solve(drive.first, drive.last, w.diagonal, w.lower, w.upper, w.b)
    for k in range(3 * drive.first, 3 * drive.last + 3):
        v[k] = w.b[k]
        x[k] += h * w.b[k]
    place_ends(n, drive, later, x, v)
    return True


@kernel
def integrate(n, drive, duration, state, x, v, parameters, w):
    """Advance (x, v) (modified) over a communication step of `duration` [s] with steps of `fixed_step`.

    A communication step that is no multiple is divided evenly into steps of at most `fixed_step`. The counter in `state` is
    modified. Returns a status: OK, FIXED_STEPS_TOO_MANY or STATE_NOT_FINITE.
    """
    wanted = duration / parameters[at.FIXED_STEP] - 1e-6
    if not wanted <= at.WORK_BUDGET // n:
        return FIXED_STEPS_TOO_MANY
    count = max(1, ceil(wanted))
    h = duration / count
    for i in range(count):
        if not step(n, drive, i * h, h, x, v, parameters, w):
            return STATE_NOT_FINITE
    state[at.STEPS] += count
    return OK
