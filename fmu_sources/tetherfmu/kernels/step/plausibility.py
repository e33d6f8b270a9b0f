"""Implausible behaviour is noted in the state, once since the start; it has no other effect.

    stretch        max l/l0 of the segments
    acceleration   2 |x1 - x0 - v0 h|/(h H)   of the end in a step, from its start (x0, v0) to its arrival x1: the
                   mean if H = h; in a short step after a long one the end still corrects the error of H, the long one
    speed          |v1| of the end
    slack          l < l0 of a segment with EA above `limits.STIFF`, moved by the adaptive solver
    hanging deep   ground_height - z of the lowest node, without ground contact, while both ends are above the ground
    under ground   ground_height - z of a driven end, with ground contact
    damping        E A h of backward Euler with a fixed step h, if it is above a tenth of the axial damping
    unconverged    h of a fixed step that ended before its iteration converged
    unresolved     h of the fixed steps of a communication step that the adaptive solver has abandoned
    contradiction  |sum r| / sum max(|d|, |m h|),   d = p - p_last,   r = d - m h,   m = v_last + theta (v - v_last)
    slack winch    W of a force-controlled winch with mass that reels in, if d < 0.99 L and T < 0.1 (W - F)
    jump           distance between an initialized end, or the length that a winch follows, and its start in the first step
    fast winch     |u| of the unstretched length, now or as the mean of a step
    pressing       largest -T of a slack segment, if it is more than the weight of the tether
    long           a communication step
    no effect      an input or a parameter that is set and is not read
    too long       L - d of a length-controlled winch, above 5 % of d and above `NEARBY`; d: distance of the ends

The contradiction check compares the input positions p with the input velocities: m is the mean velocity
between the last two that explains the displacement d best (0 <= theta <= 1; so a velocity jump is no contradiction). The
sums continue until the lower one exceeds `JUDGED_WAY`; then they are evaluated and restarted. Two consecutive sums must
contradict: a position jump does not, it is visible in the acceleration. Position noise does not accumulate in the upper
sum.

Too short a length is a stretch. Too long a length is possible, and is checked only if it is an input: it
is then mostly a wrong unit or an offset.

Limits: runtime/plausibility.py. Theory: docs/models/theory.md, "Plausibility".
"""

from math import sqrt

from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plausibility as limits

from ..arrays import positions_and_velocities
from ..compilation import PARTS, kernel
from ..equations import segment, winch
from ..equations.boundary import are_derived, distance_of_ends, spring_at_ground
from ..equations.ground import has_ground
from ..equations.properties import chain_of, holds, property_of, rest_length
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, dot, get, put_at, scale, sub, vector_at
from ..notes import note

# for each end: whether it is free (parameters); its last inputs and its sums (state); its warnings
OF_GROUND = (
    *(at.GROUND_IS_FREE, at.LAST_GROUND_POSITION, at.LAST_GROUND_VELOCITY, at.CORRECTIONS_LEFT, at.GROUND_RESIDUE),
    *(limits.GROUND_ACCELERATION, limits.GROUND_RESIDUE, limits.GROUND_JUMP),
)
OF_KITE = (
    *(at.KITE_IS_FREE, at.LAST_KITE_POSITION, at.LAST_KITE_VELOCITY, at.CORRECTIONS_LEFT + 1, at.KITE_RESIDUE),
    *(limits.KITE_ACCELERATION, limits.KITE_RESIDUE, limits.KITE_JUMP),
)
WAY, SQUARE_BEFORE = 3, 4  # places behind the sum of r: sum of distances [m]; divisor of the last check, squared


@kernel
def note_shape(n, parameters, state):
    """Note the largest stretch l/l0, if too large, the speeds of the ends and the length in the state (modified)."""
    x, v = positions_and_velocities(n, state)
    chain = chain_of(n, parameters, state)
    largest = limits.LARGEST_STRETCH**2
    start = get(x, 0)
    for s in range(n):
        end, rest = get(x, s + 1), rest_length(chain, s)
        r = sub(end, start)
        if dot(r, r) > largest * rest * rest and holds(chain, s):
            largest = dot(r, r) / (rest * rest)
        start = end
    note(state, limits.STRETCH, largest, limits.LARGEST_STRETCH)
    ground_velocity, kite_velocity = get(v, 0), get(v, n)
    note(state, limits.GROUND_SPEED, dot(ground_velocity, ground_velocity), limits.FASTEST)
    note(state, limits.KITE_SPEED, dot(kite_velocity, kite_velocity), limits.FASTEST)
    note_length(n, parameters, state)
    note_ground(n, parameters, state)


