"""Stable equilibrium of a chain between two given ends: the ladder of methods, numbered as in docs/models/numerics.md.

1. First guess: the hanging chain under the mean load (`first_guess.py`, `hanging_chain.py`).
2. Newton's method with the stiffnesses of the segments (`newton.py`).
3. Newton's method with their compliances (`compliance.py`).
4. Pseudo-transient continuation, with stiffnesses, then with compliances.
5. Steps 1 to 4 again with a lateral perturbation load, if they found a compressed chain (`compressed_chain.py`)
   or found nothing and the chain has no load.
6. Continuation of the loads, from smaller ones (`homotopy.py`).
7. Pseudo-transient continuation with tensions of either sign (`compressed_segments.py`).
8. Continuation of the stiffnesses, from smaller ones.
9. If the wind begins at z = 0: continuation of a layer of air in which it grows gradually.

Each method starts from the first guess, not from the failure of the last one. Steps 1 to 8 ignore the ground. If the
chain then hangs below the ground, the search continues from there on the ground (`lying_chain.py`), then by steps 7 and
9 with the ground, and if there is no solution with friction, without: the lying part then rests.

A search that has used up `BUDGET` ends before its next method.
"""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import NO_EQUILIBRIUM, OK

from ..arrays import positions_and_velocities
from ..compilation import kernel, view
from ..equations import air, assembly
from ..equations.ground import smooth, under, without_ground
from ..equations.properties import chain_of
from . import compressed_chain, compressed_segments, end_tensions, homotopy, lying_chain, newton
from .first_guess import axial_compliance, guess, is_loaded
from .rigid_body import Body, rigid_motion, rigid_velocity

# Segments times Newton iterations of a search. Among 24 000 successful searches in random flights of the stability map,
# without and with ground, the hardest needs 2.0e6: 7327 iterations with 272 segments. The method in progress at the limit
# may use another 16 000 iterations, which is about a second in all with 300 segments.
BUDGET = 5_000_000
LEVELS = (0.5, 0.25, 0.125)  # initial load levels of step 6
STRAINS = (1e-2, 1e-3, 1e-1)  # strain of the chain under the mean load, where step 8 begins
FOUND, COMPRESSED, NOTHING, UNLOADED = range(4)  # results of the first four steps


@kernel
def is_stable(body):
    """Whether the body in equilibrium is not a compressed chain."""
    return not compressed_chain.is_unstable(body.chain, body.x, compressed_chain.PARALLEL)


@kernel
def by_newton(body, perturbed, w):
    """Steps 1 to 4: their result, and the number of Newton iterations.

    perturbed : whether a lateral load is tried, too. Otherwise the first compressed chain ends the search.
    """
    iterations = 0
    load_stiffness = 0.0
    for pseudo_transient in (False, True):
        for kind in (newton.STIFFNESSES, newton.COMPLIANCES):
            load_stiffness = guess(body, perturbed, w)
            found, more = newton.relax(body, kind, pseudo_transient, load_stiffness, w)
            iterations += more
            if found and is_stable(body):
                return FOUND, iterations
            if found and not perturbed:
                return COMPRESSED, iterations
    return NOTHING if is_loaded(body.chain, load_stiffness) else UNLOADED, iterations


@kernel
def at_once(body, w):
    """Steps 1 to 5: a status (OK or NO_EQUILIBRIUM) and the number of Newton iterations."""
    assembly.node_masses(body.chain, w.mass)
    result, iterations = by_newton(body, False, w)
    if result in (COMPRESSED, UNLOADED):
        result, more = by_newton(body, True, w)
        iterations += more
    return OK if result == FOUND else NO_EQUILIBRIUM, iterations


@kernel
def by_loads(body, most, w):
    """Step 6: a status (OK or NO_EQUILIBRIUM) and the number of Newton iterations, about `most`."""
    iterations = 0
    for level in LEVELS:
        if iterations < most:
            status, more = at_once(homotopy.at_level(homotopy.LOADS, body, level, w), w)
            iterations += more
            if status == OK:
                found, more = homotopy.lead(homotopy.LOADS, body, level, 0.0, most - iterations, w)
                return OK if found and is_stable(body) else NO_EQUILIBRIUM, iterations + more
    return NO_EQUILIBRIUM, iterations


@kernel
def by_compressed_segments(body, w):
    """Step 7: a status (OK or NO_EQUILIBRIUM) and the number of Newton iterations."""
    assembly.node_masses(body.chain, w.mass)
    found, iterations = compressed_segments.find(body, guess(body, False, w), w)
    found = found and is_stable(body) and not lying_chain.is_compressed(body, w)
    return OK if found else NO_EQUILIBRIUM, iterations


@kernel
def by_stiffness(body, most, w):
    """Step 8: a status (OK or NO_EQUILIBRIUM) and the number of Newton iterations, about `most`."""
    load = guess(body, False, w)
    iterations = 0
    for strain in STRAINS:
        level = load * body.chain.length * axial_compliance(body.chain) / strain
        if level < 1.0 and iterations < most:
            status, more = at_once(homotopy.at_level(homotopy.STIFFNESS, body, level, w), w)
            iterations += more
            if status == OK:
                found, more = homotopy.lead(homotopy.STIFFNESS, body, level, load, most - iterations, w)
                iterations += more
                if found and is_stable(body):
                    return OK, iterations
    return NO_EQUILIBRIUM, iterations


