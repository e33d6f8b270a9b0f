"""One flight of the stability map, and the verdict on it: from the flight of its refinement, and from what can be explained.

Many are judged in parallel; each verdict is kept in a file at once, whatever a point may do to its process.

The verdicts are explained on the page (`page.md.j2`). Also bounded: a point whose refinement is refused (error: none).
Hanging: a call took longer than `LONGEST_CALL` of the processor, or the process of the point was ended for taking too long.
Error: root mean square difference of both end forces over root mean square of the refined ones plus the weight.

Upper bound of the tension of a tether with damping and drag, whatever its motion:

    T_max = EA eps + Q + (EA Q^2/24)^(1/3) + AMPLIFICATION (Z V + D V/l0)
    Z = sqrt(EA mu),   V = U + sqrt(EA/mu) (eps + eps_slack),   Q = L (mu g + rho cd d U^2/2 + mu U^2/d)

eps is the largest strain of the chord (distance of the ends over unstretched length, minus 1; at least `ROUND_OFF`),
eps_slack that of a straight start shorter than the tether, times the root of the slack stiffness ratio. U adds the speeds
of ends, wind and reeling, and that of a fall over the length of the tether. Z V is the wave that an impact of speed V
sends along a taut line, D V/l0 the tension of the damper of a segment whose one node moves with V. AMPLIFICATION stands
for reflections and for the whip of a bend. Q is the load across the line: weight, drag and inertia of turning; its cubic
root is the tension of an elastic parabola between fixed ends. No node may be faster than AMPLIFICATION V.

A free kite of mass m gets no faster than

    U_k = |v_0| + 2 |v_reel| + wind + sqrt(2 a (L + d)),   a = (F + (m + mu L) g + rho cd d L wind^2/2)/m

and its eps is eps_0 + eps_slack + F_all/EA + U_k sqrt((m + mu L)/(EA L)): that of the start, of the force m a at rest, and
of its kinetic energy in the tether. No node may be deeper in the ground than

    AMPLIFICATION (s Q/(mu L g) + sqrt(V_n s sqrt(s/g)))

with V_n the bound of the speeds: at rest under Q instead of the weight, and after an impact, where a sqrt(s g)/2 = 1 is the
damping of the ground (kernels/equations/ground.py).
"""

from concurrent.futures import as_completed
from functools import partial
from math import sqrt
from pathlib import Path
from time import process_time
from typing import NamedTuple
from warnings import catch_warnings

import numpy as np
import pandas as pd
from numpy.linalg import norm
from pebble import ProcessExpired

from tetherfmu.python.models import TetherDynamicFree
from tetherfmu.python.results import Outputs
from tetherfmu.records.problems import StepRefused
from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plausibility, status
from tetherfmu.runtime.parameters import Environment, Tether
from tetherfmu.study.measuring.executors import progress_bar
from tetherfmu.study.measuring.runs import UNWARNED
from tetherfmu.study.measuring.start import MODELS
from tetherfmu.study.measuring.store import Store, digest, key

from .isolated import isolated
from .points import CALLS, FREE, MOST_REELED, MapPoint, ground_height, kite

AMPLIFICATION = 6.0
ROUND_OFF = 1e-9  # strain that the rounding of positions makes; the bounds of a tether at rest
# quantities of points and tethers
SAME = ("segments", "axial_stiffness", "axial_damping", "slack_stiffness_ratio", "gravity", "initial_shape")
DRUM = ("winch_mass", "winch_damping", "winch_friction")
GROUND = ("ground_friction", "ground_sink")
MOST_WORK = 300_000  # segments times internal steps, after which a flight ends
DEFAULT = Tether()
# drag per length over speed squared [N s2/m3]
DRAG_FACTOR = 0.5 * Environment().air_density * DEFAULT.drag_coefficient * DEFAULT.diameter
LINE_DENSITY = DEFAULT.mass_per_length  # [kg/m]
HELD, FORBIDDEN = ("converged", "bounded"), ("wrong", "crashed", "hanging")
VERDICTS = (*HELD, "refused", *FORBIDDEN)
CONVERGED = 0.01
LONGEST_CALL = 2.0  # [s]
REFUSALS = {code: name.lower().replace("_", " ") for name, code in vars(status).items() if isinstance(code, int)}


