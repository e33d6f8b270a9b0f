"""Why a fixed step of three stages is left for one of backward Euler, and how such steps are counted.

A drum comes to rest or to a stop in it; a stage does not converge; a node bounces off the ground; or a segment goes slack or
taut, a node touches down or lifts off, or the iteration is long, and the energy of all lines and points together grows by
more than ends, winches, wind and loads can have put in. Steps that are too long for a stiff line are not tried with stages.
"""

from math import inf, pi

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plausibility as limits
from tetherfmu.runtime.limits import STIFF

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
from ..linear_algebra.vectors import get, norm, sub
from ..notes import note
from ..points.coordinates import has_own_drum
from ..points.guess import start
from ..points.net import mass_at
from ..points.room import (
    PASSED_NOW,
    START_PASSED,
    Step,
    any_line,
    chain_reached,
    count_of,
    has_rope,
    holder,
    is_held,
    moves,
    scratch_of,
    stages_of,
)
from . import turning

# why a step is one of backward Euler: at once, or after stages that were left, which is what is noted
ASKED = 1
AT_STOP, ON_GROUND, HARD = limits.FALLBACK_AT_STOP, limits.FALLBACK_ON_GROUND, limits.FALLBACK_HARD
RESOLVED, WELL_RESOLVED = 1.0, 0.35  # h times the frequency of a stiff line along itself: by stages; to 1 % of the force
RECENT_STEPS = 1000.0  # of which it counts how many are of backward Euler, in a mean that forgets

# --- what happens in a step


@kernel
def is_any_on_ground(system):
    """Whether a node that moves freely is on the ground or below it."""
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
    """Whether a node of line k that moves freely came to the ground since the step was started, or left it."""
    conditions, old, (new, _) = conditions_of(system, k), stages_of(system, k).x, motion_of(system, k)
    if has_ground(conditions.parameters):
        height = ground_of(conditions.parameters).height
        for z in range(3 * conditions.first + 2, 3 * conditions.last + 3, 3):
            if (old[z] <= height) != (new[z] <= height):
                return True
    return False


@kernel
def least_swing(system, k):
    """Square of the lowest frequency [1/s2] with which line k swings along itself, at its stiffest; about, and not above it.

    Its stiffness over the mass of its nodes and its free ends: less where it swings against one end that is driven, more
    where between two.
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
    """The same of the line that swings fastest of those that are as stiff as `limits.STIFF`; 0 without one.

    h : of the fixed steps [s].  Masses stand in the scratch space afterwards.
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
    """`Chain` of line k at a time [s], with what coordinates have let in then, one of their numbers."""
    if has_rope(system, k):
        return chain_reached(system, k, time, which)
    return chain_during(conditions_of(system, k), time)


@kernel
def crosses(system, start, end):
    """Whether a segment went slack or taut, or a node to the ground or off, since the step was started; its times [s]."""
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
    """Whether a node that came to the ground in a step of h [s] by stages leaves it faster than the ground lets go of one.

    The start of a stage continues the accelerations of those before, and so a strong impact: upwards.
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
    """Why a step is left whose iteration or energy is not as it should be."""
    return ON_GROUND if is_any_on_ground(system) else HARD


# --- energy


@kernel
def energy_and_power_of_line(system, k, time, is_new):
    """Energy [J] and largest power [W] of line k with its sheave and its parts of the loads on points, by masses."""
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
    """Energy [J] and largest power [W] as in `second_order.energy_and_power`, of all lines, points and coordinates.

    is_new : whether of the state, else of that at the start of the step.
    """
    energy, power = turning.energy_of_drums(system), 0.0
    for k in range(lines_of(system)):
        if moves(system, k):
            own, given = energy_and_power_of_line(system, k, time, is_new)
            energy += own
            power += given
    return energy, power


@kernel
def is_explained(system, time, h):
    """Whether the energy after a step of h [s] at a time [s] is at most that before it and what was put in."""
    turning.go_to_start(system, time)
    before, power = energy_and_power(system, time, False)
    turning.come_back(system, time + h)
    after, later = energy_and_power(system, time + h, True)
    motors = turning.work_of_motors(system, time, h)
    rounding = ROUNDING * (abs(before) + abs(after) + abs(motors))
    return after - before - motors <= h * (power + later) + rounding


# --- how many


@kernel
def count_fallback(memory, why):
    """Count a step, done by backward Euler if there is a reason `why`, in the state (modified); note if they are many."""
    fell_back = 0.0 if why == 0 else 1.0
    memory[at.FALLBACKS] += fell_back
    memory[at.RECENT_FALLBACKS] += (fell_back - memory[at.RECENT_FALLBACKS]) / RECENT_STEPS
    part = memory[at.RECENT_FALLBACKS]
    if why > ASKED:
        memory[at.REJECTIONS] += 1.0
        note(memory, why, part * part, limits.MOST_FALLBACKS)