@kernel
def by_layer(body, most, w):
    """Step 9: a status (OK or NO_EQUILIBRIUM) and the number of Newton iterations, about `most`."""
    level = min(1.0, homotopy.THINNEST * body.chain.n / body.chain.length)
    layered = homotopy.at_level(homotopy.LAYER, body, level, w)
    load = guess(layered, False, w)
    hanging = lying_chain.on(layered, without_ground())
    status, iterations = at_once(hanging, w)
    if status != OK:
        status, more = by_compressed_segments(hanging, w)
        iterations += more
    status, more = on_ground(layered, status == OK, w)
    iterations += more
    if status == OK:
        found, more = homotopy.lead(homotopy.LAYER, body, level, load, most - iterations, w)
        iterations += more
        status = OK if found and is_stable(body) else NO_EQUILIBRIUM
    return status, iterations


@kernel
def on_ground(body, hangs, w):
    """Continue from the result without ground in the body (modified): a status and the number of Newton iterations."""
    if body.ground.hardness == 0.0 or (hangs and lying_chain.deepest(body) == 0.0):
        return OK if hangs else NO_EQUILIBRIUM, 0
    found, iterations = lying_chain.find(body, hangs, w)
    return OK if found and is_stable(body) else NO_EQUILIBRIUM, iterations


@kernel
def in_the_air(body, most, w):
    """Stable equilibrium of the body without ground (positions and velocities of its inner nodes modified).

    Returns a status (OK or NO_EQUILIBRIUM) and the number of Newton iterations; beyond `most` of them no other step begins.
    """
    status, iterations = at_once(body, w)
    if status != OK:
        status, more = by_loads(body, most - iterations, w)
        iterations += more
    if status != OK and iterations < most:
        status, more = by_compressed_segments(body, w)
        iterations += more
    if status != OK and iterations < most:
        status, more = by_stiffness(body, most - iterations, w)
        iterations += more
    return status, iterations


@kernel
def by_ladder(body, most, w):
    """All steps, in the air and on the ground: a status (OK or NO_EQUILIBRIUM) and the number of Newton iterations.

    most : iterations beyond which no other step begins.
    """
    has_ground = body.ground.hardness > 0.0
    status, iterations = in_the_air(lying_chain.on(body, without_ground()), most, w)
    status, more = on_ground(body, status == OK, w)
    iterations += more
    if status != OK and iterations < most and has_ground:
        status, more = by_compressed_segments(body, w)
        iterations += more
    if status != OK and iterations < most and air.is_sheared(body.chain.parameters[at.WIND_PROFILE]):
        status, more = by_layer(body, most - iterations, w)
        iterations += more
    return status, iterations


@kernel
def find(body, w):
    """Stable equilibrium between the ends of the body (positions and velocities of its inner nodes modified).

    Without ground friction if there is no solution with it. Returns a status (OK or NO_EQUILIBRIUM) and the number of
    Newton iterations.
    """
    most = BUDGET // body.chain.n
    status, iterations = by_ladder(body, most, w)
    if status != OK and iterations < most and body.ground.hardness > 0.0 and body.ground.friction > 0.0:
        status, more = by_ladder(lying_chain.on(body, smooth(body.ground)), most - iterations, w)
        iterations += more
    rigid_velocity(body)
    return status, iterations


@kernel
def follow(body, w):
    """Stable equilibrium from nearby positions [m] and w.tension [N] (both modified): (found, iterations)."""
    assembly.node_masses(body.chain, w.mass)
    on_ground = body.ground.hardness > 0.0
    if on_ground:
        newton.keep(body, w)
    found, iterations = newton.relax(body, newton.STIFFNESSES, False, 0.0, w)
    if on_ground and not found:
        found, more = lying_chain.slowly(body, w)
        iterations += more
    return found and is_stable(body), iterations


@view
def body_of(n, parameters, state, x, v):
    """`Body` of node positions x [m] and velocities v [m/s] that turns about the ground end with the kite of a state."""
    spin, extension_rate = rigid_motion(n, x, v)
    return Body(chain_of(n, parameters, state), spin, extension_rate, x, v, under(parameters), x, False)


@kernel
def settle(n, parameters, state, warm, w):
    """Solve the equilibrium of the inner nodes of a state (modified) between its ends; returns a status.

    warm : whether the inner nodes and w.tension are close to it.
    """
    x, v = positions_and_velocities(n, state)
    body = body_of(n, parameters, state, x, v)
    if warm:
        found, iterations = follow(body, w)
        state[at.ITERATIONS] += iterations
        if found:
            end_tensions.store(body, state, w)
            return OK
    status, iterations = find(body, w)
    state[at.ITERATIONS] += iterations
    if status == OK:
        end_tensions.store(body, state, w)
    return status