@kernel
def note_ground(n, parameters, state):
    """Note a tether that hangs below a ground without contact, or a driven end below a ground with contact [m].

    In the state (modified).
    """
    x, _ = positions_and_velocities(n, state)
    height = parameters[at.GROUND_HEIGHT]
    ground_end, kite = height - get(x, 0)[2], height - get(x, n)[2]  # depths
    if has_ground(parameters):
        deepest = max(
            0.0 if parameters[at.GROUND_IS_FREE] != 0.0 else ground_end, 0.0 if parameters[at.KITE_IS_FREE] != 0.0 else kite
        )
        note(state, limits.END_UNDER_GROUND, max(0.0, deepest) ** 2, limits.UNDER)
    elif max(ground_end, kite) <= 0.0:
        deepest = 0.0
        for i in range(1, n):
            deepest = max(deepest, height - get(x, i)[2])
        note(state, limits.GROUND_IGNORED, deepest * deepest, limits.SHALLOW * state[at.LENGTH])


@kernel
def note_length(n, parameters, state):
    """Note the excess of the winch length input over the distance of the ends [m] in the state (modified)."""
    if winch.follows_length(parameters):
        distance = distance_of_ends(n, state)
        excess = max(0.0, state[at.LENGTH] - distance)
        note(state, limits.WINCH_TOO_LONG, excess * excess, max(limits.LARGEST_EXCESS * distance, limits.NEARBY))


@kernel
def note_slack_winch(n, parameters, state):
    """Note the force [N] of a winch with mass that reels in a slack tether with little force, in the state (modified)."""
    if winch.follows_force(parameters) and parameters[at.WINCH_MASS] > 0.0 and state[at.REELING] < 0.0:
        force = state[at.LAST_WINCH_FORCE]
        drive = force - parameters[at.WINCH_FRICTION]
        is_slack = distance_of_ends(n, state) < limits.SLACK * state[at.LENGTH]
        if parameters[at.HELD_BY] != 0.0:  # by a drum that other lines may share
            is_slack = is_slack and -parameters[at.WINCH_MASS] * state[at.DRUM_ACCELERATION] > 0.5 * drive
        if is_slack and max(0.0, spring_at_ground(n, parameters, state)) < limits.LEAST_RESISTANCE * drive:
            note(state, limits.WINCH_REELS_IN_SLACK, force * force, 0.0)


@kernel
def note_stiff_and_slack(chain, x, state):
    """Note the axial stiffness [N] of a segment above `limits.STIFF` that is slack at x [m] in the state (modified)."""
    for s in range(chain.n):
        stiffness = property_of(chain, s, at.STIFFNESS)
        if stiffness > limits.STIFF:
            r, rest = sub(get(x, s + 1), get(x, s)), rest_length(chain, s)
            if dot(r, r) < rest * rest:
                note(state, limits.STIFF_AND_SLACK, stiffness * stiffness, limits.STIFF)


@kernel
def note_damping_of_steps(chain, parameters, state):
    """Note E A h [N s] of backward Euler with a fixed step h above a tenth of the damping in the state (modified)."""
    h = parameters[at.FIXED_STEP]
    if parameters[at.FIXED_STEP_METHOD] == at.BACKWARD_EULER:
        largest = 0.0
        for s in range(chain.n):
            added = h * property_of(chain, s, at.STIFFNESS)
            if added > limits.LARGEST_PART_OF_DAMPING * property_of(chain, s, at.DAMPING):
                largest = max(largest, added)
        note(state, limits.FIXED_STEP_DAMPS, largest * largest, 0.0)


@kernel
def note_unconverged(count, h, state):
    """Note a fixed step [s] in the state (modified), if `count` of them ended before their iteration converged."""
    if count > 0.0:
        note(state, limits.FIXED_STEP_UNCONVERGED, h**2, 0.0)


@kernel
def note_acceleration(position, velocity, reached, step, time, kind, state):
    """Note the acceleration of an end in the state (modified): in a step [s] from a motion [m, m/s] to a position [m].

    time : correction time to its prescribed motion, at least the step [s].
    """
    acceleration = scale(2.0 / (step * time), add_scaled(sub(reached, position), -step, velocity))
    note(state, kind, dot(acceleration, acceleration), limits.LARGEST_ACCELERATION)


