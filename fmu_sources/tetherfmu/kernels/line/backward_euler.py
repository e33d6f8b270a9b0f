"""Backward Euler with a fixed step: bounded at any step and in bounded work, for real time.

The positions x after a step of h make the potential Phi of `incremental_potential.py` as small as a bounded number of Newton
iterations can. The matrix of an iteration is positive definite, so that it descends; one that would not is shortened, or
left out. So Phi never exceeds its value at the start of the iteration, whatever the step.
A step whose iteration has not converged after `MOST_ITERATIONS` is taken again in `PARTS` equal parts, those that have
not in `PARTS` again; of these each is taken as it is after `LAST_ITERATIONS` (all three in `runtime/limits.py`).

Sources: Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.3; Martin, Thomaszewski, Grinspun and
Gross, Example-based elastic materials, ACM Trans. Graph. 30 (2011), section 4 (incremental potential).
"""

from collections import namedtuple
from math import ceil, sqrt

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.limits import FINEST, LEAST_REMAINDER, PARTS, STIFF

from ..arrays import behind, clear, copy, node_arrays, shared_arrays
from ..compilation import kernel, view
from ..equations import node_loads, segment
from ..equations.assembly import node_masses
from ..equations.boundary import place_ends
from ..equations.properties import property_of, rest_length, stiffest
from ..flat_arrays import part
from ..linear_algebra.block_tridiagonal import Matrix
from ..linear_algebra.matrices import ZERO_MATRIX, put_matrix
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, get, norm, put, sub

MOST_HALVINGS = 8  # of a move that does not go down
CLOSE = 1e-6  # largest move of a node over the length of a segment in the last iteration; the error after it is its square,
# which in the tension is EA times it: above `STIFF`, CLOSE falls with the root of EA
CLOSE_IN_STAGE = 1e-5  # the same in a stage of `second_order.py`
WHOLE, STAGE, EXPECTED = 0, 1, 2  # steps, stages of `second_order.py`, those of which the accelerations can be expected


FixedSteps = namedtuple("FixedSteps", "size method")
FixedSteps.__doc__ = "Fixed steps: their size [s], 0 for adaptive ones, and `fixed_step_method`, as an enumeration."
VECTORS = "x trial old free drag slope move acceleration flow along"
Workspace = namedtuple("Workspace", f"{VECTORS} matrix mass modes held pressed")
Workspace.__doc__ = """Scratch arrays of a step; 3 (n + 1) numbers where nothing else is said.

x : positions of the iteration [m].  trial : positions to try [m].  old : positions before the step [m].
free : y, where the nodes would fly freely [m].  drag : half drags F of the segments [N].  slope : their slopes A [N s/m],
9 (n + 1).  move : minus the gradient of Phi [N], then the move of the nodes [m].  matrix, mass : see
`arrays.shared_arrays`; masses at the end of the step.  modes : n, which damping each segment has, see `segment.TAUT`.
held : n, l - l0 where the matrix was made [m]: its sign is the mode of the spring there.  acceleration : of the nodes in a
stage [m/s2], before it what is expected.  flow : forces of the rope that flows in the iteration [N].  along : directions of
the segments in the iteration, with which dampers pull in a stage.
pressed : n + 1, a_n of the friction on the ground [m/s2].
"""


@kernel
def workspace_size(n):
    """Length of the room that `workspace` needs, beside `arrays.shared_arrays`."""
    return 9 * 3 * (n + 1) + 10 * (n + 1) + 2 * n


@view
def workspace(n, shared, room):
    """Cut a room into the arrays of `Workspace`; shared : an array that begins with `arrays.shared_arrays`."""
    blocks, _, mass, _ = shared_arrays(n, shared)
    x, trial, old, free, drag, move, room = node_arrays(n, room)
    flow, along, room = part(room, 0, 3 * (n + 1)), part(room, 3 * (n + 1), 3 * (n + 1)), behind(6 * (n + 1), room)
    acceleration, slope, room = part(room, 0, 3 * (n + 1)), part(room, 3 * (n + 1), 9 * (n + 1)), behind(12 * (n + 1), room)
    modes, held, pressed = part(room, 0, n), part(room, n, n), part(room, 2 * n, n + 1)
    vectors = x, trial, old, free, drag, slope, move, acceleration, flow, along
    return Workspace(*vectors, Matrix(*blocks), mass, modes, held, pressed)


@kernel
def flight(x, v, h, acceleration):
    """x + h v + h^2 a [m]: where backward Euler takes a node at x [m] with v [m/s] and an acceleration [m/s2] in h [s]."""
    return add_scaled(add_scaled(x, h, v), h * h, acceleration)


@kernel
def take_directions(n, x, w):
    """Directions of all segments at x [m] into w.along (modified), for the dampers in a stage."""
    for s in range(n):
        _, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
        put(w.along, s, e)


