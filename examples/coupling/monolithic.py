"""How does a mass on tethers move, exactly? One set of equations for all of it, integrated by scipy. Helper of the examples.

A point mass (a kite, a knot) hangs on one or more legs (`Scene` in `ways_of_coupling.py`); each is a chain of lumped masses
and spring-dampers. Nothing is exchanged, so nothing is delayed: this is the reference of the ways of coupling.
The equations are those of docs/models/theory.md, "One segment" and "The chain", for uniform tethers in a uniform wind and
air, written anew in numpy.
"""

import numpy as np
from scipy.integrate import solve_ivp

from tetherfmu import TetherDynamic

TOLERANCE = 1e-9  # relative, of DOP853; absolute: a tenth of it, in m and m/s


def segment_forces(tether, x, v, rest, rest_rate, scene):
    """Tension vectors T e and half drags [N] of all segments of a leg, arrays (n, 3), by the nodes (n + 1, 3) [m, m/s].

    T = k (l - l0) + c (dl/dt - (l/l0) dl0/dt);  F = 1/4 rho cd d l |w| w;  rest, rest_rate : l0 [m], dl0/dt [m/s].
    """
    r, u = np.diff(x, axis=0), np.diff(v, axis=0)
    length = np.sqrt(np.sum(r * r, axis=1))
    e = r / length[:, None]
    taut = length > rest
    k = tether.axial_stiffness / rest * np.where(taut, 1.0, tether.slack_stiffness_ratio)
    c = tether.axial_damping / rest * np.where(taut, 1.0, tether.slack_damping_ratio)
    tension = k * (length - rest) + c * (np.sum(e * u, axis=1) - length / rest * rest_rate)
    w = scene.wind - 0.5 * (v[1:] + v[:-1])
    w -= np.sum(w * e, axis=1)[:, None] * e
    speed = np.sqrt(np.sum(w * w, axis=1))
    drag = 0.25 * scene.environment.air_density * tether.drag_coefficient * tether.diameter * length * speed
    return tension[:, None] * e, drag[:, None] * w


def leg_forces(leg, x, v, time, scene):
    """Forces on the nodes of a leg [N], with their weight, array (n + 1, 3), and the mass of half a segment [kg]."""
    n = leg.tether.segments
    rest = (leg.tether.initial_length + leg.reel_out_speed * time) / n
    pull, drag = segment_forces(leg.tether, x, v, rest, leg.reel_out_speed / n, scene)
    half, gravity = 0.5 * leg.tether.mass_per_length * rest, scene.environment.gravity
    force = np.zeros((n + 1, 3))
    force[:-1] += pull + drag
    force[1:] += drag - pull
    force[1:-1, 2] -= 2.0 * half * gravity
    force[[0, -1], 2] -= half * gravity
    return force, half


def motions(scene, y):
    """Positions and velocities of the nodes of each leg, arrays (n + 1, 3), from the state y: mass, then inner nodes."""
    (x_mass, v_mass), place = y[:6].reshape(2, 3), 6
    for leg in scene.legs:
        inner = leg.tether.segments - 1
        x, v = y[place : place + 6 * inner].reshape(2, inner, 3)
        place += 6 * inner
        yield np.vstack([leg.anchor, x, x_mass]), np.vstack([np.zeros(3), v, v_mass])


def slope(scene, time, y):
    """dy/dt of the state."""
    x_mass, v_mass = y[:6].reshape(2, 3)
    force = scene.load(x_mass, v_mass) - scene.mass * np.array([0.0, 0.0, scene.environment.gravity])
    mass, inner = scene.mass, []
    for leg, (x, v) in zip(scene.legs, motions(scene, y), strict=True):
        forces, half = leg_forces(leg, x, v, time, scene)
        force, mass = force + forces[-1], mass + half
        inner += [v[1:-1].ravel(), forces[1:-1].ravel() / (2.0 * half)]
    return np.concatenate([v_mass, force / mass, *inner])


def state_at_start(scene):
    """State y at rest: each leg in its static equilibrium between its anchor and the mass."""
    parts = [np.asarray(scene.position), np.zeros(3)]
    for leg in scene.legs:
        tether = TetherDynamic(leg.tether, scene.environment)
        tether.initialize(scene.position, ground_position=leg.anchor, wind_velocity=scene.wind)
        inner = tether.positions[1:-1].ravel()
        parts += [inner, np.zeros(inner.size)]
    return np.concatenate(parts)


def exact(scene, times, tolerance=TOLERANCE):
    """Force of each leg on the mass [N], array (times, legs, 3), and position of the mass [m], (times, 3), at times [s]."""
    done = solve_ivp(
        lambda time, y: slope(scene, time, y),
        (0.0, times[-1]),
        state_at_start(scene),
        "DOP853",
        times,
        rtol=tolerance,
        atol=0.1 * tolerance,
    )
    if done.status != 0:
        raise RuntimeError(f"the motion of the whole system was not found: {done.message}")
    forces = [
        [leg_forces(leg, x, v, time, scene)[0][-1] for leg, (x, v) in zip(scene.legs, motions(scene, y), strict=True)]
        for time, y in zip(times, done.y.T, strict=True)
    ]
    return np.array(forces), done.y[:3].T