@kernel
def unexplained(way, last_velocity, velocity, step):
    """Part r [m] of a displacement d [m] in a step [s] that no velocity [m/s] between the last and the present explains."""
    first = scale(step, last_velocity)
    change = sub(scale(step, velocity), first)
    square = dot(change, change)
    part = 0.0
    if square > 0.0:
        part = min(1.0, max(0.0, dot(sub(way, first), change) / square))
    return sub(way, add_scaled(first, part, change))


@kernel
def note_contradiction(way, last_velocity, velocity, step, place, kind, state):
    """Update the sums of an end in the state (modified), and evaluate them when they are complete.

    way, step : since its last input [m, s].  last_velocity, velocity : inputs of both [m/s].  place : of its sums,
    `layout.KITE_RESIDUE`, ...
    """
    r = unexplained(way, last_velocity, velocity, step)
    explained = sub(way, r)
    total = add(vector_at(state, place), r)
    longer = state[place + WAY] + sqrt(max(dot(way, way), dot(explained, explained)))
    if longer > limits.JUDGED_WAY:
        square = dot(total, total) / (longer * longer)
        note(state, kind, min(square, state[place + SQUARE_BEFORE]), limits.LARGEST_RESIDUE)
        state[place + SQUARE_BEFORE] = square
        total, longer = ZERO_VECTOR, 0.0
    put_at(state, place, total)
    state[place + WAY] = longer


@kernel
def note_end(n, i, places, parameters, before, state):
    """Note implausible motion of an end in the state (modified): node i, `OF_GROUND` or `OF_KITE`."""
    is_free, position, velocity, left, sums, acceleration, residue, _ = places
    if parameters[is_free] == 0.0:
        x, v = positions_and_velocities(n, before)
        reached, _ = positions_and_velocities(n, state)
        step = state[at.LAST_STEP]
        note_acceleration(get(x, i), get(v, i), get(reached, i), step, step + state[left], acceleration, state)
        if not are_derived(parameters):
            way = sub(vector_at(state, position), vector_at(before, position))
            last, now = vector_at(before, velocity), vector_at(state, velocity)
            note_contradiction(way, last, now, before[at.LAST_STEP], sums, residue, state)


@kernel
def note_jump(n, i, places, parameters, before, state):
    """Note in the state (modified) the distance between an initialized end and its start in the first step [m].

    A distance that its velocity explains within a step does not count. Other arguments as for `note_end`.
    """
    is_free, position, velocity, _, _, _, _, jump = places
    if parameters[is_free] == 0.0:
        x, _ = positions_and_velocities(n, before)
        way = sub(vector_at(state, position), get(x, i))
        off = unexplained(way, ZERO_VECTOR, vector_at(state, velocity), state[at.LAST_STEP])
        note(state, jump, dot(off, off), limits.LARGEST_JUMP * before[at.LENGTH])


@kernel
def note_jump_of_length(parameters, before, state):
    """`note_jump` for the length that a winch follows, over all portions; 0 stands for `initial_length`."""
    if winch.follows_length(parameters) and state[at.LAST_WINCH_LENGTH] != 0.0:
        first = before[at.LAST_WINCH_LENGTH] if before[at.LAST_WINCH_LENGTH] != 0.0 else parameters[at.INITIAL_LENGTH]
        explained = abs(before[at.REELING]) * state[at.LAST_STEP]
        off = max(0.0, abs(state[at.LAST_WINCH_LENGTH] - first) - explained)
        note(state, limits.LENGTH_JUMP, off * off, limits.LARGEST_JUMP * first)


@kernel
def note_winch_speed(before, state):
    """Note the speed of a winch [m/s], now or as the mean of a step, in the state (modified).

    Includes rope that continues over a sheave.
    """
    paid = state[at.LENGTH] - before[at.LENGTH] + state[at.PAYOUT] - before[at.PAYOUT]
    fastest = max(abs(paid) / state[at.LAST_STEP], abs(state[at.REELING] + state[at.SHEAVE_SPEED]))
    if not PARTS or state[at.RUN_OFF] == before[at.RUN_OFF]:
        note(state, limits.FAST_WINCH, fastest * fastest, limits.FASTEST_WINCH)