@kernel
def start(attempt, before, time, kind, x, w):
    """Fill masses, old positions, free flight and modes of the dampers into w for a step from x [m] at a time [s].

    No load in the free flight, and no drag yet, or that of before with EXPECTED.  before : `Chain` at its start.
    kind : WHOLE, where driven ends go to where their curves are; STAGE or EXPECTED, where they go from x with their velocity
    after the step, see `second_order.py`.
    """
    conditions, chain, h, v, _ = attempt
    n = chain.n
    node_masses(chain, w.mass)
    falling = node_loads.free_acceleration(chain)
    place_ends(conditions, time + h, w.old, w.free)  # w.free holds the velocities of the ends for the moment
    for i in range(n + 1):
        if conditions.first <= i <= conditions.last:
            put(w.old, i, get(x, i))
            put(w.free, i, flight(get(x, i), get(v, i), h, falling))
        else:
            end = add_scaled(get(x, i), h, get(w.free, i)) if kind != WHOLE else get(w.old, i)
            put(w.old, i, add_scaled(end, -h, get(w.free, i)))
            put(w.free, i, end)
    clear(w.pressed)
    if kind == STAGE:
        take_directions(n, x, w)
    if kind != EXPECTED:
        clear(w.flow)
    for s in range(n):
        taut = norm(sub(get(x, s + 1), get(x, s))) > rest_length(before, s)
        w.modes[s] = segment.TAUT if taut else segment.SLACK
        if kind != EXPECTED:
            put(w.drag, s, ZERO_VECTOR)
            put_matrix(w.slope, 9 * s, ZERO_MATRIX)


@kernel
def add_drag(attempt, x, w):
    """Half drags F [N] and slopes A [N s/m] of all segments into w, at the positions x [m] and the old velocities."""
    chain, v = attempt.chain, attempt.v
    for s in range(chain.n):
        length, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
        ends = get(x, s), get(x, s + 1), get(v, s), get(v, s + 1)
        drag, _, by_velocity, _ = segment.linearize_drag_between(chain, s, length, e, *ends)
        put(w.drag, s, drag)
        put_matrix(w.slope, 9 * s, by_velocity)


@kernel
def carry_by(attempt, ground, kite, x, w):
    """`carry` with these moves of the ends [m]."""
    n, share = attempt.chain.n, 0.0
    for i in range(n):
        put(w.trial, i, add_scaled(add_scaled(get(x, i), 1.0 - share, ground), share, kite))
        share += property_of(attempt.chain, i, at.SHARE)
    put(w.trial, n, add(get(x, n), kite))


@kernel
def fly_as_expected(attempt, x, w):
    """Positions [m] into w.x (modified) to which nodes at x [m] come with the accelerations that are expected."""
    conditions, _, h, v, _ = attempt
    copy(w.free, w.x)
    for i in range(conditions.first, conditions.last + 1):
        put(w.x, i, flight(get(x, i), get(v, i), h, get(w.acceleration, i)))


@kernel
def goal_of(attempt, kind):
    """Largest move of a node [m] with which the iteration has converged."""
    conditions, close = attempt.conditions, CLOSE if kind == WHOLE else CLOSE_IN_STAGE
    return close * sqrt(min(1.0, STIFF / stiffest(attempt.chain))) * conditions.reeling[0] / conditions.n


@kernel
def take(attempt, time, kind, x, v, w):
    """Let (x, v) [m, m/s] (modified), at a time [s], have the result of the iteration."""
    conditions, h = attempt.conditions, attempt.h
    for k in range(3 * conditions.first, 3 * conditions.last + 3):
        velocity = (w.x[k] - x[k]) / h
        w.acceleration[k] = (velocity - v[k]) / h
        v[k] = velocity
        x[k] = w.x[k]
    place_ends(conditions, time + h, x, v)
    if kind != WHOLE:
        copy(w.x, x)


@kernel
def next_part(done, size, taken):
    """How much of a step is done, and the size of its next part, both in parts of the finest kind, after one was tried.

    done, size : the same before it.  taken : whether it converged; if not, it is to be divided.
    """
    if not taken:
        return done, size // PARTS
    done += size
    while size < FINEST and done % (size * PARTS) == 0:
        size *= PARTS
    return done, size


@kernel
def given_steps(parameters):
    """`FixedSteps` that the parameters ask for."""
    return FixedSteps(parameters[at.FIXED_STEP], parameters[at.FIXED_STEP_METHOD])


@kernel
def count_of_steps(steps, duration, most):
    """Number of `FixedSteps` in a communication step of `duration` [s]; 0 if it is above `most`."""
    wanted = duration / steps.size - LEAST_REMAINDER
    return max(1, ceil(wanted)) if wanted <= most else 0
