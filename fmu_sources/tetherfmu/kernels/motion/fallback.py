"""Reasons to replace a fixed three-stage step by backward Euler, and a count of such steps.

Reasons: a drum comes to rest or to a stop; a stage does not converge; a node bounces off the ground; or a segment goes slack
or taut, a node touches down or lifts off, or the iteration is long, and the total energy grows by more than ends, winches,
wind and loads can have supplied. Steps that are too long for a stiff line skip the stages.
"""

from math import inf, pi, sqrt

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plausibility as limits
from tetherfmu.runtime.limits import STIFF

from ..arrays import copy
from ..compilation import kernel, view
from ..equations import segment
from ..equations.boundary import chain_during
from ..equations.free_points import is_at_point, load_at, point_at, points_of
from ..equations.ground import ground_of, has_ground
from ..equations.lines import conditions_of, lines_of, motion_of, segments_of
from ..equations.properties import rest_length, stiffest
from ..line import second_order
from ..line.backward_euler import WHOLE
from ..line.second_order import ROUNDING
from ..linear_algebra.vectors import dot, get, norm, put, scale, sub
from ..notes import note
from ..points.coordinates import has_own_drum
from ..points.guess import start
from ..points.net import mass_at
from ..points.room import (
    PASSED_NOW,
    SPEED_NOW,
    START_PASSED,
    Step,
    any_line,
    chain_reached,
    coordinate_at,
    count_of,
    has_rope,
    holder,
    is_held,
    moves,
    scratch_of,
    stages_of,
)
from . import turning

# reasons for a fallback: without trying stages, or after rejected stages; only the latter are reported
ASKED = 1
AT_STOP, ON_GROUND, HARD = limits.FALLBACK_AT_STOP, limits.FALLBACK_ON_GROUND, limits.FALLBACK_HARD
RESOLVED, WELL_RESOLVED = 1.0, 0.35  # limits of h times a line's axial frequency: for stages, for 1 % in force
RECENT_STEPS = 1000.0  # memory of the running mean of the share of backward Euler steps

# --- events in a step


@kernel
def is_any_on_ground(system):
    """Whether a free node is on or below the ground."""
    for k in range(lines_of(system)):
        conditions, (x, _) = conditions_of(system, k), motion_of(system, k)
        if has_ground(conditions.parameters):
            height = ground_of(conditions.parameters).height
            for i in range(conditions.first, conditions.last + 1):
                if x[3 * i + 2] <= height:
                    return True
    return False


@kernel
def lands_or_lifts_off(system, k):
    """Whether a free node of line k has touched down or lifted off since the start of the step."""
    conditions, old, (new, _) = conditions_of(system, k), stages_of(system, k).x, motion_of(system, k)
    if has_ground(conditions.parameters):
        height = ground_of(conditions.parameters).height
        for z in range(3 * conditions.first + 2, 3 * conditions.last + 3, 3):
            if (old[z] <= height) != (new[z] <= height):
                return True
    return False


@kernel
def least_swing(system, k):
    """Approximate square of the lowest axial frequency [1/s2] of line k at its stiffest; never above the true value.

    Stiffness over the mass of its nodes and free ends: lower if it swings against one driven end, higher between
    two.
    """
    conditions, mass, n = conditions_of(system, k), scratch_of(system, k).mass, segments_of(system, k)
    moving, ends = 0.0, 0
    for i in range(1, n):
        moving += mass[i]
    for end in range(2):
        if conditions.first <= n * end <= conditions.last:
            ends += 1
            moving += points_of(system).mass[point_at(system, k, end)] if is_at_point(system, k, end) else mass[n * end]
    if has_own_drum(system, k):
        moving += mass_at(system, holder(system, k, 0, 0)[0], k)
    ends += is_held(system, k, 0) + is_held(system, k, 1)
    chain = chain_during(conditions, 0.0)
    factor = pi**2 if ends == 0 else (1.0 if ends == 1 else 4.0)
    return factor * stiffest(chain) / (chain.length * moving) if moving > 0.0 else inf


@kernel
def is_stiff(system, k):
    """Whether line k moves and is as stiff as `limits.STIFF`."""
    return moves(system, k) and stiffest(chain_during(conditions_of(system, k), 0.0)) >= STIFF


is_any_stiff = any_line(is_stiff)


@kernel
def stiff_swing(system, h):
    """`least_swing` of the fastest line that is as stiff as `limits.STIFF`; 0 if there is none.

    h : of the fixed steps [s].  Writes masses into the scratch space.
    """
    if not is_any_stiff(system):
        return 0.0
    turning.attempt_whole_step(system, 0.0, h)
    start(system, Step(0.0, h, WHOLE, count_of(system) > 0))
    fastest = 0.0
    for k in range(lines_of(system)):
        if is_stiff(system, k):
            fastest = max(fastest, least_swing(system, k))
    return fastest


@view
def chain_then(system, k, time, which):
    """`Chain` of line k at a time [s], with the rope that coordinates have let in by then, one of their numbers."""
    if has_rope(system, k):
        return chain_reached(system, k, time, which)
    return chain_during(conditions_of(system, k), time)