@kernel
def note_pressing(chain, x, v, has_waves, state):
    """Note the compression of a slack segment [N], if it exceeds the weight of the tether, in the state (modified).

    has_waves : whether dampers count, too, with the nodes at the velocities v [m/s].
    """
    if state[at.WARNED_VALUES + limits.SLACK_PRESSES] != 0.0:
        return
    weight, most = 0.0, 0.0
    for s in range(chain.n):
        r, rest = sub(get(x, s + 1), get(x, s)), rest_length(chain, s)
        weight += property_of(chain, s, at.LINE_DENSITY) * rest * limits.STANDARD_GRAVITY
        if dot(r, r) < rest * rest:
            length, e = segment.geometry(r)
            k, _ = segment.stiffness(chain, s, segment.SLACK, rest)
            tension = k * (length - rest)
            if has_waves:
                tension = segment.tension_of(chain, s, segment.BY_LENGTH, length, dot(e, sub(get(v, s + 1), get(v, s))))
            most = max(most, -tension)
    note(state, limits.SLACK_PRESSES, most * most, weight)


@kernel
def note_idle(state, kind, value):
    """Note an input or a parameter that is not 0 and has no effect, in the state (modified)."""
    note(state, kind, value * value, 0.0)


@kernel
def note_idle_inputs(parameters, inputs, state):
    """Note inputs that are set and have no effect in the state (modified).

    A reel-out speed that does not control the winch has an effect at the start; later, only its changes are noted. No input
    affects the winch of a broken line.
    """
    if parameters[at.WINCH_IS_BRAKED] != 0.0:
        return
    if not winch.follows_force(parameters):
        note_idle(state, limits.IDLE_WINCH_FORCE, inputs[at.WINCH_FORCE])
    if not winch.follows_length(parameters):
        note_idle(state, limits.IDLE_WINCH_LENGTH, inputs[at.WINCH_LENGTH])
    if parameters[at.WINCH_CONTROL] != at.WINCH_BY_SPEED and inputs[at.REEL_OUT_SPEED] != state[at.LAST_REEL_OUT_SPEED]:
        note_idle(state, limits.IDLE_REEL_OUT_SPEED, inputs[at.REEL_OUT_SPEED])
    if are_derived(parameters):
        kite, ground = vector_at(inputs, at.KITE_VELOCITY), vector_at(inputs, at.GROUND_VELOCITY)
        moving = dot(ground, ground) + (dot(kite, kite) if parameters[at.KITE_IS_FREE] == 0.0 else 0.0)
        note(state, limits.IDLE_VELOCITY, moving, 0.0)
    if parameters[at.WIND_POINTS] > 0.0:
        wind = vector_at(inputs, at.WIND_VELOCITY)
        note(state, limits.IDLE_WIND, dot(wind, wind), 0.0)


@kernel
def note_idle_parameters(parameters, state):
    """Note parameters of a drum that is not force-controlled, in the state (modified)."""
    if not winch.follows_force(parameters):
        is_stopped = parameters[at.LONGEST_LENGTH] != at.NO_STOP
        numbers = parameters[at.WINCH_MASS] + parameters[at.WINCH_DAMPING] + parameters[at.WINCH_FRICTION]
        is_set = numbers > 0.0 or is_stopped or parameters[at.WINCH_START] != at.WINCH_GIVEN
        note(state, limits.IDLE_DRUM, 1.0 if is_set else 0.0, 0.0)


@kernel
def note_step(n, parameters, before, state):
    """Note implausible behaviour in a communication step from the state `before` to the state (modified).

    Driven ends are checked from the second step on (with derived velocities from the fourth, as the third is the first with
    a motion): the first step begins at the initialized position, whose distance from the present input is noted.
    """
    note_shape(n, parameters, state)
    note_slack_winch(n, parameters, state)
    note_winch_speed(before, state)
    note(state, limits.LONG_STEP, state[at.LAST_STEP] ** 2, limits.LONGEST_USUAL_STEP)
    if before[at.LAST_STEP] <= 0.0:
        note_jump(n, 0, OF_GROUND, parameters, before, state)
        note_jump(n, n, OF_KITE, parameters, before, state)
        note_jump_of_length(parameters, before, state)
        return
    if are_derived(parameters) and before[at.CLOCK] <= before[at.PAST_TIMES] + before[at.PAST_TIMES + 1]:
        return
    note_end(n, 0, OF_GROUND, parameters, before, state)
    note_end(n, n, OF_KITE, parameters, before, state)
