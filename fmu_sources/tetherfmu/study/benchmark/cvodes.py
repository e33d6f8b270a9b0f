"""Peer: the same equations in CasADi, integrated by CVODES (BDF) with the exact sparse Jacobian.

The equations are those of docs/theory.md, "One segment" and "The chain", for a uniform tether, uniform wind and density. The
unknown is y = (positions, velocities) of the nodes that move freely.
"""

import shutil

import casadi
import numpy as np

from tetherfmu.kernels.algebra.vectors import along
from tetherfmu.kernels.chain import segment
from tetherfmu.kernels.communication.driven_end import curve, estimated_acceleration
from tetherfmu.runtime import layout as at
from tetherfmu.study.measuring.reference import free_state, right_hand_side
from tetherfmu.study.scenes.standard import STEP, inputs_of, tether_at_start

if hasattr(casadi.GlobalOptions, "setNumpyMode"):  # from CasADi 3.8 on
    casadi.GlobalOptions.setNumpyMode(1)  # numpy functions of symbols give symbols
LINEAR_SOLVER = "csparse"  # the fastest of CasADi's for these scenes
RANDOM_STATES = 20


def half_drag(length, e, velocity, scene):
    """Half drag of a segment [N]: F = 1/4 rho cd d l |w| w."""
    tether, air = scene.tether, scene.environment
    relative = casadi.DM(scene.wind) - velocity
    w = relative - casadi.dot(relative, e) * e
    speed = casadi.sqrt(casadi.dot(w, w) + segment.STILLEST)
    return 0.25 * air.air_density * tether.drag_coefficient * tether.diameter * length * speed * w


def segment_forces(x_p, x_q, v_p, v_q, rest, rest_rate, scene):
    """Tension vector T e and half drag F of a segment [N]."""
    tether = scene.tether
    r, u = x_q - x_p, v_q - v_p
    length = casadi.sqrt(casadi.dot(r, r))
    e = r / length
    taut = length > rest
    k = tether.axial_stiffness / rest * casadi.if_else(taut, 1.0, tether.slack_stiffness_ratio)
    c = tether.axial_damping / rest * casadi.if_else(taut, 1.0, tether.slack_damping_ratio)
    tension = k * (length - rest) + c * (casadi.dot(e, u) - length / rest * rest_rate)
    return tension * e, half_drag(length, e, 0.5 * (v_p + v_q), scene)


def slope(scene, time, y, kite, kite_velocity):
    """dy/dt, symbolic; `kite` and `kite_velocity` are expressions, unused if the kite end is free."""
    tether = scene.tether
    n = tether.segments
    free = n if scene.kite_is_free else n - 1
    x = [casadi.DM.zeros(3), *(y[3 * i : 3 * i + 3] for i in range(free))]
    v = [casadi.DM.zeros(3), *(y[3 * (free + i) : 3 * (free + i) + 3] for i in range(free))]
    if not scene.kite_is_free:
        x.append(kite)
        v.append(kite_velocity)
    rest = (tether.initial_length + scene.reel_out_speed * time) / n
    half_mass = 0.5 * tether.density * np.pi * tether.diameter**2 / 4.0 * rest
    weight = casadi.DM([0.0, 0.0, -scene.environment.gravity])
    force = [casadi.SX.zeros(3) for _ in range(n + 1)]
    mass = [0.0] * (n + 1)
    for s in range(n):
        pull, drag = segment_forces(x[s], x[s + 1], v[s], v[s + 1], rest, scene.reel_out_speed / n, scene)
        force[s] += pull + drag
        force[s + 1] += drag - pull
        mass[s] += half_mass
        mass[s + 1] += half_mass
    return casadi.vertcat(y[3 * free :], *(force[i] / mass[i] + weight for i in range(1, free + 1)))


