"""Wind inputs at K points: at equal unstretched lengths from the ground end to the kite, linear in between.

    W(s) = W_k + f (W_(k+1) - W_k),   s (K - 1) = k + f,   k = 0 .. K - 2

s [-] is the unstretched length from the ground end over the tether length. All segments of a uniform line reel in
proportion, so a node keeps its s when the winch runs; with sections it changes from step to step.

The state stores the winds at the end of the last step, so outputs and restored states follow from it, and then the
derivatives that the importer sets for the next step. `put_node_winds` computes the node winds in the parameters from them.

Theory: docs/models/theory.md, "Wind at points".
"""

from tetherfmu.runtime import layout as at

from ..arrays import copy, nodes_end
from ..compilation import kernel
from ..flat_arrays import part
from ..linear_algebra.pairs import number_at
from ..linear_algebra.vectors import add_scaled, sub, vector_at
from .properties import part_in, put_node_wind
from .torn import has_let_go

KITE_END = 1.0  # s of the kite end


@kernel
def count_of(parameters):
    """Number of wind points K, 0 for none."""
    return int(parameters[at.WIND_POINTS])


@kernel
def winds_of(n, state):
    """Place of the winds in a state: behind its nodes and the room for the node that is added when a line is released."""
    return nodes_end(n) + 6 * (1 - has_let_go(state))


@kernel
def between(state, first, part):
    """Interpolated vector, at a fraction [-] from the vector at place `first` of a state to the next one."""
    start = vector_at(state, first)
    return add_scaled(start, part, sub(vector_at(state, first + 3), start))


@kernel
def wind_between(n, parameters, state, s, back):
    """Wind [m/s] at a fraction s [-] of the unstretched length, a time `back` [s] before the winds in the state."""
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
    """Winds at the nodes (in the parameters, modified), a time `back` [s] before the winds in the state."""
    s = 0.0
    for i in range(n + 1):
        put_node_wind(n, i, wind_between(n, parameters, state, s, back), parameters)
        s = min(s + part_in(parameters, n, i, state[at.LENGTH]), KITE_END) if i < n else s


@kernel
def take_from_state(n, parameters, state):
    """Winds at the nodes (in the parameters, modified) of a state with wind points."""
    if count_of(parameters) > 0:
        put_node_winds(n, parameters, state, 0.0)


@kernel
def start(n, parameters, inputs, state):
    """Copy the wind inputs into a new state (modified), and to the nodes in the parameters (modified)."""
    for k in range(3 * count_of(parameters)):
        state[winds_of(n, state) + k] = inputs[at.INPUTS + k]
    take_from_state(n, parameters, state)


@kernel
def advance(n, parameters, inputs, step, is_mean, state):
    """Copy the wind inputs of a step [s] into a state (modified), and to the nodes in the parameters (modified).

    The state stores the winds at the end of the step, W + h dW/dt with the given derivatives, which are consumed; the
    nodes get the mean over the step if `is_mean`, as waves need it, else the end values.
    """
    count = 3 * count_of(parameters)
    if count == 0:
        return
    given = part(inputs, at.INPUTS, count)
    first = winds_of(n, state)
    winds, rates = part(state, first, count), part(state, first + count, count)
    changes = False
    for k in range(count):  # no early exit, which would prevent vectorization in pairs
        changes |= rates[k] != 0.0
    copy(given, winds)
    if changes:
        for k in range(count):
            winds[k] += step * rates[k]
    put_node_winds(n, parameters, state, 0.5 * step if is_mean and changes else 0.0)
    if changes:
        for k in range(count):
            rates[k] = 0.0
