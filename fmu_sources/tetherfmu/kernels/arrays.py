"""Sizes of the flat arrays, views of a state and of the caller's work array.

The work array begins with arrays that all solvers of a chain share (`shared_arrays`); each solver divides the room behind
them in its own record `Workspace`.
"""

from itertools import accumulate

from tetherfmu.runtime import layout as at

from .compilation import kernel, view
from .flat_arrays import part

parameters_size = kernel(at.parameters_size)
inputs_size = kernel(at.inputs_size)
state_size = kernel(at.state_size)
nodes_end = kernel(at.nodes_end)
outputs_size = kernel(at.outputs_size)


def places_of(*sizes):
    """First places of consecutive parts of these sizes in an array, and the place behind the last."""
    return tuple(accumulate(sizes, initial=0))


SEGMENT_RECORD = 35  # numbers of the derivatives of one segment, see `equations/segment.py`


@view
def positions_and_velocities(n, state):
    """Views of the node positions [m] and node velocities [m/s] in a state."""
    nodes = 3 * (n + 1)
    return part(state, at.STATE_HEADER, nodes), part(state, at.STATE_HEADER + nodes, nodes)


@kernel
def shared_size(n):
    """Length of `shared_arrays` in the work array."""
    return 2 * SEGMENT_RECORD * ((n + 1) // 2) + 28 * (n + 1)


@view
def shared_arrays(n, work):
    """Views of the shared arrays: blocks of the matrix (three), records, node masses [kg]; and the room behind them.

    blocks : of `block_tridiagonal.Matrix`.  records : derivatives of the forces of all segments, see `assembly.record_of`.
    Records begin at an even place, so that no pair of an interleaved array crosses a cache line.
    """
    size = 9 * (n + 1)
    block = 2 * SEGMENT_RECORD * ((n + 1) // 2)
    mass = block + 3 * size
    blocks = part(work, block, size), part(work, block + size, size), part(work, block + 2 * size, size)
    return blocks, part(work, 0, block), part(work, mass, n + 1), behind(mass + n + 1, work)


@view
def behind(start, array):
    """View of an array from a place on."""
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


@kernel
def clear(array):
    """Set a flat array to zero (modified)."""
    for k in range(len(array)):
        array[k] = 0.0
