"""Sections and point masses while the rope is reeled: new rope comes from the winch, so only its section changes.

kept     the upper section keeps its mass and its length to the last digits
flight   Lagrange's equations of the chain, solved by scipy (`Sections`), with each winch, adaptive and in fixed steps
hang     z = - sum over the sections of L + L (weight below + half of its own)/EA, also of the lumped chain
energy   what the powers do not explain falls with the square of the communication step
end      the winch cannot reel in more than its section: refused by speed and length, a stop of a drum
"""

from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from audited import run
from mechanics import line_density
from tetherfmu import Environment, Solver, StepRefused, Tether, TetherDynamic, TetherDynamicFree, TetherQuasiSteady, Winch
from tetherfmu.runtime.limits import MIN_SEGMENT_LENGTH

LIGHT = Tether(segments=19, initial_length=190.0, diameter=0.01)
HEAVY = Tether(
    segments=2, initial_length=10.0, diameter=0.03, density=4.0 / (np.pi * 0.03**2), axial_stiffness=3e6
)  # 1 kg/m
G = 9.81
PAIR, TOTAL = (LIGHT, HEAVY), 400.0
AIRLESS = Environment(air_density=0.0)


# --- kept


def test_the_upper_section_keeps_mass_and_length():
    """Quasi-steady and upright: tensions and lengths of segments say how much rope they are."""
    tether = TetherQuasiSteady(PAIR, AIRLESS)
    moving = {"kite_velocity": (0.0, 0.0, 0.1001), "reel_out_speed": 0.1}
    outputs = tether.initialize(kite_position=(0.0, 0.0, 200.2), **moving)
    for k in range(200):
        outputs = tether.step(10.0, kite_position=(0.0, 0.0, 1.001 * (200.0 + k)), **moving)
    assert outputs.tether_length == pytest.approx(TOTAL, rel=1e-12)
    strains = tether.segment_tensions / np.repeat([each.axial_stiffness for each in PAIR], [19, 2])
    rest = tether.segment_lengths / (1.0 + strains)
    np.testing.assert_allclose(rest, np.repeat([390.0 / 19, 5.0], [19, 2]), rtol=1e-12)
    weight = G * (line_density(LIGHT) * 390.0 + 10.0)
    assert -(outputs.ground_force + outputs.kite_force)[2] == pytest.approx(weight, rel=1e-9)  # tolerance of the equilibrium
    assert outputs.kite_end_mass == pytest.approx(2.5, rel=1e-12)


def test_a_point_mass_stays_where_it_is_on_the_rope():
    """2 kg at 30 of 50 m, reeled in to 40 m: 20 m below and still 20 m above it, strained by 2.5 %."""
    calm = Environment(gravity=0.0, air_density=0.0)
    tether = TetherQuasiSteady(Tether(segments=5, initial_length=50.0), calm, point_masses={3: 2.0})
    tether.initialize(kite_position=(51.0, 0.0, 0.0))
    for k in range(10):
        tether.step(1.0, kite_position=(50.0 - k, 0.0, 0.0), reel_out_speed=-1.0)
    np.testing.assert_allclose(tether.segment_lengths, np.repeat([20.0 / 3, 10.0], [3, 2]) * 1.025, rtol=1e-9)


# --- flight

TINY = 1e-30  # of complex steps