class Verdict(NamedTuple):
    """What came of a point."""

    verdict: str = ""  # a word of `VERDICTS`, or none yet
    error: float | None = None  # [-]
    refusal: str = ""  # its name
    calls: int = 0  # communication steps done, the start included
    tension_ratio: float = 0.0  # largest tension over its bound [-], infinite if a number is not finite
    speed_ratio: float = 0.0  # largest speed of a node over its bound [-], of dynamic tethers; infinite likewise
    depth_ratio: float = 0.0  # largest depth of a node in the ground over its bound [-], infinite likewise
    work: float = 0.0  # segments times internal steps
    longest: float = 0.0  # call [s]
    unresolved: bool = False  # whether the adaptive solver gave up a step, which was then done with fixed steps


RATIOS = ("tension_ratio", "speed_ratio", "depth_ratio")
COLUMNS = MapPoint._fields + Verdict._fields
ENDED = {TimeoutError: "hanging", ProcessExpired: "crashed"}  # the verdict on a point that ended its process so
MOST_SECONDS = 900.0  # for one point with its refinement, 90 calls of a second at most; beyond it the process is ended


def model_of(point, refinement):
    """The tether of a point; the refinement divides the fixed step, and the tolerance by 2.5 times its square."""
    name, quantities = point.variant.removesuffix("_fixed_step"), {name: getattr(point, name) for name in SAME}
    model = TetherDynamicFree if name == FREE else MODELS[name]
    tolerance = point.relative_tolerance / (1.0 if refinement == 1 else 2.5 * refinement**2)
    if point.control == at.WINCH_BY_FORCE:
        quantities |= {name: getattr(point, name) for name in DRUM}
    if point.ground:
        quantities |= {name: getattr(point, name) for name in GROUND}
        quantities |= {"ground_contact": at.FLAT, "ground_height": ground_height(point)}
    if point.kite_is_free:
        quantities["kite_mass"] = point.kite_mass
    refined = {"relative_tolerance": tolerance, "fixed_step": point.fixed_step / refinement}
    return model(initial_length=point.length, shape_points=2, winch_control=point.control, **quantities, **refined)


def winch_input(point, start, time):
    """Input of the winch of a point at a time [s], by its name.

    start : tension at the ground at the start [N], 0 before it.
    """
    if point.control == at.WINCH_BY_FORCE:
        return {"winch_force": force_of(point, start)}
    if point.control == at.WINCH_BY_LENGTH:
        return {"winch_length": point.length + point.reel_out_speed * time}
    return {}


def load_of(point):
    """Force on a free kite [N], array (3,), along the tether at the start."""
    position, _ = kite(point, 0.0)
    weight = (point.kite_mass + LINE_DENSITY * point.length) * point.gravity
    return point.load_ratio * weight * position / norm(position)


def force_of(point, start):
    """Input `winch_force` [N], from the tension at the start [N]: no tether pulls much less than its weight."""
    return point.force_ratio * (max(start, 0.0) + LINE_DENSITY * point.length * point.gravity + 1.0)


def strain_and_speed(flown, step):
    """Largest strain of the chord [-] and speed of the kite end [m/s], halfway between calls too, a `step` [s] apart.

    flown : `Outputs` of arrays (calls, ...).
    """
    positions, velocities, lengths = flown.kite_position, flown.kite_velocity, flown.tether_length
    halfway = 0.5 * (positions[1:] + positions[:-1]) + 0.125 * step * (velocities[:-1] - velocities[1:])
    chords = np.concatenate([norm(positions, axis=1) / lengths, norm(halfway, axis=1) / lengths[1:]])
    speeds = np.concatenate([norm(velocities, axis=1), norm(np.diff(positions, axis=0), axis=1) / step])
    return max(ROUND_OFF, chords.max() - 1.0), speeds.max()


def start_strain(point):
    """eps_slack [-]: of a tether that starts straight, as one of a single segment does whatever its shape."""
    if point.initial_shape != at.STRAIGHT and point.segments > 1:
        return 0.0
    return sqrt(point.slack_stiffness_ratio) * max(0.0, point.slack / (1.0 + point.slack))