@kernel
def crosses(system, start, end):
    """Whether a segment went slack or taut, or a node touched down or lifted off, since the start of the step; times [s]."""
    for k in range(lines_of(system)):
        if moves(system, k):
            old, (new, _), conditions = stages_of(system, k).x, motion_of(system, k), conditions_of(system, k)
            before, after = chain_then(system, k, start, START_PASSED), chain_then(system, k, end, PASSED_NOW)
            for s in range(conditions.n):
                beyond = segment.beyond_rest(sub(get(old, s + 1), get(old, s)), rest_length(before, s))
                if beyond * segment.beyond_rest(sub(get(new, s + 1), get(new, s)), rest_length(after, s)) < 0.0:
                    return True
            if lands_or_lifts_off(system, k):
                return True
    return False


@kernel
def bounces(system, h):
    """Whether a node that hits the ground in a three-stage step of h [s] leaves it faster than the contact law permits.

    A stage start extrapolates earlier accelerations, so also a strong upward impact.
    """
    for k in range(lines_of(system)):
        conditions, (_, v), w = conditions_of(system, k), motion_of(system, k), stages_of(system, k)
        if has_ground(conditions.parameters):
            ground = ground_of(conditions.parameters)
            for i in range(conditions.first, conditions.last + 1):
                z = 3 * i + 2
                if w.v[z] < 0.0 and w.x[z] + h * w.v[z] < ground.height and v[z] * ground.damping > 1.0:
                    return True
    return False


@kernel
def hard_at(system):
    """Reason to reject a step with too long an iteration or too much energy."""
    return ON_GROUND if is_any_on_ground(system) else HARD


# --- energy


@kernel
def energy_and_power_of_line(system, k, time, is_new):
    """Energy [J] and largest power [W] of line k with its sheave and its share (by mass) of the loads on points."""
    points, w, (x, v) = points_of(system), stages_of(system, k), motion_of(system, k)
    here, speed, conditions = x if is_new else w.x, v if is_new else w.v, conditions_of(system, k)
    of_rope, grown = 0.0, 0.0
    if has_rope(system, k):
        of_rope, grown = turning.energy_and_power(system, k, here, speed)
        chain = chain_reached(system, k, time, PASSED_NOW)
        energy, power = second_order.energy_and_power(conditions, chain, time, here, speed, w.chain.mass)
    else:
        chain = chain_during(conditions, time)
        energy, power = second_order.energy_and_power(conditions, chain, time, here, speed, w.chain.mass)
    for end in range(2):
        if is_at_point(system, k, end):
            point, node = point_at(system, k, end), segments_of(system, k) * end
            share = w.chain.mass[node] / points.mass[point]
            power += share * norm(load_at(system, point, time)) * norm(get(speed, node))
    return energy + of_rope, power + grown


@kernel
def energy_and_power(system, time, is_new):
    """Energy [J] and largest power [W] of all lines, points and coordinates, as in `second_order.energy_and_power`.

    is_new : at the state, else at the start of the step.
    """
    energy, power = turning.energy_of_drums(system), 0.0
    for k in range(lines_of(system)):
        if moves(system, k):
            own, given = energy_and_power_of_line(system, k, time, is_new)
            energy += own
            power += given
    return energy, power


@kernel
def unexplained(system, time, h):
    """Energy [J] after a step of h [s] at a time [s] beyond the earlier energy plus the supplied energy; 0 if below."""
    turning.go_to_start(system, time)
    before, power = energy_and_power(system, time, False)
    turning.come_back(system, time + h)
    after, later = energy_and_power(system, time + h, True)
    motors = turning.work_of_motors(system, time, h)
    rounding = ROUNDING * (abs(before) + abs(after) + abs(motors))
    return max(after - before - motors - h * (power + later) - rounding, 0.0)


@kernel
def save_start(system):
    """Save the motion of all lines as the start of a step (modified)."""
    for k in range(lines_of(system)):
        w, (x, v) = stages_of(system, k), motion_of(system, k)
        copy(x, w.x)
        copy(v, w.v)


@kernel
def moving_energy(system):
    """Kinetic energy [J] of free nodes and drums."""
    energy = turning.energy_of_drums(system)
    for k in range(lines_of(system)):
        conditions, (_, v), mass = conditions_of(system, k), motion_of(system, k), stages_of(system, k).chain.mass
        for i in range(conditions.first, conditions.last + 1):
            energy += 0.5 * mass[i] * dot(get(v, i), get(v, i))
    return energy


@kernel
def give_back(system, time, h):
    """Slow down all nodes and coordinates (modified) by the energy that an unconverged step of h [s] made from nothing."""
    gained = unexplained(system, time, h)
    if gained > 0.0:
        part = sqrt(max(1.0 - gained / moving_energy(system), 0.0))
        for k in range(lines_of(system)):
            conditions, (_, v) = conditions_of(system, k), motion_of(system, k)
            for i in range(conditions.first, conditions.last + 1):
                put(v, i, scale(part, get(v, i)))
        for j in range(count_of(system)):
            coordinate_at(system, j)[SPEED_NOW] *= part


# --- counts


@kernel
def count_fallback(memory, why):
    """Count a step in the state (modified), by backward Euler if there is a reason `why`; note if there are many."""
    fell_back = 0.0 if why == 0 else 1.0
    memory[at.FALLBACKS] += fell_back
    memory[at.RECENT_FALLBACKS] += (fell_back - memory[at.RECENT_FALLBACKS]) / RECENT_STEPS
    part = memory[at.RECENT_FALLBACKS]
    if why > ASKED:
        memory[at.REJECTIONS] += 1.0
        note(memory, why, part * part, limits.MOST_FALLBACKS)
