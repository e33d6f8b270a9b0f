"""Equations of motion of lumped masses in any network, written anew with numpy: what systems of tethers are compared with.

Every segment is a spring and a damper with half of its mass and drag at each of its two nodes:

    T = k (l - l0) + c (dl/dt - l dl0/dt/l0),   k = EA/l0, c = D/l0, times the slack ratios where l < l0
    F = 1/4 rho cd d l |w| w,   w = W - (v_p + v_q)/2 without its part along the segment

Nodes are numbered over the whole network: first the points of the system, then the inner nodes, line by line.
"""

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp


def rope_tension(stiffness, along):
    """T [N] at a drum, of R = T + T^2/(2 EA) or T where that is below 0; EA, R [N]."""
    return along if along <= 0.0 else stiffness * (np.sqrt(1.0 + 2.0 * along / stiffness) - 1.0)


@dataclass
class Network:
    """A network of points and lines (`tetherfmu.Point`, `Line`).

    motions : driven point to a function of time, (x, v).  winch_forces : line on a drum to a function of time [N].
    """

    points: list
    lines: list
    environment: object
    wind: np.ndarray
    motions: dict = field(default_factory=dict)
    loads: dict = field(default_factory=dict)
    winch_forces: dict = field(default_factory=dict)

    def __post_init__(self):
        self.names = [point.name for point in self.points]
        self.nodes_of, self.segments_of, ends, rest, tethers, speeds = {}, {}, [], [], [], []
        count = len(self.points)
        for line in self.lines:
            n = line.tether.segments
            inner = list(range(count, count + n - 1))
            count += n - 1
            nodes = [self.names.index(line.start), *inner, self.names.index(line.end)]
            self.nodes_of[line.name], self.segments_of[line.name] = nodes, slice(len(ends), len(ends) + n)
            ends += list(pairwise(nodes))
            rest += [line.tether.initial_length / n] * n
            speeds += [line.reel_out_speed / n] * n
            tethers += [line.tether] * n
        self.p, self.q = np.array(ends).T
        self.rest, self.speeds = np.array(rest), np.array(speeds)
        self.mu = np.array([each.density * np.pi * each.diameter**2 / 4.0 for each in tethers])
        self.stiffness = np.array([each.axial_stiffness for each in tethers])
        self.damping = np.array([each.axial_damping for each in tethers])
        self.width = np.array([each.drag_coefficient * each.diameter for each in tethers])
        self.slack = np.array([(each.slack_stiffness_ratio, each.slack_damping_ratio) for each in tethers]).T
        self.point_mass = np.zeros(count)
        self.point_mass[: len(self.points)] = [point.mass or 0.0 for point in self.points]
        self.driven = [k for k, point in enumerate(self.points) if point.is_driven]
        self.free = np.setdiff1d(np.arange(count), self.driven)
        self.count = count
        self.on_drums = [line for line in self.lines if line.name in self.winch_forces]
        self.is_on_drum = np.zeros(len(self.rest), bool)
        for line in self.on_drums:
            self.is_on_drum[self.segments_of[line.name]] = True

    def rest_lengths(self, time):
        """Unstretched lengths of all segments [m]."""
        return self.rest + np.where(self.is_on_drum, 0.0, self.speeds * time)

    def turn(self, lengths, speeds):
        """Let the lines on drums have these unstretched lengths [m] and reel-out speeds [m/s]."""
        for line, length, speed in zip(self.on_drums, lengths, speeds, strict=True):
            own, n = self.segments_of[line.name], line.tether.segments
            self.rest[own], self.speeds[own] = length / n, speed / n

    def masses(self, time):
        """Masses of all nodes [kg]."""
        half = 0.5 * self.mu * self.rest_lengths(time)
        mass = self.point_mass.copy()
        np.add.at(mass, self.p, half)
        np.add.at(mass, self.q, half)
        return mass

    def segments(self, time, x, v):
        """Directions, tensions [N] and half drags [N] of all segments."""
        r, u, rest = x[self.q] - x[self.p], v[self.q] - v[self.p], self.rest_lengths(time)
        length = np.sqrt(np.sum(r * r, axis=1))
        e = r / length[:, None]
        is_slack = length < rest
        k = self.stiffness / rest * np.where(is_slack, self.slack[0], 1.0)
        c = self.damping / rest * np.where(is_slack, self.slack[1], 1.0)
        tension = k * (length - rest) + c * (np.sum(e * u, axis=1) - length * self.speeds / rest)
        w = self.wind - 0.5 * (v[self.p] + v[self.q])
        w = w - np.sum(w * e, axis=1)[:, None] * e
        speed = np.sqrt(np.sum(w * w, axis=1))
        drag = (0.25 * self.environment.air_density * self.width * length * speed)[:, None] * w
        return e, tension, drag

    def forces(self, time, x, v):
        """Forces on all nodes [N] but those that drive points."""
        e, tension, drag = self.segments(time, x, v)
        force = np.zeros((self.count, 3))
        np.add.at(force, self.p, tension[:, None] * e + drag)
        np.add.at(force, self.q, drag - tension[:, None] * e)
        force[:, 2] -= self.masses(time) * self.environment.gravity
        for name, load in self.loads.items():
            force[self.names.index(name)] += load
        for line in self.lines:  # rope flows where the winch turns as its record says
            if line.reel_out_speed != 0.0:
                length = line.tether.initial_length + line.reel_out_speed * time
                nodes, of_flow, *_ = self.flow(line.name, x, v, length, line.reel_out_speed)
                np.add.at(force, nodes, of_flow)
        return force

    def flow(self, name, x, v, length, speed):
        """Of rope that flows (docs/models/theory.md): nodes, forces f and k [N, kg] on them, R_0 [N] and I [kg]."""
        nodes, tether = np.array(self.nodes_of[name]), next(line.tether for line in self.lines if line.name == name)
        n, mu = tether.segments, tether.density * np.pi / 4.0 * tether.diameter**2
        s, rest, part = 1.0 / n, length / n, (1.0 - np.arange(n + 1) / n)[:, None]
        r, u = np.diff(x[nodes], axis=0), np.diff(v[nodes], axis=0)
        square, both = (r * r).sum(axis=1), (r * u).sum(axis=1)
        parts = (part[1:] ** 2 + part[:-1] ** 2)[:, 0]
        force, column = np.zeros((n + 1, 3)), np.zeros((n + 1, 3))
        across, along = 0.5 * mu * speed * (part[1:] + part[:-1]) * u, 0.5 * mu * speed**2 * (parts / rest)[:, None] * r
        force[:-1] -= across + along
        force[1:] -= across - along
        column[:-1] -= 0.5 * mu * part[:-1] * r
        column[1:] -= 0.5 * mu * part[1:] * r
        stiffness = np.where(square > rest**2, 1.0, tether.slack_stiffness_ratio) * tether.axial_stiffness
        heights = 0.5 * (x[nodes][1:, 2] + x[nodes][:-1, 2]) - x[nodes][0, 2]
        pull = s * (
            0.5 * stiffness * (square / rest**2 - 1.0) + tether.axial_damping / rest**2 * (both - square * speed / length)
        )
        pull += s * mu * (0.25 * (u * u).sum(axis=1) - self.environment.gravity * heights)
        pull += 0.5 * mu * parts * (0.5 * s * speed**2 * square / rest**2 - 2.0 * speed * both / rest)
        after = np.minimum(square / rest**2, 1.0)  # rope that runs into a slack segment loses its speed there
        change = np.concatenate([[1.0], after[:-1]]) - after
        lost = 0.5 * mu * speed * abs(speed) * part[:-1, 0] ** 3 * np.maximum(np.sign(speed) * change, 0.0)
        return nodes, force, column, pull.sum() + 0.5 * mu * speed**2 - lost.sum(), (0.5 * mu * parts * square / rest).sum()

    def with_driven(self, time, x, v):
        """Positions and velocities with the driven points where they are driven."""
        for k in self.driven:
            x[k], v[k] = self.motions[self.names[k]](time)
        return x, v

    def rates(self, time, y):
        """d(x, v, L, u)/dt of free nodes and drums: T + T^2/(2 EA) = R_0 + sum k . a - I u', T = W + c u + m u'.

        All u' by Newton's method.
        """
        x, v = self.unpacked(time, y)
        lengths, speeds = y[6 * len(self.free) :].reshape(2, -1)
        self.turn(lengths, speeds)
        count, free, masses, force = len(speeds), self.free, self.masses(time), self.forces(time, x, v)
        columns, pulls, yielding = np.zeros((count, *x.shape)), np.zeros(count), np.zeros((count, count))
        for k, line in enumerate(self.on_drums):
            nodes, of_flow, column, pulls[k], yielding[k, k] = self.flow(line.name, x, v, lengths[k], speeds[k])
            np.add.at(force, nodes, of_flow)
            np.add.at(columns[k], nodes, column)
        pulls += np.einsum("kij,ij->k", columns[:, free], force[free] / masses[free, None])
        yielding -= np.einsum("kij,lij->kl", columns[:, free], columns[:, free] / masses[free, None])
        stiffness = np.array([line.tether.axial_stiffness for line in self.on_drums])
        mass = np.array([line.winch.winch_mass for line in self.on_drums])
        held = [
            self.winch_forces[line.name](time) + line.winch.winch_damping * u
            for line, u in zip(self.on_drums, speeds, strict=True)
        ]
        gained = np.zeros(count)
        for _ in range(8 if count else 0):
            tension = held + mass * gained
            pulled = np.maximum(tension, 0.0)
            wrong = tension + 0.5 * pulled**2 / stiffness + yielding @ gained - pulls
            gained -= np.linalg.solve(yielding + np.diag(mass * (1.0 + pulled / stiffness)), wrong)
        a = (force + np.einsum("k,kij->ij", gained, columns))[free] / masses[free, None]
        return np.concatenate([v[free].ravel(), a.ravel(), speeds, gained])

    def unpacked(self, time, y):
        """Positions [m] and velocities [m/s] of all nodes, (nodes, 3), from those of the free nodes."""
        x, v = np.zeros((self.count, 3)), np.zeros((self.count, 3))
        x[self.free], v[self.free] = y[: 6 * len(self.free)].reshape(2, -1, 3)
        return self.with_driven(time, x, v)

    def gathered(self, of_lines):
        """Vectors of all nodes (nodes, 3) from those of each line by name."""
        found = np.zeros((self.count, 3))
        for name, nodes in self.nodes_of.items():
            found[nodes] = of_lines[name]
        return found

    def state(self, positions, velocities):
        """State of `rates` with these nodes of each line by name [m, m/s]; drums at rest."""
        nodes = [self.gathered(each)[self.free].ravel() for each in (positions, velocities)]
        return np.concatenate([*nodes, [line.tether.initial_length for line in self.on_drums], np.zeros(len(self.on_drums))])

    def integrate(self, y, times, tolerance=1e-11, method="DOP853"):
        """States at all but the first of some times [s], at which the state is y."""
        span = times[0], times[-1]
        solution = solve_ivp(self.rates, span, y, method, t_eval=times[1:], rtol=tolerance, atol=tolerance)
        assert solution.success, solution.message
        return solution.y.T

    def solve(self, system, times, tolerance=1e-11):
        """Positions and velocities of all nodes at times [s], (times, 2, nodes, 3), from the present state of a system."""
        states = self.integrate(self.state(system.positions, system.velocities), (0.0, *times), tolerance)
        return np.array([self.unpacked(time, y) for time, y in zip(times, states, strict=True)])
