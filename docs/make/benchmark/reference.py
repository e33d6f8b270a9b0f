"""The exact motion of a scene: DOP853 of scipy at a tolerance of 1e-11, with the exact path of the kite."""

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp

from tetherfmu.kernels.equations import assembly
from tetherfmu.kernels.equations.properties import chain_at
from tetherfmu.kernels.linear_algebra.both_ends import deinterleave, interleave, interleaved_size
from tetherfmu.libraries.ready import kernels
from tetherfmu.runtime.parameters import Solver
from tetherfmu.wiring.packing import pack_records

from .scenes import at_start

TOLERANCE = 1e-11


@njit(error_model="numpy")
def accelerations(n, x, v, length, reeling, wind, parameters, mass, force):
    """Node accelerations [m/s2] into `force` (modified); `mass` is modified."""
    chain = chain_at(n, parameters, length, reeling, wind)
    assembly.node_masses(chain, mass)
    pairs_x, pairs_v, pairs_force = np.zeros((3, interleaved_size(n)))
    interleave(n, x, pairs_x)
    interleave(n, v, pairs_v)
    assembly.node_forces(chain, np.zeros(n), pairs_x, pairs_v, mass, np.zeros(assembly.segments_size(n)), pairs_force)
    deinterleave(n, pairs_force, force)
    force /= np.repeat(mass, 3)


def free_state(scene, model):
    """Positions, then velocities of the nodes that move freely, one flat array."""
    last = None if scene.end_is_free else -1
    return np.concatenate([model.positions[1:last].ravel(), model.velocities[1:last].ravel()])


def right_hand_side(scene):
    """dy/dt as a function (t, y), of our kernels, without any of our solvers."""
    n, reeling, wind = scene.tether.segments, scene.reel_out_speed, scene.wind.velocity
    _, parameters = pack_records(kernels("dynamic"), (scene.tether,), scene.environment, Solver())
    parameters = np.array(parameters)
    x, v, force = np.zeros((3, 3 * (n + 1)))
    mass = np.zeros(n + 1)
    half = 3 * (n if scene.end_is_free else n - 1)

    def slope(t, y):
        x[3 : 3 + half], v[3 : 3 + half] = y[:half], y[half:]
        if not scene.end_is_free:
            x[-3:], v[-3:] = scene.flight.motion(t)[:2]
        length = scene.tether.initial_length + reeling * t
        accelerations(n, x, v, length, reeling, wind, parameters, mass, force)
        return np.concatenate([y[half:], force[3 : 3 + half]])

    return slope


def exact(scene, tolerance=TOLERANCE):
    """Positions of the free nodes at `scene.times`, array (times, 3 nodes)."""
    y, times = free_state(scene, at_start(scene)), scene.times
    tolerances = {"rtol": tolerance, "atol": 0.1 * tolerance}
    with np.errstate(invalid="ignore"):  # a trial step that is far too long
        done = solve_ivp(right_hand_side(scene), times[[0, -1]], y, "DOP853", times, **tolerances)
    if done.status != 0:
        raise RuntimeError(f"no reference for {scene.name}: {done.message}")
    return done.y.T[:, : len(y) // 2]


def error(positions, expected):
    """Root mean square of the distance of all nodes from where they belong, over all outputs [m]."""
    return float(np.sqrt(np.mean(np.sum((positions - expected).reshape(len(expected), -1, 3) ** 2, axis=-1))))