class Sections:
    """A chain in series from a fixed ground end at the origin, by Lagrange's equations; no kernel is used.

        T = sum over half segments of mu l0/4 |v_i + W_i u r/l0|^2 + point masses,   V = sum EA (l - l0)^2/(2 l0) + weights
        p = dT/dv,  p' = dT/dx - dV/dx - dampers,   P = dT/du,  P' = dT/dL - dV/dL + mu u^2/2 + dampers - (S + S^2/(2 EA))

    l0 = (L - rest)/m in the m segments of the first section, else constant; W_i = 1 - i/m there, else 0; u = L'. Dampers
    pull with D (l/l0)'. S is the tension where the rope leaves a drum, M u' = S - W. Derivatives are by complex steps.

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


LOWER = {"diameter": 0.01, "density": 2000.0, "axial_stiffness": 2e4, "axial_damping": 100.0, "drag_coefficient": 0.0}
UPPER = {"diameter": 0.03, "density": 1400.0, "axial_stiffness": 5e4, "axial_damping": 150.0, "drag_coefficient": 0.0}
SERIES = Tether(segments=3, initial_length=10.0, **LOWER), Tether(segments=2, initial_length=5.0, **UPPER)
MASSES = {"sections": {}, "knot": {3: 1.5}, "masses": {2: 0.8, 4: 0.5}}
END, SPEED, FORCE, DRUM, DURATION = np.array((9.0, 2.0, 12.5)), 0.3, 500.0, 8.0, 0.3
PLACES = np.array((0.0, 10.0 / 3, 20.0 / 3, 10.0, 12.5, 15.0)) / 15.0  # of the nodes, on the unstretched rope
SHAPE = np.outer(PLACES, END) + np.outer(PLACES * (1.0 - PLACES), (0.6, -1.2, 0.0))


@cache
def reference(masses, by_force):
    """Positions of all nodes [m] and the length [m] of the solver with scipy."""
    told = {"force": lambda t: FORCE} if by_force else {"speed": lambda t: (SPEED, 0.0)}
    chain = Sections(SERIES, MASSES[masses], DRUM)
    return chain.fly(SHAPE, 15.0, DURATION, lambda t: (END, np.zeros(3), np.zeros(3)), **told)


def errors(masses, control, solver):
    """Errors of positions and of the length after the flight [m]."""
    winch = Winch(winch_control=control, **({"winch_mass": DRUM} if control == "force" else {}))
    tether = TetherDynamic(SERIES, Environment(), solver, winch, point_masses=MASSES[masses])
    told = {"force": {"winch_force": FORCE}, "speed": {"reel_out_speed": SPEED}}
    first = told.get(control, {"reel_out_speed": SPEED, "winch_length": 15.0})
    outputs, step = tether.initialize(positions=SHAPE, velocities=0.0 * SHAPE, **first), 0.01
    for k in range(round(DURATION / step)):
        outputs = tether.step(step, **told.get(control, {"winch_length": 15.0 + SPEED * k * step}))
    positions, length = reference(masses, control == "force")
    return max(np.abs(tether.positions - positions).max(), abs(outputs.tether_length - length))


@pytest.mark.parametrize("control", ["speed", "length", "force"])
@pytest.mark.parametrize("masses", MASSES)
def test_a_flight_of_sections(masses, control):
    """Adaptive steps within a micrometre, fixed steps with their order."""
    assert errors(masses, control, Solver(relative_tolerance=1e-8)) < 1e-7
    for method, order, largest in (("second_order", 2.0, 1e-4), ("backward_euler", 1.0, 0.1)):
        found = [errors(masses, control, Solver(fixed_step=h, fixed_step_method=method)) for h in (0.001, 0.0005)]
        assert np.log2(found[0] / found[1]) == pytest.approx(order, abs=0.2)
        assert found[1] < largest


# --- hang


def depth(load, length):
    """How deep [m] a load [kg] hangs on the pair at an unstretched length [m]."""
    found, below = 0.0, load
    for tether, own in ((HEAVY, HEAVY.initial_length), (LIGHT, length - HEAVY.initial_length)):
        mass = line_density(tether) * own
        found += own * (1.0 + G * (below + 0.5 * mass) / tether.axial_stiffness)
        below += mass
    return found


def test_two_sections_hang_after_reeling():
    """From the start at this length, and after the winch has paid out so much (damped: 0.1 mm of its waves are left)."""
    options = {"kite_mass": 20.0, "kite_start": "equilibrium", "winch_control": "length"}
    tether = TetherDynamicFree(PAIR, **options)
    at_start = tether.initialize(kite_position=(0.0, 0.0, -TOTAL), winch_length=TOTAL)
    assert at_start.kite_position[2] == pytest.approx(-depth(20.0, TOTAL), abs=1e-9)
    tether = TetherDynamicFree(PAIR, Environment(), Solver(fixed_step=0.05, fixed_step_method="backward_euler"), **options)
    outputs = tether.initialize(kite_position=(0.0, 0.0, -200.0), winch_length=200.0)
    for k in range(2000):
        outputs = tether.step(0.1, winch_length=min(200.0 + 0.2 * k, TOTAL))
    assert outputs.kite_position[2] == pytest.approx(-depth(20.0, TOTAL), abs=1e-4)


# --- energy


@pytest.mark.parametrize("control", ["speed", "force"])
def test_the_powers_explain_the_energy(control):
    """Of sections that swing while they are reeled."""

    def told(time):
        return {"winch_force": FORCE} if control == "force" else {"reel_out_speed": SPEED * (1.0 + np.sin(5.0 * time))}

    winch, residuals = Winch(winch_control=control, **({"winch_mass": DRUM} if control == "force" else {})), []
    for step in (0.002, 0.001):
        solver = Solver(relative_tolerance=1e-8)
        tether = TetherDynamic(SERIES, Environment(), solver, winch, point_masses=MASSES["masses"])
        tether.initialize(positions=SHAPE, velocities=0.0 * SHAPE, **told(0.0))
        flown = run(tether, told, step, round(0.4 / step))
        residuals.append(np.abs(flown.residual).max())
    assert np.log2(residuals[0] / residuals[1]) == pytest.approx(2.0, abs=0.4)
    assert residuals[1] < 2e-4 * flown.turnover


# --- end


@pytest.mark.parametrize("control", ["speed", "length"])
def test_a_winch_cannot_reel_in_more_than_its_section(control):
    tether = TetherDynamic(PAIR, winch_control=control)
    first = {"winch_length": 200.0} if control == "length" else {}
    tether.initialize(kite_position=(0.0, 0.0, 199.9), **first)
    told = {"winch_length": 10.1} if control == "length" else {"reel_out_speed": -1000.0}
    before = tether.get_state()
    with pytest.raises(StepRefused, match=r"(speed -1000.0|length 10\.1) .*tether_length 200.0 m, at least 10\.19 m"):
        tether.step(0.19, **told)
    np.testing.assert_array_equal(tether.get_state(), before)


@pytest.mark.parametrize("solver", [Solver(), Solver(fixed_step=0.01)], ids=["adaptive", "fixed"])
def test_a_drum_stops_at_the_end_of_its_section(solver):
    """The upper section, 5 m, stays out; it then hangs on."""
    upper = Tether(segments=2, initial_length=5.0, **UPPER)
    lower = Tether(segments=3, initial_length=0.5, **LOWER)
    winch = Winch(winch_control="force", winch_mass=20.0)
    tether = TetherDynamicFree((lower, upper), Environment(), solver, winch, kite_mass=10.0)
    outputs = tether.initialize(kite_position=(0.0, 0.0, -5.51), winch_force=170.0)
    for _ in range(300):
        outputs = tether.step(0.01, winch_force=400.0)
    assert outputs.tether_length == pytest.approx(5.0 + 3 * MIN_SEGMENT_LENGTH, rel=1e-9)
    assert outputs.winch_speed == 0.0
    assert outputs.kite_end_mass == pytest.approx(0.25 * line_density(upper) * 5.0, rel=1e-12)