def equations(scene, exact_path):
    """Symbolic equations: dict for `casadi.integrator`.

    exact_path : the kite follows the formula of its path; otherwise a cubic x0 + v0 t + c2 t^2 + c3 t^3, its 12 coefficients
    being the parameters p.
    """
    free = scene.tether.segments if scene.kite_is_free else scene.tether.segments - 1
    time, y, p = casadi.SX.sym("t"), casadi.SX.sym("y", 6 * free), casadi.SX.sym("p", 0 if exact_path else 12)
    if scene.kite_is_free:
        kite, velocity = None, None
    elif exact_path:
        kite = casadi.vertcat(*scene.flight.kite(time))
        velocity = casadi.jacobian(kite, time)
    else:
        x0, v0, c2, c3 = (p[k : k + 3] for k in (0, 3, 6, 9))
        kite = x0 + time * (v0 + time * (c2 + time * c3))
        velocity = v0 + time * (2.0 * c2 + 3.0 * time * c3)
    return {"t": time, "x": y, "p": p, "ode": slope(scene, time, y, kite, velocity)}


def compiler():
    """A C compiler that CasADi can use, or None."""
    return shutil.which("gcc") or shutil.which("cc")


def options(tolerance, compiled):
    """Options of the integrator; `compiled`: equations and Jacobian as compiled C instead of CasADi's interpreter."""
    common = {"abstol": tolerance, "reltol": tolerance, "linear_solver": LINEAR_SOLVER, "max_num_steps": 10**7}
    if compiled:
        common |= {"jit": True, "compiler": "shell", "jit_options": {"flags": "-O3", "compiler": compiler()}}
    return common


def whole_run(scene, tolerance, compiled=False):
    """One call for the whole run with the exact path, as a function without arguments; it returns what `exact` returns."""
    start = free_state(scene, tether_at_start(scene))
    integrator = casadi.integrator("run", "cvodes", equations(scene, True), 0.0, scene.times, options(tolerance, compiled))
    return lambda: np.array(integrator(x0=start)["xf"]).T[:, : len(start) // 2]


def kite_curves(scene):
    """Coefficients of the curves on which the tether leads its kite end, array (12, communication steps)."""
    inputs = inputs_of(scene, STEP)
    positions = [tuple(map(float, row)) for row in inputs[:, at.KITE_POSITION : at.KITE_POSITION + 3]]
    velocities = [tuple(map(float, row)) for row in inputs[:, at.KITE_VELOCITY : at.KITE_VELOCITY + 3]]
    end = (positions[0], velocities[0])
    columns = []
    for k, (position, velocity) in enumerate(zip(positions, velocities, strict=True)):
        last, last_step = (velocities[k - 1], STEP) if k else (velocity, 0.0)
        x0, v0, c2, c3 = curve(*end, position, velocity, estimated_acceleration(velocity, last, last_step, STEP), STEP)
        end = (
            along(along(along(x0, STEP, v0), STEP**2, c2), STEP**3, c3),
            along(along(v0, 2.0 * STEP, c2), 3.0 * STEP**2, c3),
        )
        columns.append([*x0, *v0, *c2, *c3])
    return np.transpose(columns)


def restarted_run(scene, tolerance, compiled=False):
    """CVODES started anew in every communication step, on the same sampled inputs as our tether; see `whole_run`.

    The steps between two outputs are chained inside CasADi, so that Python costs nothing.
    """
    start = free_state(scene, tether_at_start(scene))
    integrator = casadi.integrator("step", "cvodes", equations(scene, False), 0.0, STEP, options(tolerance, compiled))
    chunk = round(scene.every / STEP)
    chained = integrator.mapaccum(chunk)
    curves = kite_curves(scene)

    def run():
        y = start
        rows = [start[: len(start) // 2]]
        for k in range(0, curves.shape[1], chunk):
            y = np.array(chained(x0=y, p=curves[:, k : k + chunk])["xf"])[:, -1]
            rows.append(y[: len(start) // 2])
        return np.array(rows)

    return run


def largest_difference(scene):
    """Largest difference between CasADi's and our dy/dt at random states, relative to the largest dy/dt [-]."""
    model = tether_at_start(scene)
    ours = right_hand_side(scene)
    symbols = equations(scene, True)
    theirs = casadi.Function("slope", [symbols["t"], symbols["x"]], [symbols["ode"]])
    start = free_state(scene, model)
    random = np.random.default_rng(1)
    worst = 0.0
    for _ in range(RANDOM_STATES):
        time = random.uniform(0.0, scene.duration)
        y = start + random.standard_normal(len(start))
        expected = ours(time, y)
        worst = max(worst, np.abs(np.array(theirs(time, y)).ravel() - expected).max() / np.abs(expected).max())
    return float(worst)
