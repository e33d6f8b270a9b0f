"""Flat arrays of node vectors for kernels that take folded ones."""

import numpy as np

from tetherfmu.kernels.algebra.both_ends import fold, folded_size, unfold
from tetherfmu.kernels.chain import nodes


def folded(flat):
    """A folded copy of a flat array."""
    n = len(flat) // 3 - 1
    copy = np.full(folded_size(n), np.nan)
    fold(n, flat, copy)
    return copy


def room_for_segments(n):
    """What `nodes.find_segments` fills."""
    return np.zeros(nodes.segments_size(n))


def node_forces(chain, branches, x, v):
    """Forces on all nodes [N], flat, of flat positions and velocities."""
    mass, force = np.zeros(chain.n + 1), np.zeros_like(x)
    nodes.node_masses(chain, mass)
    found = np.zeros(folded_size(chain.n))
    nodes.node_forces(chain, branches, folded(x), folded(v), mass, room_for_segments(chain.n), found)
    unfold(chain.n, found, force)
    return force
