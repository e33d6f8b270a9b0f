"""Wind that is an input at K points: at equal unstretched lengths from the ground end to the kite, linear in between.

    W(s) = W_k + f (W_(k+1) - W_k),   s (K - 1) = k + f,   k = 0 .. K - 2

s [-] is the unstretched length from the ground end over that of the tether. As all segments reel in proportion to their
lengths, a node keeps its s, whatever the winch does.

The state has the winds at the end of the last step, so that outputs and restored states follow from it; behind them wait
derivatives that the importer gives for the next step. `put_node_winds` makes the winds at the nodes of it in the parameters.

Theory: docs/models/theory.md, "Wind at points".
"""

from tetherfmu.runtime import layout as at

from ..arrays import copy, nodes_end
from ..compilation import kernel
from ..flat_arrays import part
from ..linear_algebra.pairs import number_at
from ..linear_algebra.vectors import add_scaled, sub, vector_at
from .properties import property_in, put_node_wind
from .torn import has_let_go

KITE_END = 1.0  # its s


@kernel
def count_of(parameters):
    """Number of wind points K, 0 for none."""
    return int(parameters[at.WIND_POINTS])


@kernel
def winds_of(n, state):
    """Place of the winds in a state: behind its nodes, and behind the room for one that a line gets when it lets go."""
    return nodes_end(n) + 6 * (1 - has_let_go(state))


@kernel
def between(state, first, part):
    """Vector at a part [-] of the way from the vector at place `first` of a state to the next one."""
    start = vector_at(state, first)
    return add_scaled(start, part, sub(vector_at(state, first + 3), start))


@kernel
def wind_between(n, parameters, state, s, back):
    """Wind [m/s] at a part s [-] of the unstretched length, a time `back` [s] before that of the winds in the state."""
    points = count_of(parameters)
    place = s * (points - 1)
    k = min(int(place), points - 2)
    first = winds_of(n, state) + 3 * k
    wind = between(state, first, place - k)
    return wind if back == 0.0 else add_scaled(wind, -back, between(state, first + 3 * points, place - k))


@kernel
def winds_at(n, state, points):
    """Wind [m/s] at two points of a state, by their numbers, as pairs."""
    first = winds_of(n, state)
    places = 3 * points[0], 3 * points[1]
    return number_at(state, first, places), number_at(state, first + 1, places), number_at(state, first + 2, places)


@kernel
def put_node_winds(n, parameters, state, back):
    """Winds at the nodes (in the parameters, modified), a time `back` [s] before that of the winds in the state."""
    s = 0.0
    for i in range(n + 1):
        put_node_wind(n, i, wind_between(n, parameters, state, s, back), parameters)
        s = min(s + property_in(parameters, n, i, at.SHARE), KITE_END) if i < n else s


@kernel
def take_from_state(n, parameters, state):
    """Winds at the nodes (in the parameters, modified) that belong to a state, if it has wind points."""
    if count_of(parameters) > 0:
        put_node_winds(n, parameters, state, 0.0)


@kernel
def start(n, parameters, inputs, state):
    """Take the winds of the inputs into a new state (modified), and to the nodes in the parameters (modified)."""
    for k in range(3 * count_of(parameters)):
        state[winds_of(n, state) + k] = inputs[at.INPUTS + k]
    take_from_state(n, parameters, state)


@kernel
def advance(n, parameters, inputs, step, is_mean, state):
    """Take the winds of the inputs for a step [s] into a state (modified), and to the nodes in the parameters (modified).

    The state gets those of the end of the step, W + h dW/dt with the given derivatives, which are consumed; the nodes the
    mean over the step if `is_mean`, as waves need it, else the same.
    """
    count = 3 * count_of(parameters)
    if count == 0:
        return
    given = part(inputs, at.INPUTS, count)
    first = winds_of(n, state)
    winds, rates = part(state, first, count), part(state, first + count, count)
    changes = False
    for k in range(count):  # no way out of the loop, which would keep it from being done in pairs
        changes |= rates[k] != 0.0
    copy(given, winds)
    if changes:
        for k in range(count):
            winds[k] += step * rates[k]
    put_node_winds(n, parameters, state, 0.5 * step if is_mean and changes else 0.0)
    if changes:
        for k in range(count):
            rates[k] = 0.0
