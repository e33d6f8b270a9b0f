"""Peer: the same equations in CasADi, integrated by CVODES (BDF) with the exact sparse Jacobian.

The equations are those of docs/models/theory.md, "One segment", "The chain" and "Rope that flows", for a uniform tether,
uniform wind and density, a constant reel-out speed and the strain_rate law. The unknown is y = (positions, velocities) of
the nodes that move freely.
"""

import shutil

import casadi
import numpy as np

from tetherfmu.kernels.equations import segment
from tetherfmu.kernels.equations.end_motion import curve, position_at, velocity_at
from tetherfmu.runtime.inputs import by_name

from .reference import free_state, right_hand_side
from .scenes import STEP, at_start

if hasattr(casadi.GlobalOptions, "setNumpyMode"):  # from CasADi 3.8 on
    casadi.GlobalOptions.setNumpyMode(1)  # numpy functions of symbols give symbols
LINEAR_SOLVER = "csparse"  # the fastest of CasADi's for these scenes
COMPILER = shutil.which("gcc") or shutil.which("cc")  # of C, that CasADi can use, or None
RANDOM_STATES = 20


def add_scaled(vectors, directions):
    """Scalar products of the columns of two (3, count) matrices, as three equal rows."""
    return casadi.repmat(casadi.sum1(vectors * directions), 3, 1)


def segment_forces(x, v, rest, rest_rate, scene):
    """Tension vectors T e and half drags F = 1/4 rho cd d l |w| w [N] of all segments, from the nodes; (3, segments)."""
    tether, air = scene.tether, scene.environment
    r, u = casadi.diff(x, 1, 1), casadi.diff(v, 1, 1)
    length = casadi.sqrt(add_scaled(r, r))
    e, taut = r / length, length > rest
    k = tether.axial_stiffness / rest * casadi.if_else(taut, 1.0, tether.slack_stiffness_ratio)
    c = tether.axial_damping / rest * casadi.if_else(taut, 1.0, tether.slack_damping_ratio)
    tension = k * (length - rest) + c * (add_scaled(e, u) - length / rest * rest_rate)
    relative = casadi.DM(scene.wind.velocity) - 0.5 * (v[:, :-1] + v[:, 1:])
    w = relative - add_scaled(relative, e) * e
    speed = casadi.sqrt(add_scaled(w, w) + segment.STILLEST)
    return tension * e, 0.25 * air.air_density * tether.drag_coefficient * tether.diameter * length * speed * w


def flow_forces(x, v, rest, scene):
    """Forces [N] of the rope that flows past the nodes: of all segments on their first and on their second nodes."""
    tether, speed = scene.tether, scene.reel_out_speed
    r, u = casadi.diff(x, 1, 1), casadi.diff(v, 1, 1)
    rates = speed * casadi.DM(1.0 - np.arange(tether.segments + 1) / tether.segments).T
    first, second = casadi.repmat(rates[:-1], 3, 1), casadi.repmat(rates[1:], 3, 1)
    coriolis, centrifugal = (first + second) * u, (first**2 + second**2) * r / rest
    return -0.5 * tether.mass_per_length * (coriolis + centrifugal), -0.5 * tether.mass_per_length * (coriolis - centrifugal)


def slope(scene, time, y, kite, kite_velocity):
    """dy/dt, symbolic; `kite` and `kite_velocity` are expressions, empty if the kite end is free."""
    tether, free = scene.tether, y.numel() // 6
    x, v = casadi.horzsplit(casadi.reshape(y, 3, 2 * free), free)
    x, v = casadi.horzcat(casadi.DM.zeros(3), x, kite), casadi.horzcat(casadi.DM.zeros(3), v, kite_velocity)
    rest = (tether.initial_length + scene.reel_out_speed * time) / tether.segments
    half_mass = 0.5 * tether.mass_per_length * rest
    pull, drag = segment_forces(x, v, rest, scene.reel_out_speed / tether.segments, scene)
    nothing = casadi.DM(3, 1)
    on_first, on_second = flow_forces(x, v, rest, scene)
    force = casadi.horzcat(pull + drag + on_first, nothing) + casadi.horzcat(nothing, drag - pull + on_second)
    mass = casadi.repmat(half_mass * casadi.horzcat(1.0, casadi.DM.ones(1, tether.segments - 1) * 2.0, 1.0), 3, 1)
    accelerations = (force / mass)[:, 1 : free + 1] + casadi.DM([0.0, 0.0, -scene.environment.gravity])
    return casadi.vertcat(y[3 * free :], casadi.vec(accelerations))


