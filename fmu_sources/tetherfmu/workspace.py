"""Views of the caller's work array, and what drives a chain within one communication step."""

from collections import namedtuple

from . import layout as at
from .compilation import kernel, view
from .end_motion import position_at, velocity_at
from .vectors import put

Workspace = namedtuple(
    "Workspace",
    "trial y_stage x_stage v_stage right rx rv force force_rate b stages diagonal lower upper records mass branches",
)
Workspace.__doc__ = """Scratch arrays of the kernels.

trial : a whole state.  y_stage : 6 (n + 1), positions x_stage and velocities v_stage of a stage.  right : 6 (n + 1), its
right-hand sides rx and rv.  force, force_rate, b : 3 (n + 1).  stages : `layout.STAGES` times 6 (n + 1).
diagonal, lower, upper : 9 (n + 1).  records : n derivative records of `segment.py`.  mass : n + 1.  branches : n, which
stiffness each segment has, see `segment.TAUT`.
"""

Drive = namedtuple("Drive", "ground kite first last length reeling wind load")
Drive.__doc__ = """What acts on the chain during one communication step.

ground, kite : curves of the driven ends, see `end_motion.curve`.
first, last : first and last node that moves freely.
length, reeling : unstretched length at the start [m] and its constant rate [m/s].
wind : at the reference height [m/s].  load : force on a free kite end [N].
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
    b = a + 4 * nodes
    c = b + 3 * nodes
    d = c + 2 * at.STAGES * nodes
    e = d + at.BLOCK_ARRAYS * blocks
    f = e + at.SEGMENT_RECORD * n
    return Workspace(
        work[:a],
        work[a : a + 2 * nodes],
        work[a : a + nodes],
        work[a + nodes : a + 2 * nodes],
        work[a + 2 * nodes : b],
        work[a + 2 * nodes : a + 3 * nodes],
        work[a + 3 * nodes : b],
        work[b : b + nodes],
        work[b + nodes : b + 2 * nodes],
        work[b + 2 * nodes : c],
        work[c:d],
        work[d : d + blocks],
        work[d + blocks : d + 2 * blocks],
        work[d + 2 * blocks : e],
        work[e:f],
        work[f : f + n + 1],
        work[f + n + 1 : f + 2 * n + 1],
    )


@kernel
def place_ends(n, drive, time, x, v):
    """Put the driven ends into x [m] and v [m/s] (both modified) at a time [s] of the communication step."""
    if drive.first == 1:
        put(x, 0, position_at(drive.ground, time))
        put(v, 0, velocity_at(drive.ground, time))
    if drive.last == n - 1:
        put(x, n, position_at(drive.kite, time))
        put(v, n, velocity_at(drive.kite, time))
