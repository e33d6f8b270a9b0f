"""Sizes of the flat arrays, views of a state and of the caller's work array.

The work array holds a whole state for trial, then the arrays that all solvers of a chain share (`shared_arrays`), then room
that each solver divides and names for itself.
"""

from tetherfmu.runtime import layout as at

from .compilation import kernel, part, view

parameters_size = kernel(at.parameters_size)
state_size = kernel(at.state_size)
outputs_size = kernel(at.outputs_size)
work_size = kernel(at.work_size)


@view
def positions_and_velocities(n, state):
    """Views of the node positions [m] and node velocities [m/s] in a state."""
    nodes = 3 * (n + 1)
    return part(state, at.STATE_HEADER, nodes), part(state, at.STATE_HEADER + nodes, nodes)


@view
def trial_state(n, work):
    """View of a whole state in the work array."""
    return part(work, 0, state_size(n))


@view
def shared_arrays(n, work):
    """Views of what the solvers share: blocks of the matrix (three), records, node masses [kg]; and the room behind them.

    blocks : of `block_tridiagonal.Matrix`.  records : derivatives of the forces of all segments, see `nodes.record_of`.
    Records and room begin at even places, so that no pair of a folded array lies across two lines of the cache.
    """
    size = 9 * (n + 1)
    records = state_size(n) + state_size(n) % 2
    block = records + 2 * at.SEGMENT_RECORD * ((n + 1) // 2)
    mass = block + 3 * size
    room = mass + n + 1
    blocks = part(work, block, size), part(work, block + size, size), part(work, block + 2 * size, size)
    return blocks, part(work, records, block - records), part(work, mass, n + 1), behind(room, work)


@view
def behind(start, array):
    """View of what an array has from a place on."""
    return part(array, start, len(array) - start)


@view
def split(size, room):
    """Views of three arrays of so many numbers at the start of a room; and the room behind them."""
    return part(room, 0, size), part(room, size, size), part(room, 2 * size, size), behind(3 * size, room)


@view
def node_arrays(n, room):
    """Views of six arrays of node vectors, 3 (n + 1) numbers each, at the start of a room; and the room behind them."""
    a, b, c, room = split(3 * (n + 1), room)
    d, e, f, room = split(3 * (n + 1), room)
    return a, b, c, d, e, f, room


@kernel
def copy(source, destination):
    """Copy a flat array into another of the same length (modified)."""
    for k in range(len(source)):
        destination[k] = source[k]