def equations(scene, exact_path):
    """Symbolic equations: dict for `casadi.integrator`.

    exact_path : the kite follows the formula of its path; otherwise a cubic x0 + v0 t + c2 t^2 + c3 t^3, its 12 coefficients
    being the parameters p.
    """
    free = scene.tether.segments if scene.end_is_free else scene.tether.segments - 1
    time, y, p = casadi.SX.sym("t"), casadi.SX.sym("y", 6 * free), casadi.SX.sym("p", 0 if exact_path else 12)
    kite = velocity = casadi.SX(3, 0)
    if exact_path and not scene.end_is_free:
        kite = casadi.vertcat(*scene.flight.kite(time))
        velocity = casadi.jacobian(kite, time)
    elif not scene.end_is_free:
        x0, v0, c2, c3 = casadi.vertsplit(p, 3)
        kite, velocity = x0 + time * (v0 + time * (c2 + time * c3)), v0 + time * (2.0 * c2 + 3.0 * time * c3)
    return {"t": time, "x": y, "p": p, "ode": slope(scene, time, y, kite, velocity)}


def integrator(scene, exact_path, times, tolerance, compiled):
    """CVODES; `compiled`: equations and Jacobian as compiled C instead of CasADi's interpreter."""
    options = {"abstol": tolerance, "reltol": tolerance, "linear_solver": LINEAR_SOLVER, "max_num_steps": 10**7}
    if compiled:
        options |= {"jit": True, "compiler": "shell", "jit_options": {"flags": "-O3", "compiler": COMPILER}}
    return casadi.integrator("run", "cvodes", equations(scene, exact_path), 0.0, times, options)


def whole_run(scene, tolerance, compiled=False):
    """One call for the whole run with the exact path, as a function without arguments; it returns what `exact` returns."""
    start = free_state(scene, at_start(scene))
    run = integrator(scene, True, scene.times, tolerance, compiled)
    return lambda: np.array(run(x0=start)["xf"]).T[:, : len(start) // 2]


def kite_curves(scene):
    """Coefficients of the curves on which the tether leads its kite end, array (12, communication steps)."""
    columns = by_name(scene.inputs(STEP))
    positions, velocities = columns["kite_position"], columns["kite_velocity"]
    accelerations = np.diff(velocities, axis=0, prepend=velocities[:1]) / STEP
    end, curves = (tuple(positions[0]), tuple(velocities[0])), []
    for motion in zip(*(map(tuple, each.tolist()) for each in (positions, velocities, accelerations)), strict=True):
        curves.append(curve(*end, *motion, STEP))
        end = position_at(curves[-1], STEP), velocity_at(curves[-1], STEP)
    return np.reshape(curves, (-1, 12)).T


def restarted_run(scene, tolerance, compiled=False):
    """CVODES started anew in every communication step, on the same sampled inputs as our tether; see `whole_run`.

    The steps between two outputs are chained inside CasADi, so that Python costs nothing.
    """
    start = free_state(scene, at_start(scene))
    chunk, curves = round(scene.every / STEP), kite_curves(scene)
    chained = integrator(scene, False, STEP, tolerance, compiled).mapaccum(chunk)

    def run():
        rows = [start]
        for k in range(0, curves.shape[1], chunk):
            rows.append(np.array(chained(x0=rows[-1], p=curves[:, k : k + chunk])["xf"])[:, -1])
        return np.array(rows)[:, : len(start) // 2]

    return run


def largest_difference(scene):
    """Largest difference between CasADi's and our dy/dt at random states, relative to the largest dy/dt [-]."""
    symbols, random, ours = equations(scene, True), np.random.default_rng(1), right_hand_side(scene)
    theirs = casadi.Function("slope", [symbols["t"], symbols["x"]], [symbols["ode"]])
    start, differences = free_state(scene, at_start(scene)), []
    for _ in range(RANDOM_STATES):
        state = random.uniform(0.0, scene.duration), start + random.standard_normal(len(start))
        expected = ours(*state)
        differences.append(np.abs(np.array(theirs(*state)).ravel() - expected).max() / np.abs(expected).max())
    return float(max(differences))
