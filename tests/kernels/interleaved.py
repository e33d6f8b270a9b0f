"""Flat arrays of node vectors for kernels that take interleaved ones."""

import numpy as np

from tetherfmu.kernels.equations import assembly
from tetherfmu.kernels.linear_algebra.both_ends import deinterleave, interleave, interleaved_size


def interleaved(flat):
    """An interleaved copy of a flat array."""
    n = len(flat) // 3 - 1
    copy = np.full(interleaved_size(n), np.nan)
    interleave(n, flat, copy)
    return copy


def room_for_segments(n):
    """What `assembly.find_segments` fills."""
    return np.zeros(assembly.segments_size(n))


def node_forces(chain, modes, x, v):
    """Forces on all nodes [N], flat, of flat positions and velocities."""
    mass, force = np.zeros(chain.n + 1), np.zeros_like(x)
    assembly.node_masses(chain, mass)
    found = np.zeros(interleaved_size(chain.n))
    assembly.node_forces(chain, modes, interleaved(x), interleaved(v), mass, room_for_segments(chain.n), found)
    deinterleave(chain.n, found, force)
    return force
