"""Sizes of the flat arrays, views of a state and of the caller's work array.

The work array holds a whole state for trial, then the arrays that all solvers of a chain share (`shared_arrays`), then room
that each solver divides and names for itself.
"""

from tetherfmu.runtime import layout as at

from .compilation import kernel, view

parameters_size = kernel(at.parameters_size)
state_size = kernel(at.state_size)
outputs_size = kernel(at.outputs_size)
work_size = kernel(at.work_size)


@view
def positions_and_velocities(n, state):
    """Views of the node positions [m] and node velocities [m/s] in a state."""
    nodes = 3 * (n + 1)
    return (
        state[at.STATE_HEADER : at.STATE_HEADER + nodes],
        state[at.STATE_HEADER + nodes : at.STATE_HEADER + 2 * nodes],
    )


@view
def trial_state(n, work):
    """View of a whole state in the work array."""
    return work[: at.STATE_HEADER + 6 * (n + 1)]


@view
def shared_arrays(n, work):
    """Views of what the solvers share: blocks of the matrix (three), records, node masses [kg]; and the room behind them.

    blocks : of `block_tridiagonal.Matrix`.  records : derivatives of the forces of all segments, see `nodes.record_of`.
    """
    first = at.STATE_HEADER + 6 * (n + 1)
    size = 9 * (n + 1)
    records = first + 3 * size
    mass = records + at.SEGMENT_RECORD * (n + 1)
    blocks = work[first : first + size], work[first + size : first + 2 * size], work[first + 2 * size : records]
    return blocks, work[records:mass], work[mass : mass + n + 1], work[mass + n + 1 :]


@view
def node_arrays(n, room):
    """Views of six arrays of node vectors, 3 (n + 1) numbers each, at the start of a room; and the room behind them."""
    a = 3 * (n + 1)
    b, c, d, e, f = 2 * a, 3 * a, 4 * a, 5 * a, 6 * a
    return room[:a], room[a:b], room[b:c], room[c:d], room[d:e], room[e:f], room[f:]


@kernel
def copy(source, destination):
    """Copy a flat array into another of the same length (modified)."""
    for k in range(len(source)):
        destination[k] = source[k]
