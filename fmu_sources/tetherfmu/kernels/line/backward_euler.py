"""Backward Euler with a fixed step: stable at any step and with bounded work, for real time.

The positions x after a step of h minimize the potential Phi of `incremental_potential.py` as far as a bounded number of
Newton iterations permits. The iteration matrix is positive definite, so each Newton step is a descent direction; a step that
would raise Phi is shortened or omitted. Phi therefore never exceeds its initial value, at any h.
A step that has not converged after `MOST_ITERATIONS` is repeated in `PARTS` equal parts, and unconverged parts in `PARTS`
again; the finest parts are accepted after `LAST_ITERATIONS` (all three in `runtime/limits.py`).

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
from ..equations.properties import part_of, rest_length, stiffest
from ..flat_arrays import part
from ..linear_algebra.block_tridiagonal import Matrix
from ..linear_algebra.matrices import ZERO_MATRIX, put_matrix
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, get, norm, put, sub

MOST_HALVINGS, MOST_IN_WHOLE = 8, 16  # of a displacement that does not reduce Phi, in stages and in whole steps
CLOSE = 1e-6  # largest node displacement in the last iteration, over the segment length; the error after it is its square,
# in the tension EA times the square: above `STIFF`, CLOSE falls with the root of EA
CLOSE_IN_STAGE = 1e-5  # `CLOSE` in a stage of `second_order.py`
WHOLE, STAGE, EXPECTED = 0, 1, 2  # steps, stages of `second_order.py`, stages with expected accelerations


FixedSteps = namedtuple("FixedSteps", "size method")
FixedSteps.__doc__ = "Fixed steps: their size [s], 0 for adaptive ones, and `fixed_step_method`, as an enumeration."
VECTORS = "x trial old free drag slope move acceleration flow along"
Workspace = namedtuple("Workspace", f"{VECTORS} matrix mass modes held pressed")
Workspace.__doc__ = """Scratch arrays of a step; 3 (n + 1) numbers unless stated otherwise.

x : iterate [m].  trial : positions to try [m].  old : positions before the step [m].
free : y, positions after free flight [m].  drag : half drags F of the segments [N].  slope : their slopes A [N s/m],
9 n.  move : minus the gradient of Phi [N], then the node displacements [m].  matrix, mass : see
`arrays.shared_arrays`; masses at the end of the step.  modes : n, damping mode of each segment, see `segment.TAUT`.
held : n, l - l0 for which the matrix was built [m]: its sign is the mode of the spring.  acceleration : of the nodes in a
stage [m/s2], before it the expected value.  flow : forces of flowing rope in the iteration [N].  along : 3 n, segment
directions of the iteration, in which dampers pull in a stage.
pressed : n + 1, a_n of the friction on the ground [m/s2]."""


@kernel
def workspace_size(n):
    """Length of the room for `workspace`, in addition to `arrays.shared_arrays`."""
    return 25 * (n + 1) + 14 * n


@view
def workspace(n, shared, room):
    """Cut a room into the arrays of `Workspace`; shared : an array that begins with `arrays.shared_arrays`."""
    blocks, _, mass, _ = shared_arrays(n, shared)
    x, trial, old, free, drag, move, room = node_arrays(n, room)
    flow, acceleration, room = part(room, 0, 3 * (n + 1)), part(room, 3 * (n + 1), 3 * (n + 1)), behind(6 * (n + 1), room)
    along, slope, room = part(room, 0, 3 * n), part(room, 3 * n, 9 * n), behind(12 * n, room)
    modes, held, pressed = part(room, 0, n), part(room, n, n), part(room, 2 * n, n + 1)
    vectors = x, trial, old, free, drag, slope, move, acceleration, flow, along
    return Workspace(*vectors, Matrix(*blocks), mass, modes, held, pressed)


@kernel
def flight(x, v, h, acceleration):
    """x + h v + h^2 a [m]: backward Euler result after h [s] from x [m] and v [m/s] with an acceleration [m/s2]."""
    return add_scaled(add_scaled(x, h, v), h * h, acceleration)


@kernel
def take_directions(n, x, w):
    """Directions of all segments at x [m] into w.along (modified), for the dampers in a stage."""
    for s in range(n):
        _, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
        put(w.along, s, e)


@kernel
def start(attempt, before, time, kind, x, w):
    """Fill masses, old positions, free flight and damper modes into w for a step from x [m] at a time [s].

    The free flight has no load; drag is 0, or taken from before with EXPECTED.  before : `Chain` at its start.
    kind : WHOLE: driven ends move to their curves; STAGE or EXPECTED: they move from x with their velocity after the step,
    see `second_order.py`.
    """
    conditions, chain, h, v, _ = attempt
    n = chain.n
    node_masses(chain, w.mass)
    falling = node_loads.free_acceleration(chain)
    place_ends(conditions, time + h, w.old, w.free)  # w.free is scratch space for the end velocities here
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
    """Half drags F [N] and slopes A [N s/m] of all segments into w, at positions x [m] and the old velocities."""
    chain, v = attempt.chain, attempt.v
    for s in range(chain.n):
        length, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
        ends = get(x, s), get(x, s + 1), get(v, s), get(v, s + 1)
        drag, _, by_velocity, _ = segment.linearize_drag_between(chain, s, length, e, *ends)
        put(w.drag, s, drag)
        put_matrix(w.slope, 9 * s, by_velocity)


@kernel
def carry_by(attempt, ground, kite, x, w):
    """`carry` with these end displacements [m]."""
    n, share = attempt.chain.n, 0.0
    for i in range(n):
        put(w.trial, i, add_scaled(add_scaled(get(x, i), 1.0 - share, ground), share, kite))
        share += part_of(attempt.chain, i)
    put(w.trial, n, add(get(x, n), kite))


@kernel
def fly_as_expected(attempt, x, w):
    """Positions [m] into w.x (modified) that nodes at x [m] reach with the expected accelerations."""
    conditions, _, h, v, _ = attempt
    copy(w.free, w.x)
    for i in range(conditions.first, conditions.last + 1):
        put(w.x, i, flight(get(x, i), get(v, i), h, get(w.acceleration, i)))


@kernel
def goal_of(attempt, kind):
    """Largest node displacement [m] of a converged iteration."""
    conditions, close = attempt.conditions, CLOSE if kind == WHOLE else CLOSE_IN_STAGE
    return close * sqrt(min(1.0, STIFF / stiffest(attempt.chain))) * conditions.reeling[0] / conditions.n


@kernel
def take(attempt, time, kind, x, v, w):
    """Write the result of the iteration at a time [s] to (x, v) [m, m/s] (modified)."""
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
    """Completed fraction of a step, and the size of its next part, both in units of the finest part, after a trial.

    done, size : their values before it.  taken : whether it converged; otherwise it is subdivided.
    """
    if not taken:
        return done, size // PARTS
    done += size
    while size < FINEST and done % (size * PARTS) == 0:
        size *= PARTS
    return done, size


@kernel
def given_steps(parameters):
    """`FixedSteps` from the parameters."""
    return FixedSteps(parameters[at.FIXED_STEP], parameters[at.FIXED_STEP_METHOD])


@kernel
def count_of_steps(steps, duration, most):
    """Number of `FixedSteps` in a communication step of `duration` [s]; 0 if it is above `most`."""
    wanted = duration / steps.size - LEAST_REMAINDER
    return max(1, ceil(wanted)) if wanted <= most else 0
