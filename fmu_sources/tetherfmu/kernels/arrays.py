"""Sizes of the flat arrays, and views of the caller's work array."""

from collections import namedtuple

from tetherfmu.runtime import layout as at

from .compilation import kernel, view

Workspace = namedtuple(
    "Workspace",
    "trial x_stage v_stage r momentum force force_rate b velocities diagonal lower upper records mass stage_mass branches",
)
Workspace.__doc__ = """Scratch arrays of the kernels.

trial : a whole state.  x_stage, v_stage, r, momentum, force, force_rate, b : 3 (n + 1).  velocities : `layout.STAGES` times
3 (n + 1).  diagonal, lower, upper : 9 (n + 1).  records : of derivatives, see `chain.record_of`.  mass, stage_mass : n + 1.
branches : n, which stiffness each segment has, see `segment.TAUT`.
"""

parameters_size = kernel(at.parameters_size)
state_size = kernel(at.state_size)
outputs_size = kernel(at.outputs_size)
work_size = kernel(at.work_size)


@view
def workspace(n, work):
    """Cut the work array into the arrays of `Workspace`."""
    nodes = 3 * (n + 1)
    blocks = 9 * (n + 1)
    a = at.STATE_HEADER + 2 * nodes
    b = a + 7 * nodes
    c = b + at.STAGES * nodes
    d = c + at.BLOCK_ARRAYS * blocks
    e = d + at.SEGMENT_RECORD * (n + 1)
    return Workspace(
        work[:a],
        work[a : a + nodes],
        work[a + nodes : a + 2 * nodes],
        work[a + 2 * nodes : a + 3 * nodes],
        work[a + 3 * nodes : a + 4 * nodes],
        work[a + 4 * nodes : a + 5 * nodes],
        work[a + 5 * nodes : a + 6 * nodes],
        work[a + 6 * nodes : b],
        work[b:c],
        work[c : c + blocks],
        work[c + blocks : c + 2 * blocks],
        work[c + 2 * blocks : d],
        work[d:e],
        work[e : e + n + 1],
        work[e + n + 1 : e + 2 * (n + 1)],
        work[e + 2 * (n + 1) : e + 3 * n + 2],
    )
