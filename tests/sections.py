"""Lagrange's equations of a chain of sections whose winch lengthens the first one, solved by scipy: no kernel is used.

    T = sum over half segments of mu l0/4 |v_i + W_i u r/l0|^2 + point masses,   V = sum EA (l - l0)^2/(2 l0) + weights
    p = dT/dv,  p' = dT/dx - dV/dx - dampers,   P = dT/du,  P' = dT/dL - dV/dL + mu u^2/2 + dampers - (S + S^2/(2 EA))

l0 = (L - rest)/m in the m segments of the first section, else constant; W_i = 1 - i/m there, else 0; u = L'. Dampers pull
with D (l/l0)'. S is the tension where the rope leaves a drum, M u' = S - W. Derivatives are taken with complex steps.
"""

import numpy as np
from scipy.integrate import solve_ivp

from mechanics import line_density

G, TINY = 9.81, 1e-30


class Sections:
    """A chain in series from a fixed ground end at the origin.

    tethers, masses : its tethers, and point masses [kg] at nodes; the first inner one ends the section that grows.
    drum : mass of its drum [kg].
    """

    def __init__(self, tethers, masses, drum=0.0):
        def of(quantity):
            return np.concatenate([np.full(each.segments, quantity(each)) for each in tethers])

        self.density, self.drum = of(line_density), drum
        self.stiffness = of(lambda each: each.axial_stiffness)
        self.damping = of(lambda each: each.axial_damping)
        self.at_first = of(lambda each: each.initial_length / each.segments)
        count = len(self.density)
        inner = [node for node, mass in masses.items() if mass and 0 < node < count]
        self.growing = np.arange(count) < min([tethers[0].segments, *inner])
        self.added = np.array([masses.get(node, 0.0) for node in range(count + 1)])
        self.weights = np.clip(1.0 - np.arange(count + 1) / self.growing.sum(), 0.0, None)  # W

    def rest_lengths(self, length):
        """Unstretched lengths of all segments [m] at a length of the whole chain [m]."""
        constant = self.at_first[~self.growing].sum()
        return np.where(self.growing, (length - constant) / self.growing.sum(), self.at_first)

    def node_masses(self, length):
        """Masses of all nodes [kg]."""
        half = 0.5 * self.density * self.rest_lengths(length)
        return np.append(half, 0.0) + np.append(0.0, half) + self.added

    def lagrangians(self, r, v, length, speed):
        """Kinetic minus elastic energy of each segment [J], from its vector r [m] and all node velocities v [m/s]; taut."""
        l0, w = self.rest_lengths(length), speed * self.weights
        moving = v[:-1] + (w[:-1] / l0)[:, None] * r, v[1:] + (w[1:] / l0)[:, None] * r
        squares = sum((each * each).sum(1) for each in moving)
        elongation = np.sqrt((r * r).sum(1)) - l0
        elastic = 0.5 * self.stiffness / l0 * elongation**2
        return 0.25 * self.density * l0 * squares - elastic

    def momenta(self, x, v, length, speed):
        """p of all nodes [kg m/s], and P [kg m/s]."""
        half, w, r = 0.5 * self.density, self.weights, np.diff(x, axis=0)
        p = self.node_masses(length)[:, None] * v
        p = p + np.pad((half * w[:-1] * speed)[:, None] * r, ((0, 1), (0, 0)))
        p = p + np.pad((half * w[1:] * speed)[:, None] * r, ((1, 0), (0, 0)))
        along = w[:-1] * (v[:-1] * r).sum(1) + w[1:] * (v[1:] * r).sum(1)
        square = (w[:-1] ** 2 + w[1:] ** 2) * speed * (r * r).sum(1) / self.rest_lengths(length)
        return p, half @ (along + square)

    def velocities(self, x, p, length, speed, kite):
        """Velocities [m/s] of all nodes from p; kite : of the driven last node."""
        none = np.zeros_like(x)
        found = (p - self.momenta(x, none, length, speed)[0]) / self.node_masses(length)[:, None]
        return np.concatenate([none[:1], found[1:-1], kite[None]])

    def forces(self, x, v, length, speed):
        """p' [N] of all nodes, and P' [N] without S."""
        r = np.diff(x, axis=0)
        steps = 1j * TINY * np.eye(3)
        by_r = np.stack([np.imag(self.lagrangians(r + step, v, length, speed)) / TINY for step in steps], axis=1)
        of_nodes = np.pad(by_r, ((1, 0), (0, 0))) - np.pad(by_r, ((0, 1), (0, 0)))
        of_nodes[:, 2] -= G * self.node_masses(length)
        there = length + 1j * TINY
        of_length = np.imag(self.lagrangians(r, v, there, speed).sum() - G * self.node_masses(there) @ x[:, 2]) / TINY
        l0, u = self.rest_lengths(length), np.diff(v, axis=0)
        l0_rate = np.where(self.growing, speed / self.growing.sum(), 0.0)
        lengths = np.linalg.norm(r, axis=1)
        tension = self.damping * ((r * u).sum(1) / lengths - lengths * l0_rate / l0) / l0
        pull = (tension / lengths)[:, None] * r
        of_nodes += np.pad(pull, ((0, 1), (0, 0))) - np.pad(pull, ((1, 0), (0, 0)))
        density = self.density[0]
        of_length += 0.5 * density * speed**2 + np.sum(tension * lengths / l0 * self.growing) / self.growing.sum()
        return of_nodes, of_length

    def drum_acceleration(self, x, v, p_rate, length, speed, force, kite_rate):
        """u' [m/s2] of the drum against a force [N]: P' = dT/dL + ... - (S + S^2/(2 EA)) and M u' = S - W."""
        _, pull = self.forces(x, v, length, speed)
        p, _ = self.momenta(x, v, length, speed)
        kite = v[-1]

        def momentum(step, more):
            there = x + step * v, length + step * speed, speed + more
            moving = self.velocities(there[0], p + step * p_rate, *there[1:], kite + step * kite_rate)
            return np.imag(self.momenta(there[0], moving, *there[1:])[1]) / TINY

        known, by_gain = momentum(1j * TINY, 0.0), momentum(0.0, 1j * TINY)
        # S + S^2/(2 EA) + by_gain (S - W)/M = pull - known
        a, b = 0.5 / self.stiffness[0], 1.0 + by_gain / self.drum
        c = known - pull - by_gain * force / self.drum
        return (2.0 * -c / (b + np.sqrt(b * b - 4.0 * a * c)) - force) / self.drum

    def fly(self, x, length, duration, kite, speed=None, force=None, rtol=1e-11):
        """Positions [m] of all nodes and the length [m] after a time [s], from rest at x [m] with this length [m].

        kite : function of the time [s]: position, velocity and acceleration of the last node.
        speed : function of the time: u and u'; else force : function of the time [N] of the drum.
        """
        n = len(x) - 1
        at_start = speed(0.0)[0] if speed else 0.0
        v = np.concatenate([np.zeros((n, 3)), kite(0.0)[1][None]])
        start = self.momenta(x, v, length, at_start)[0][1:-1]

        def rates(t, y):
            inner, p = y[: 3 * (n - 1)].reshape(-1, 3), y[3 * (n - 1) : 6 * (n - 1)].reshape(-1, 3)
            there, u = y[-2], speed(t)[0] if speed else y[-1]
            end, end_velocity, end_gain = map(np.asarray, kite(t))
            x = np.concatenate([np.zeros((1, 3)), inner, end[None]])
            p = np.pad(p, ((1, 1), (0, 0)))
            v = self.velocities(x, p, there, u, end_velocity)
            p_rate, _ = self.forces(x, v, there, u)
            gain = 0.0
            if not speed:
                gain = self.drum_acceleration(x, v, p_rate, there, u, force(t), end_gain)
            return np.concatenate([v[1:-1].ravel(), p_rate[1:-1].ravel(), [u, gain]])

        y = np.concatenate([x[1:-1].ravel(), start.ravel(), [length, at_start]])
        found = solve_ivp(rates, (0.0, duration), y, method="DOP853", rtol=rtol, atol=1e-11, max_step=0.05)
        assert found.success, found.message
        y = found.y[:, -1]
        ends = np.zeros((1, 3)), kite(duration)[0][None]
        return np.concatenate([ends[0], y[: 3 * (n - 1)].reshape(-1, 3), ends[1]]), y[-2]
