"""Races at equal achieved error: each solver at a ladder of tolerances, errors against the exact motion."""

from typing import NamedTuple

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.kernel_library import load
from tetherfmu.study.measuring.clock import interleaved
from tetherfmu.study.measuring.reference import error, exact, free_state
from tetherfmu.study.scenes.standard import STEP, inputs_of, tether_at_start

from .kernels import advance_all, checked

OURS, WHOLE, RESTARTED = "TetherDynamic", "CVODES, one call", "CVODES, restarted"
COMPILED = ", compiled C"
LADDERS = (
    (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8),
    (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9),
    (1e-4, 1e-6, 1e-8, 1e-11),
)


class Point(NamedTuple):
    """One solver at one tolerance in one scene."""

    scene: str
    segments: int
    solver: str
    tolerance: float
    error: float  # root mean square distance of the nodes from the exact motion [m]
    seconds: float  # for the whole run
    steps: int  # internal, accepted and rejected; 0 if not known


def our_run(folder, scene, step, tolerance, counters):
    """Our dynamic tether, kernels of the FMU's library, as a function that returns what `exact` returns.

    The internal steps of the last call are put into `counters` under the tolerance.
    """
    model = tether_at_start(scene, tolerance)
    advance = load(folder, "dynamic").advance
    start, state = model.get_state(), model.get_state()
    first = free_state(scene, model)[: 3 * (scene.tether.segments - (not scene.kite_is_free))]
    rows = np.tile(first, (len(scene.times), 1))
    inputs = inputs_of(scene, step)
    every = round(scene.every / step)

    def run():
        state[:] = start
        arrays = model.segments, model._parameters, inputs, step, state, model._work, every, rows
        checked(advance_all(advance, *arrays))
        counters[tolerance] = int(state[at.STEPS] + state[at.REJECTIONS])
        return rows

    return run


def ladders(quick, scene):
    """Tolerances of our tether, of CVODES in one call, of CVODES restarted."""
    ours, whole, restarted = LADDERS
    if quick:
        ours, whole, restarted = ours[::2], whole[::3], restarted[:1]
    return ours, whole, () if scene.kite_is_free else restarted


def race(folder, scene, peers, quick, compiled_too, repeats):
    """Points of all solvers in a scene.

    folder : with the library of the dynamic tether.  peers : the module `cvodes`, or None.  compiled_too : whether CVODES
    also gets its equations as compiled C.
    """
    step = scene.every if scene.kite_is_free else STEP
    ours, whole, restarted = ladders(quick, scene)
    expected = exact(scene)
    counters = {}
    jobs = {(OURS, tolerance): our_run(folder, scene, step, tolerance, counters) for tolerance in ours}
    if peers:
        kinds = ((False, ""), (True, COMPILED)) if peers.compiler() and compiled_too else ((False, ""),)
        for compiled, suffix in kinds:
            jobs |= {(WHOLE + suffix, tol): peers.whole_run(scene, tol, compiled) for tol in whole}
            jobs |= {(RESTARTED + suffix, tol): peers.restarted_run(scene, tol, compiled) for tol in restarted}
    times, results = interleaved(jobs, repeats)
    return [
        Point(
            scene.name,
            scene.tether.segments,
            solver,
            tolerance,
            error(results[solver, tolerance], expected),
            seconds,
            counters[tolerance] if solver == OURS else 0,
        )
        for (solver, tolerance), seconds in times.items()
    ]


def seconds_at(points, solver, wanted):
    """Time of a solver for a wanted error, between its points on logarithmic axes; None outside them.

    Points that a more exact one beats in time are left out.
    """
    mine = sorted(((p.error, p.seconds) for p in points if p.solver == solver), reverse=True)
    front = [(e, s) for k, (e, s) in enumerate(mine) if all(s <= later for _, later in mine[k + 1 :])]
    if not front or not front[-1][0] <= wanted:
        return None
    if wanted >= front[0][0]:  # the cheapest point is more exact than that
        return front[0][1]
    errors, seconds = np.log(front).T
    return float(np.exp(np.interp(np.log(wanted), errors[::-1], seconds[::-1])))


def equal_errors(points):
    """Rows (scene, segments, error, our seconds, dict of solver to seconds) at errors that our tether reaches."""
    rows = []
    for key in dict.fromkeys((p.scene, p.segments) for p in points):
        mine = [p for p in points if (p.scene, p.segments) == key]
        others = [name for name in dict.fromkeys(p.solver for p in mine) if name != OURS]
        reached = [p.error for p in mine if p.solver == OURS]
        if key[0] != "release":
            wanted = [min((p for p in mine if p.solver == OURS), key=lambda p: abs(p.tolerance - 1e-4)).error]
        else:
            wanted = [e for e in (1e-2, 1e-3, 1e-4, 1e-5, 1e-6) if min(reached) <= e]
        for each in wanted:
            rows.append((*key, each, seconds_at(mine, OURS, each), {n: seconds_at(mine, n, each) for n in others}))
    return rows
