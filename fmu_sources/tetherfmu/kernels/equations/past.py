"""Past positions of inputs without velocities, and their extrapolation: ends with derived velocities, a winch by length.

A rate must not be extrapolated much further than the period over which it was measured. The state therefore stores past
positions at increasing intervals. Over periods T, T', T'' between them

    u = (p - p')/T,   u' = (p' - p'')/T',   u'' = (p'' - p''')/T''
    a = (u - u')/((T + T')/2),   v = u + a T/2,   a' = (u' - u'')/((T' + T'')/2)

With constant steps these are the last three. Otherwise v and a use the latest periods that are each at least a quarter
of the extrapolation time H, and the limits of the displacement v H + a H^2/2 use periods of at least three quarters of H,
so no displacement is much longer than earlier ones of the input. If the past does not reach back far enough, the position
is not extrapolated.

Before the start everything is at rest, except that a winch runs at its speed for two steps.

Theory: docs/models/theory.md, "Driven ends".
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.limits import SHORTEST_LAST_STEP

from ..compilation import kernel
from ..linear_algebra.vectors import put_at, vector_at
from .end_motion import limited_motion

GROUND, KITE, LENGTH = 3, 0, 6  # places of the ends and of the length among the numbers of a past value
SHORTEST_PERIOD = 0.75  # of a rate that limits a displacement, over the displacement's time [-]
ALWAYS_KEPT = 3  # number of past values that constant steps need
FOREVER = 1e300  # [s]: time at rest before the start
COARSENESS = 0.6  # a past value goes if its neighbours' interval over the time since the earlier one is below this [-]


@kernel
def past(state, i, k):
    """Number k of past value i [m]; i = 0 is the latest."""
    return state[at.PAST_VALUES + at.PAST_SIZE * i + k]


@kernel
def begin_past(length, state):
    """Initialize the past of a new state (modified) at rest at its ends and its length [m]; the inputs are in the state."""
    for i in range(at.MOST_PAST):
        state[at.PAST_TIMES + i] = FOREVER
        put_past(length, i, state)


@kernel
def put_past(length, i, state):
    """Set past value i of a state (modified) to its last positions and a length [m]."""
    place = at.PAST_VALUES + at.PAST_SIZE * i
    put_at(state, place + KITE, vector_at(state, at.LAST_KITE_POSITION))
    put_at(state, place + GROUND, vector_at(state, at.LAST_GROUND_POSITION))
    state[place + LENGTH] = length


@kernel
def begin_moving(length, speed, step, state):
    """Initialize the past of the length [m] with this speed [m/s] during two steps [s], in a state (modified)."""
    for i in range(at.MOST_PAST):
        state[at.PAST_VALUES + at.PAST_SIZE * i + LENGTH] = length - (1.0 if i == 0 else 2.0) * step * speed
    state[at.PAST_TIMES] = state[at.PAST_TIMES + 1] = step


@kernel
def superfluous(step, state):
    """Number of the past value to drop for one that is `step` [s] old: too close to its neighbours, or the earliest."""
    times, i = at.PAST_TIMES, ALWAYS_KEPT - 1
    if state[times + at.MOST_PAST - 2] >= FOREVER:
        return at.MOST_PAST - 1
    since = step
    for j in range(ALWAYS_KEPT + 1):
        since += state[times + j]
    while i < at.MOST_PAST - 1 and state[times + i] + state[times + i + 1] > COARSENESS * since:
        i += 1
        since += state[times + min(i + 1, at.MOST_PAST - 1)]
    return i


@kernel
def keep_past(length, step, state):
    """Add the last positions of a state and a length [m] to its past values (modified), after a step [s]."""
    i = superfluous(step, state)
    if i < at.MOST_PAST - 1:
        state[at.PAST_TIMES + i + 1] += state[at.PAST_TIMES + i]
    while i > 0:
        state[at.PAST_TIMES + i] = state[at.PAST_TIMES + i - 1]
        for k in range(at.PAST_SIZE):
            state[at.PAST_VALUES + at.PAST_SIZE * i + k] = past(state, i - 1, k)
        i -= 1
    state[at.PAST_TIMES] = step
    put_past(length, 0, state)


@kernel
def period(i, least, state):
    """The past value at least a time [s] before value i - 1, as the number of its successor; and this time [s]."""
    time = 0.0
    while i < at.MOST_PAST and time < least:
        time += state[at.PAST_TIMES + i]
        i += 1
    return i, time


@kernel
def rates_over(least, position, k, state):
    """Last two rates of a position [m], their rates, and their periods of at least `least` [s].

    (u, u'), (a, a'), (T, T') : 0 [m/s], [m/s2] if the past does not reach back far enough.  k : place of the position.
    """
    i, latest = period(0, least, state)
    j, middle = period(i, least, state)
    m, earliest = period(j, least, state)
    if earliest < least:
        return (0.0, 0.0), (0.0, 0.0), (least, least)
    first, second, third = past(state, i - 1, k), past(state, j - 1, k), past(state, m - 1, k)
    u, u_last, u_before = (position - first) / latest, (first - second) / middle, (second - third) / earliest
    a, a_last = 2.0 * (u - u_last) / (latest + middle), 2.0 * (u_last - u_before) / (middle + earliest)
    return (u, u_last), (a, a_last), (latest, middle)


@kernel
def extrapolated(position, k, time, state):
    """Velocity [m/s] and acceleration [m/s2] that extrapolate a position [m] over a time [s]; k : its place."""
    rates, accelerations, periods = rates_over(SHORTEST_LAST_STEP * time, position, k, state)
    velocity = rates[0] + 0.5 * periods[0] * accelerations[0]
    return limited_motion(velocity, accelerations[0], *rates_over(SHORTEST_PERIOD * time, position, k, state), time)
