"""Up to which communication step is a coupling stable? Linear theory of a kite on a taut tether. Helper of the examples.

Along the line from the ground to the kite a taut tether is a chain of masses, springs and dampers, and an exchange of motion
against force in communication steps of length h is a linear map of all that is remembered from one step to the next. The
largest |eigenvalue| of that map says how much a deviation grows in a step. The map is exact: the chain goes through the step
by the exponential of its matrix, its end along the cubic of docs/models/theory.md, "Driven ends".
"""

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

from coupling.ways_of_coupling import FORCES

STEPS = np.geomspace(1e-3, 0.5, 82)  # among which the first that grows is looked for [s]
GROWS = 1e-10  # |eigenvalue| - 1 of a deviation that is not rounding


def chain_matrices(n, k, c, mass):
    """A and B of dz/dt = A z + B (p, dp/dt): z positions, then velocities, of the n - 1 inner nodes; p that of the kite end.

    k, c, mass : of a segment [N/m, N s/m, kg].
    """
    inner = n - 1
    second = np.diag(np.full(inner, -2.0)) + np.diag(np.ones(max(inner - 1, 0)), 1) + np.diag(np.ones(max(inner - 1, 0)), -1)
    a = np.block([[np.zeros((inner, inner)), np.eye(inner)], [k / mass * second, c / mass * second]])
    b = np.zeros((2 * inner, 2))
    if inner:
        b[-1] = k / mass, c / mass
    return a, b


def through_a_step(a, b, h):
    """Matrices P, Q: z at the end of a step h [s] is P z + Q (p0, v0, c2, c3), the end on p0 + v0 t + c2 t^2 + c3 t^3."""
    size = len(a)
    shift = np.diag([1.0, 2.0, 3.0], 1)  # d/dt of (c0, c1, c2, c3), the polynomial seen from the present time
    whole = np.zeros((size + 4, size + 4))
    whole[:size, :size], whole[:size, size : size + 2], whole[size:, size:] = a, b, shift
    exponential = expm(h * whole)
    return exponential[:size, :size], exponential[:size, size:]


class AxialChain:
    """A tether of which only the motion along it counts, with a kite at its end; all numbers are deviations from rest.

    With one segment it is what the outputs `kite_stiffness`, `kite_damping` and `kite_end_mass` say of the tether.
    """

    def __init__(self, tether, kite_mass):
        n, rest = tether.segments, tether.initial_length / tether.segments
        self.k, self.c = tether.axial_stiffness / rest, tether.axial_damping / rest
        half = 0.5 * tether.mass_per_length * rest
        self.mass = kite_mass + half
        self.a, self.b = chain_matrices(n, self.k, self.c, 2.0 * half)
        self.inner, self.passages = n - 1, {}

    def force(self, z, end):
        """Force on the kite [N]; end : position and velocity of the kite end of the tether [m, m/s]."""
        x, v = (z[self.inner - 1], z[-1]) if self.inner else (0.0, 0.0)
        return -self.k * (end[0] - x) - self.c * (end[1] - v)

    def moved(self, kite, first, last, h):
        """Kite [m, m/s] after a step in which the force on it goes linearly from `first` to `last` [N]."""
        x, v = kite
        return x + v * h + (2.0 * first + last) * h * h / (6.0 * self.mass), v + (first + last) * h / (2.0 * self.mass)

    def step_map(self, way, h):
        """Matrix of a communication step [s] of a way of coupling: a column for each number that is remembered."""
        if h not in self.passages:  # the same for all ways
            self.passages[h] = through_a_step(self.a, self.b, h)
        p, q = self.passages[h]
        size = len(p) + 6
        columns = np.eye(size)
        z, end, kite, last, force_before = columns[: size - 6], columns[-6:-4], columns[-4:-2], columns[-2], columns[-1]

        def led_to(target):
            """z and end of the tether after the step, at whose end its kite end has this position and velocity."""
            mean = (target[0] - end[0]) / h
            c2 = (3.0 * mean - 2.0 * end[1] - target[1]) / h
            c3 = (end[1] + target[1] - 2.0 * mean) / (h * h)
            return p @ z + q @ np.array([end[0], end[1], c2, c3]), target

        before = self.force(z, end)
        acceleration = (kite[1] - last) / h
        predicted = kite[0] + h * kite[1] + 0.5 * h * h * acceleration, kite[1] + h * acceleration
        z_new, end_new = led_to(predicted)
        new = self.moved(kite, *FORCES[way](force_before, before, self.force(z_new, end_new)), h)
        given = kite[1]
        if way == "two iterations":
            given = 0.5 * (new[1] + last)  # the velocity that leads the end there, see `inputs_towards`
            z_new, end_new = led_to(new)
            new = self.moved(kite, before, self.force(z_new, end_new), h)
        return np.vstack([z_new, *end_new, *new, given, before])

    def factor(self, way, h):
        """Largest |eigenvalue| of the map of a step [-]: by how much a deviation grows in it."""
        return np.abs(np.linalg.eigvals(self.step_map(way, h))).max()

    def largest_step(self, way):
        """Largest communication step [s] up to which nothing grows, 0 if it is below 0.1 ms, infinite beyond 0.5 s."""

        def growth(h):
            return self.factor(way, h) - 1.0 - GROWS

        before = 1e-4
        if growth(before) > 0.0:
            return 0.0
        for h in STEPS:
            if growth(h) > 0.0:
                return brentq(growth, before, h, rtol=1e-3)
            before = h
        return np.inf