def free_strain_and_speed(point):
    """Bounds of `strain_and_speed` of a free kite; see the head of this file."""
    mass, length = point.kite_mass, point.length
    whole = mass + LINE_DENSITY * length
    force = norm(load_of(point)) + whole * point.gravity + DRAG_FACTOR * length * point.wind**2
    way = length * (1.0 + MOST_REELED) + point.distance
    speed = norm(kite(point, 0.0)[1]) + 2.0 * abs(point.reel_out_speed) + point.wind + sqrt(2.0 * force / mass * way)
    strain = max(0.0, point.distance / length - 1.0) + force / point.axial_stiffness
    strain += start_strain(point)
    return strain + speed * sqrt(whole / (point.axial_stiffness * length * (1.0 - MOST_REELED))), speed


def load_across(point, speed):
    """Q [N] of a tether that moves through air at rest with a speed [m/s]; see the head of this file."""
    inertia = LINE_DENSITY * speed**2 / (point.distance * (1.0 - MOST_REELED))
    load = LINE_DENSITY * point.gravity + DRAG_FACTOR * speed**2 + inertia
    return point.length * (1.0 + MOST_REELED) * load


def deepest(point, speed):
    """Depth [m] below the ground that no node may exceed; speed : the bound of that of a node [m/s]."""
    sink, weight = point.ground_sink, LINE_DENSITY * point.gravity * point.length
    return AMPLIFICATION * (
        sink * load_across(point, speed / AMPLIFICATION) / weight + sqrt(speed * sink * sqrt(sink / point.gravity))
    )


def bounds(point, strain, end_speed, reeled=0.0, force=0.0):
    """Largest tension [N] and speed of a node [m/s] that the motion of the ends explains; see the head of this file.

    reeled : largest reel-out speed of a winch that is controlled by force (0 of another), at the calls [m/s].
    """
    wave_speed = sqrt(point.axial_stiffness / LINE_DENSITY)
    fall = sqrt(2.0 * point.gravity * (point.length + point.distance))
    impedance = sqrt(point.axial_stiffness * LINE_DENSITY)
    motion = end_speed + point.wind + abs(point.reel_out_speed) + fall + reeled + force / impedance
    speed = motion + wave_speed * strain
    speed += wave_speed * start_strain(point)
    damping = point.axial_damping if point.variant.startswith("dynamic") else 0.0
    impact = impedance + damping / point.segment_length
    load = load_across(point, motion)
    across = load + (point.axial_stiffness * load**2 / 24.0) ** (1.0 / 3.0)
    return point.axial_stiffness * strain + across + force + AMPLIFICATION * impact * speed, AMPLIFICATION * speed


def ratios(point, flown, states, lowest, step):
    """Largest tension, speed and depth of a node over their bounds [-], infinite if a number is not finite; see `Verdict`.

    flown : `Outputs` of arrays (calls, ...).  states : array (calls, size of the state).  lowest : height of the lowest node
    [m], array (calls,).  step : between calls [s].
    """
    if not all(np.isfinite(numbers).all() for numbers in (states, lowest, *flown)):
        return np.inf, np.inf, np.inf
    reeled = force = 0.0
    if point.control == at.WINCH_BY_FORCE:
        reeled, force = np.abs(flown.winch_speed).max(), force_of(point, flown.ground_tension[0])
    motion = free_strain_and_speed(point) if point.kite_is_free else strain_and_speed(flown, step)
    tension, speed = bounds(point, *motion, reeled, force)
    fastest = 0.0
    if point.variant.startswith("dynamic"):
        motions = states[:, at.STATE_HEADER : at.state_size(point.segments)]
        fastest = norm(motions.reshape(len(states), 2, -1, 3)[:, 1], axis=2).max()
    depth = (ground_height(point) - lowest.min()) / deepest(point, speed) if point.ground else 0.0
    return float(flown.max_tension.max() / tension), float(fastest / speed), max(0.0, float(depth))


def ends(point, call, step):
    """Inputs of the kite end of a point by name in a call, 0 of which is the start."""
    if point.kite_is_free and call:
        return {"kite_load": load_of(point)}
    position, velocity = kite(point, max(0, call - 1) * step)
    return {"kite_position": position, "kite_velocity": velocity}


