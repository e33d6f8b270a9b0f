"""A chain over a flat ground, with the equations written here and no code of the package, solved by LSODA.

Nodes 0 .. n with the masses mu L/n, half of it at the ends, and a point mass at the kite end; ends are free or stay. In
still air, without drag:

    r = x_(s+1) - x_s,   l = |r|,   e = r/l,   T = EA (l/l0 - 1) (times `slack` where l < l0) + D e.(v_(s+1) - v_s)/l0
    ground on node i:  d = h - z,   N = max(0, m w2 d (1 - a v_z)) where d > 0,   w2 = g/sink,   a = 2/sqrt(g sink)
                       friction -mu N v_t/sqrt(v_t^2 + v_r^2)
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

G = 9.81
CREEP = 2e-4  # v_r [m/s]


@dataclass
class Chain:
    """A chain above or on the ground; SI units."""

    x: np.ndarray  # (n + 1, 3)
    v: np.ndarray
    length: float
    free: tuple = (False, False)
    kite_mass: float = 0.0
    stiffness: float = 614600.0
    material: float = 473.0  # D
    diameter: float = 0.004
    density: float = 724.0
    slack: float = 0.01
    height: float = 0.0
    friction: float = 0.5
    sink: float = 0.002

    def __post_init__(self):
        self.n = len(self.x) - 1
        self.mass = np.full(self.n + 1, self.density * np.pi / 4.0 * self.diameter**2 * self.length / self.n)
        self.mass[[0, -1]] *= 0.5
        self.mass[-1] += self.kite_mass

    def ground(self, x, v):
        """Force of the ground on each node (n + 1, 3) [N]."""
        depth = self.height - x[:, 2]
        pressed = self.mass * G / self.sink * depth * (1.0 - 2.0 / np.sqrt(G * self.sink) * v[:, 2])
        pressed = np.where(depth > 0.0, np.maximum(pressed, 0.0), 0.0)
        sliding = v[:, :2] / np.sqrt(v[:, 0] ** 2 + v[:, 1] ** 2 + CREEP**2)[:, None]
        return np.column_stack((-self.friction * pressed[:, None] * sliding, pressed))

    def rates(self, _, state):
        """Rate of the state."""
        x, v = state.reshape(2, -1, 3)
        rest = self.length / self.n
        r = np.diff(x, axis=0)
        stretched = np.sqrt((r * r).sum(axis=1))
        e = r / stretched[:, None]
        spring = self.stiffness * (stretched / rest - 1.0) * np.where(stretched > rest, 1.0, self.slack)
        pull = (spring + self.material / rest * (np.diff(v, axis=0) * e).sum(axis=1))[:, None] * e
        force = self.ground(x, v)
        force[:-1] += pull
        force[1:] -= pull
        a = force / self.mass[:, None] - (0.0, 0.0, G)
        moves = np.ones((self.n + 1, 1))
        moves[0], moves[-1] = self.free
        return np.concatenate(((moves * v).ravel(), (moves * a).ravel()))

    def advance(self, time):
        """Go on by a time [s]: positions and velocities."""
        start = np.concatenate((self.x.ravel(), self.v.ravel()))
        solved = solve_ivp(self.rates, (0.0, time), start, "LSODA", rtol=1e-9, atol=1e-11, max_step=0.01)
        assert solved.success, solved.message
        self.x, self.v = solved.y[:, -1].reshape(2, -1, 3)
        return self.x, self.v


def scene(seed):
    """`Chain` of a random scene: straight, near the ground, falling and sliding, held at one end, both or none."""
    random = np.random.default_rng(seed)
    n, length = int(random.integers(2, 6)), random.uniform(3.0, 20.0)
    free = [(False, False), (False, True), (True, True)][seed % 3]
    start = np.array([0.0, 0.0, random.uniform(0.02, 0.2)])
    way = random.normal(size=3) * (1.0, 1.0, 0.02)
    way *= length * random.uniform(0.9, 1.0005) / np.linalg.norm(way)
    end = start + way
    end[2] = abs(end[2]) + 0.02
    x = np.linspace(start, end, n + 1)
    part = np.linspace(0.0, 1.0, n + 1)[:, None]
    share = np.ones_like(part) if free[0] else free[1] * part  # of the velocity of the kite end
    v = share * random.normal(size=3) * (1.0, 1.0, 0.5)
    friction, sink = random.choice((0.0, 0.3, 0.8)), random.choice((0.002, 0.01))
    return Chain(x, v, length, free, 2.0 if free == (False, True) else 0.0, friction=friction, sink=sink)
