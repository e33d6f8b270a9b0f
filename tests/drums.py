"""A chain on a drum, with the equations written here and no code of the package, solved by LSODA.

Nodes 0 .. n with the masses mu L/n, half of it at the ends; node 0 stays, node n moves uniformly. Each segment has the
unstretched length l0 = L/n, whose rate is u/n:

    r = x_(s+1) - x_s,   l = |r|,   e = r/l,   strain rate = (e.(v_(s+1) - v_s) - l u/L)/l0
    T = EA (l/l0 - 1) (times `slack` where l < l0) + D strain rate,   half drag = rho cd d l |w| w/4
    dL/dt = u,   m du/dt = T_1 - W - c u,    without mass: u from T_1 = W + c u
"""

from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp

G, RHO = 9.81, 1.225


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

    def tension_without_drum(self, x, v, length):
        """Per segment: elastic tension and damper at u = 0 [N], what u lowers it by [N s/m], l, e."""
        rest = length / self.n
        r, rate = np.diff(x, axis=0), np.diff(v, axis=0)
        stretched = np.sqrt((r * r).sum(axis=1))
        e = r / stretched[:, None]
        spring = self.stiffness * (stretched / rest - 1.0)
        spring = np.where(stretched > rest, spring, self.slack * spring)
        damper = self.material / rest
        return spring + damper * (rate * e).sum(axis=1), damper * stretched / length, stretched, e

    def rates(self, time, state, force):
        """Rate of the state; force : W [N] as a function of the time."""
        nodes = 3 * (self.n + 1)
        x, v, length, speed = state[:nodes].reshape(-1, 3), state[nodes:-2].reshape(-1, 3), *state[-2:]
        at_rest, by_speed, stretched, e = self.tension_without_drum(x, v, length)
        if self.mass == 0.0:
            speed = (at_rest[0] - force(time)) / (by_speed[0] + self.damping)
        tension = at_rest - by_speed * speed
        pull = tension[:, None] * e
        w = self.wind - 0.5 * (v[1:] + v[:-1])
        w = w - (w * e).sum(axis=1)[:, None] * e
        half = 0.25 * RHO * self.width * (stretched * np.sqrt((w * w).sum(axis=1)))[:, None] * w
        total = np.zeros_like(x)
        total[:-1] += pull + half
        total[1:] += half - pull
        share = self.density * np.pi / 4.0 * self.diameter**2 * length / self.n
        a = np.zeros_like(x)
        a[1:-1] = total[1:-1] / share - (0.0, 0.0, G)
        gain = (tension[0] - force(time) - self.damping * speed) / self.mass if self.mass else 0.0
        moving = np.concatenate((np.zeros((1, 3)), v[1:]))
        return np.concatenate((moving.ravel(), a.ravel(), (speed, gain)))

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