def fly(point, refinement=1, calls=CALLS, most_work=MOST_WORK):
    """Fly a point; returns its `Verdict`, yet without word and error, and both end forces [N], array (calls, 6).

    refinement : divides the communication step too; see `model_of`.  calls : communication steps (of the unrefined flight).
    """
    step, model = point.step / refinement, model_of(point, refinement)
    wind = point.wind * np.array((np.cos(point.wind_azimuth), np.sin(point.wind_azimuth), 0.0))
    outputs, states, lowest, refusal, work, longest = [], [], [], "", 0.0, 0.0
    with catch_warnings(**UNWARNED):
        for k in range(calls * refinement + 1):
            inputs = {**ends(point, k, step), "wind_velocity": wind}
            started = process_time()
            try:
                call = partial(model.step, step) if k else model.initialize
                start = float(outputs[0].ground_tension) if k else 0.0
                inputs |= winch_input(point, start, max(0, k - 1) * step)
                if not k or point.control == at.WINCH_BY_SPEED:  # another winch only starts with it
                    inputs["reel_out_speed"] = point.reel_out_speed
                outputs.append(call(**inputs))
            except StepRefused as error:
                refusal = REFUSALS[error.status]
                break
            finally:
                longest = max(longest, process_time() - started)
            states.append(model.get_state())
            lowest.append(model.positions[:, 2].min())
            work = sum(model.counters.values()) * model.segments
            if work > most_work:
                break
    found = Verdict(refusal=refusal, calls=len(outputs), work=work, longest=longest)
    if not outputs:
        return found, np.zeros((0, 6))
    found = found._replace(unresolved=bool(plausibility.kinds(states[-1]) >> plausibility.UNRESOLVED & 1))
    flown = Outputs(*map(np.array, zip(*outputs, strict=True)))  # arrays (calls, ...)
    found_ratios = ratios(point, flown, np.array(states), np.array(lowest), step)
    forces = np.hstack([flown.ground_force, flown.kite_force])[::refinement]
    return found._replace(**dict(zip(RATIOS, found_ratios, strict=True))), forces


def difference(point, forces, refined):
    """Error of the forces of a flight [-] against the refined ones, inf beyond all numbers; None with the start alone.

    Two flights without any force have no error.
    """
    count = min(len(forces), len(refined))
    if count < 2:
        return None
    a, b = forces[:count], refined[:count]
    size = np.sqrt(np.mean(b**2)) + LINE_DENSITY * point.length * point.gravity
    error = np.sqrt(np.mean((a - b) ** 2))
    return float(np.nan_to_num(error / size, nan=np.inf)) if error else 0.0


def judge(point):
    """Fly a point, and its refinement where that makes sense; returns its `Verdict`."""
    (found, forces), error = fly(point), None
    if found.longest > LONGEST_CALL:
        verdict = "hanging"
    elif max(getattr(found, name) for name in RATIOS) > 1.0:
        verdict = "wrong"
    elif found.refusal:
        verdict = "refused"
    else:
        error = difference(point, forces, fly(point, refinement=2, calls=found.calls - 1, most_work=np.inf)[1])
        verdict = "converged" if error is not None and error <= CONVERGED else "bounded"
    return found._replace(verdict=verdict, error=error)


def table(lines):
    """Lines of a file as a DataFrame: a row for each point, columns of `MapPoint` and `Verdict`."""
    return pd.DataFrame(list(lines), columns=COLUMNS).astype({"error": float})


def read(path):
    """Table of the results in a file; empty where there is no file, without lines of another form."""
    return table(line for line in Store(path).points.values() if line.keys() == set(COLUMNS))


def key_of(point):
    """Name of the verdict on a point: what is judged by other sources is judged again."""
    return key(digest(Path(__file__).parent), *point)


def judge_all(points, path, processes=None, dask=None, *, judgement=judge, most_seconds=MOST_SECONDS, progress=progress_bar):
    """Judge the points that the file at `path` does not have yet, and append them; returns the table of all, in order.

    processes, dask : who works, as of `executor_of`.  judgement : function of a point, which gets `most_seconds` [s].
    progress : as `progress_bar`.
    """
    store, names = Store(path), list(map(key_of, points))
    missing = {name: point for name, point in zip(names, points, strict=True) if name not in store.points}
    with isolated(dask, processes) as begun:
        futures = {begun(judgement, point, most_seconds): name for name, point in missing.items()}
        for future in progress(as_completed(futures), len(futures), "points"):
            name, ended = futures[future], ENDED.get(type(future.exception()))
            verdict = Verdict(ended) if ended else future.result()
            store.add(name, {**missing[name]._asdict(), **verdict._asdict()})
    return table(store.points[name] for name in names)
