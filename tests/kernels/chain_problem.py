"""A small chain with everything switched on, for tests that call kernels directly."""

import numpy as np

from kernels.packed import packed
from tetherfmu import Environment, Solver, Tether
from tetherfmu.kernels.arrays import nodes_end, shared_size
from tetherfmu.kernels.equations import end_motion, winch
from tetherfmu.kernels.equations.boundary import BoundaryConditions, chain_during
from tetherfmu.kernels.line import backward_euler, rosenbrock
from tetherfmu.kernels.variants.dynamic import work_size
from tetherfmu.runtime import layout as at


class ChainProblem:
    """Arrays and the conditions of a bent chain of 4 segments in a sheared wind; both ends move, the tether reels.

    It stays taut, so that its forces are smooth and the order of a method can be seen. wind_profile : of `layout.py`.
    masses : pairs (node, point mass [kg]); the first one ends the section at the winch.
    """

    SEGMENTS = 4

    def __init__(self, reeling=1.5, damping_law=1, wind_profile=2, masses=()):
        self.n = n = self.SEGMENTS
        tether = Tether(
            segments=n, initial_length=38.0, diameter=0.02, axial_stiffness=2e3, axial_damping=60.0, damping_law=damping_law
        )
        self.parameters = packed(
            tether, Environment(air_density_scale_height=500.0), Solver(relative_tolerance=1e-6), masses=masses
        )
        self.parameters[at.WIND_PROFILE] = wind_profile
        if wind_profile == at.AT_NODES:
            winds = slice(at.node_winds_at(n), at.node_winds_at(n) + 3 * (n + 1))
            self.parameters[winds] = 9.0 * np.random.default_rng(3).normal(size=3 * (n + 1))
        self.wind = (8.0, 2.0, 1.0)
        self.length = 38.0
        nodes = np.linspace([0.0, 0.0, 1.0], [22.0, 3.0, 36.0], n + 1)
        nodes[1:-1] += [[0.3, -0.5, -0.9], [0.8, 0.2, -1.0], [-0.2, 0.4, -0.7]]
        self.state = np.zeros(at.state_size(n))
        self.x, self.v = self.state[at.STATE_HEADER : nodes_end(n)].reshape(2, -1)
        self.x[:] = nodes.ravel()
        self.v[:] = np.linspace([1.0, 0.0, 0.5], [6.0, 4.0, -3.0], n + 1).ravel()
        self.memory = np.zeros(work_size(n))
        self.of_rosenbrock = rosenbrock.workspace(n, self.memory)
        self.of_euler = backward_euler.workspace(n, self.memory, self.memory[shared_size(n) :])
        still = (0.0, 0.0, 0.0)
        self.conditions = BoundaryConditions(
            n,
            self.parameters,
            end_motion.curve(tuple(nodes[0]), (1.0, 0.0, 0.5), tuple(nodes[0]), (1.0, 0.3, 0.5), (0.0, 1.0, 0.0), 0.4),
            end_motion.curve(tuple(nodes[n]), (6.0, 4.0, -3.0), tuple(nodes[n]), (6.0, 5.0, -3.0), (1.0, 0.0, 2.0), 0.4),
            1,
            n - 1,
            winch.steadily(self.length, reeling, 0.0),
            0.0,
            0.0,
            self.wind,
            still,
            still,
        )
        self.chain = chain_during(self.conditions, 0.0)
