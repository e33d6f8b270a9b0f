"""A chain on a drum, with the equations written here and no code of the package, solved by LSODA.

Nodes 0 .. n with the masses mu L/n, half of it at the ends; node 0 stays, node n moves uniformly. Each segment has the
unstretched length l0 = L/n, whose rate is u/n:

    r = x_(s+1) - x_s,   l = |r|,   e = r/l,   strain rate = (e.(v_(s+1) - v_s) - l u/L)/l0
    T = EA (l/l0 - 1) (times `slack` where l < l0) + D strain rate,   half drag = rho cd d l |w| w/4
    K = sum of 1/2 (mu l0/2) |v_i + u (1 - i/n) r/l0|^2 over both halves of all segments
    d/dt dK/dv_i - dK/dx_i = F_i,   d/dt dK/du - dK/dL = R - mu u^2/2 - (T_0 + T_0^2/(2 EA)),   T_0 = W + c u + m u'

where R is the force of springs, dampers and weight along L, and rope on the drum, at the height of node 0, has the speed u.
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp

G, RHO = 9.81, 1.225


def rope_tension(stiffness, along):
    """T [N] at a drum, of R = T + T^2/(2 EA) or T where that is below 0; EA, R [N]."""
    return along if along <= 0.0 else stiffness * (np.sqrt(1.0 + 2.0 * along / stiffness) - 1.0)


@dataclass
class Drum:
    """A tether on its drum; SI units."""

    x: np.ndarray  # (n + 1, 3)
    kite_velocity: np.ndarray
    wind: np.ndarray
    length: float
    mass: float  # m
    damping: float  # c
    stiffness: float = 614600.0
    material: float = 473.0  # D
    diameter: float = 0.004
    density: float = 724.0
    slack: float = 0.01
    width: float = field(default=0.958 * 0.004)
    speed: float = 0.0

    def __post_init__(self):
        self.n = len(self.x) - 1
        part = np.arange(self.n + 1)[:, None] / self.n
        self.state = np.concatenate((self.x.ravel(), (part * self.kite_velocity).ravel(), (self.length, self.speed)))

    def pulls(self, x, v, length, speed):
        """Per segment: r, its rate, l, e, tension [N], force of spring and damper along the unstretched length [N]."""
        rest = length / self.n
        r, rate = np.diff(x, axis=0), np.diff(v, axis=0)
        stretched = np.sqrt((r * r).sum(axis=1))
        e = r / stretched[:, None]
        stiffness = np.where(stretched > rest, 1.0, self.slack) * self.stiffness
        damper = self.material / rest * ((rate * e).sum(axis=1) - stretched * speed / length)
        stored = 0.5 * stiffness * ((stretched / rest) ** 2 - 1.0)
        return r, rate, stretched, e, stiffness * (stretched / rest - 1.0) + damper, stored + damper * stretched / rest

    def rates(self, time, state, force):
        """Rate of the state; force : W [N] as a function of the time."""
        nodes, n = 3 * (self.n + 1), self.n
        x, v, length, u = state[:nodes].reshape(-1, 3), state[nodes:-2].reshape(-1, 3), *state[-2:]
        r, rate, stretched, e, tension, along = self.pulls(x, v, length, u)
        pull = tension[:, None] * e
        w = self.wind - 0.5 * (v[1:] + v[:-1])
        w = w - (w * e).sum(axis=1)[:, None] * e
        half = 0.25 * RHO * self.width * (stretched * np.sqrt((w * w).sum(axis=1)))[:, None] * w
        total = np.zeros_like(x)
        total[:-1] += pull + half
        total[1:] += half - pull
        mu, rest = self.density * np.pi / 4.0 * self.diameter**2, length / n
        total[:, 2] -= mu * rest * G  # of inner nodes
        column, inertia = np.zeros_like(x), 0.0
        motor = along.sum() / n - mu * G * (0.5 * (x[1:, 2] + x[:-1, 2]) - x[0, 2]).sum() / n + 0.5 * mu * u * u
        for j in range(2):  # d/dt dK/dq' - dK/dq of the halves at the lower and at the upper nodes, without q''
            part = (1.0 - np.arange(j, n + j) / n)[:, None]
            of_node, flow = v[j : n + j], part * u
            velocity = of_node + flow * r / rest
            total[j : n + j] -= 0.5 * mu * (u / n * of_node + flow * rate)
            total[:-1] -= 0.5 * mu * flow * velocity
            total[1:] += 0.5 * mu * flow * velocity
            motor -= 0.5 * mu * (part * (rate * velocity + r * (flow * rate / rest - flow * u / n * r / rest**2))).sum()
            motor += (0.25 * mu * velocity**2 - 0.5 * mu * velocity * flow * r / rest).sum() / n
            column[j : n + j] -= 0.5 * mu * part * r
            inertia += 0.5 * mu * (part**2 * r * r).sum() / rest
        free = total[1:-1] / (mu * rest), column[1:-1] / (mu * rest)
        motor += (column[1:-1] * free[0]).sum()
        inertia -= (column[1:-1] * free[1]).sum()
        held = force(time) + self.damping * u
        gain = 0.0
        for _ in range(6):  # Newton's method
            tension = held + self.mass * gain
            pulled = max(tension, 0.0)
            wrong = tension + 0.5 * pulled**2 / self.stiffness + inertia * gain - motor
            gain -= wrong / (self.mass * (1.0 + pulled / self.stiffness) + inertia)
        a = np.zeros_like(x)
        a[1:-1] = free[0] + gain * free[1]
        moving = np.concatenate((np.zeros((1, 3)), v[1:]))
        return np.concatenate((moving.ravel(), a.ravel(), (u, gain)))

    def advance(self, step, force):
        """Go on by a time [s]; force : W [N] as a function of the time within it."""
        solved = solve_ivp(self.rates, (0.0, step), self.state, "LSODA", args=(force,), rtol=1e-9, atol=1e-10)
        assert solved.success, solved.message
        self.state = solved.y[:, -1]
        return self.state[-2]


def scene(seed):
    """`Drum` of a random scene."""
    random = np.random.default_rng(seed)
    n, length = int(random.integers(1, 5)), random.uniform(50.0, 500.0)
    direction = random.normal(size=3)
    direction[2] = 1.0 + abs(direction[2])
    kite = direction / np.linalg.norm(direction) * length * random.uniform(0.99, 1.001)
    x = np.linspace(np.zeros(3), kite, n + 1)
    mass = 0.0 if seed % 2 else 10.0 ** random.uniform(0.0, 4.0)
    damping = float(random.choice((0.0, 50.0)))
    wind, velocity = random.uniform(-10.0, 10.0, 3), random.uniform(-3.0, 3.0, 3)
    return Drum(x, velocity, wind, length, mass, damping), random.uniform(20.0, 500.0), random.uniform(0.5, 3.0)
