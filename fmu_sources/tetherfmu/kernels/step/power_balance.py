"""Energies of a chain and the powers that change them. Source: docs/models/theory.md, "Energy"."""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import OK

from ..arrays import copy, positions_and_velocities, shared_arrays
from ..compilation import PARTS, kernel
from ..equations import flow, motion, node_loads, segment
from ..equations.assembly import end_force, node_masses
from ..equations.boundary import wind_of
from ..equations.continuation import is_continued
from ..equations.drum import drum_of
from ..equations.properties import (
    chain_with_flow,
    growing_mass,
    growth_at,
    half_density,
    in_section,
    point_mass,
    rest_length,
    sees_reeling,
)
from ..equations.winch import follows_force
from ..flat_arrays import part
from ..linear_algebra.vectors import NEUTRAL, add, dot, get, put, scale, sub, vector_at

# fields of `python.energy.Energy` in order; then segment tensions [N], then node velocities [m/s]
KINETIC, ELASTIC, POTENTIAL, GROUND_POWER, KITE_POWER, WINCH, MATERIAL, WIND, DAMPING_LOSS, DRAG_LOSS = range(10)
DRUM, DRUM_POWER, MOTOR_POWER, FRICTION_LOSS, CONTACT_LOSS, SLIDING_LOSS, BREAKING, ENERGIES = range(10, 18)


@kernel
def size(n):
    """Length of the array that `balance` writes."""
    return ENERGIES + n + 3 * (n + 1)


@kernel
def balance(n, parameters, state, v, inputs, has_waves, energies, work):
    """Energies [J], powers [W], tensions [N] and velocities of a state into `energies` (modified), see `ENERGIES`; a status.

    v : node velocities [m/s].  inputs : reel-out speed, wind, load of a free kite end and winch force are used.
    has_waves : whether its nodes obey the equations of motion.  work (modified) : for node masses.
    """
    speed = state[at.REELING] if parameters[at.WINCH_IS_BRAKED] != 0.0 else inputs[at.REEL_OUT_SPEED]
    acceleration = acceleration_with(parameters, speed, state)
    flows = has_waves and sees_reeling(parameters) and (speed != 0.0 or acceleration != 0.0)
    leaving = NEUTRAL, NEUTRAL
    if parameters[at.IS_PORTION] != 0.0:
        leaving = state[at.SHEAVE_SPEED], state[at.SHEAVE_ACCELERATION]
        flows = flows or leaving[0] != 0.0 or leaving[1] != 0.0
    moving = state[at.LENGTH], speed, acceleration, leaving
    chain = chain_with_flow(n, parameters, *moving, wind_of(inputs), flows)
    x, _ = positions_and_velocities(n, state)
    blocks, _, mass, _ = shared_arrays(n, work)
    node_masses(chain, mass)
    for k in range(ENERGIES):
        energies[k] = 0.0
    energies[BREAKING] = state[at.TORN_ENERGY]
    balance_nodes(chain, x, v, mass, energies)
    balance_segments(chain, x, v, energies)
    balance_ends(chain, x, v, mass, vector_at(inputs, at.KITE_LOAD), energies)
    tension = energies[ENERGIES]
    if has_waves and sees_reeling(parameters) and state[at.LAST_STEP] > 0.0:
        tension = state[at.TENSION_AT_DRUM]
    speed = state[at.REELING] if parameters[at.HELD_BY] == 0.0 else state[at.DRUM_SPEED]
    balance_drum(parameters, speed, tension, inputs[at.WINCH_FORCE], energies)
    if not (PARTS and chain.is_parted):
        energies[MATERIAL] = chain.growth * (energies[ELASTIC] + energies[MATERIAL])
    if chain.flows:
        balance_flow(chain, state, x, v, vector_at(inputs, at.KITE_LOAD), mass, part(blocks[0], 0, 3 * (n + 1)), energies)
    copy(v, part(energies, ENERGIES + n, 3 * (n + 1)))
    return OK


@kernel
def acceleration_with(parameters, speed, state):
    """Rate of the reel-out speed [m/s2] in a state; in the next step, if the speed [m/s] differs from the state."""
    if speed == state[at.REELING] or follows_force(parameters):
        return state[at.ACCELERATION]
    if state[at.LAST_STEP] > 0.0 and is_continued(parameters):
        return (speed - state[at.LAST_REEL_OUT_SPEED]) / state[at.LAST_STEP]
    return 0.0


@kernel
def balance_flow(chain, state, x, v, load, mass, a, energies):
    """Add the energy [J] of flowing rope and the power [W] that accelerates it to `energies` (modified).

    state : of a portion of a line over sheaves.  load : on a free kite end [N].  mass, a (modified) : room for masses [kg]
    and accelerations [m/s2].
    """
    are_free = chain.parameters[at.GROUND_IS_FREE], chain.parameters[at.KITE_IS_FREE]
    motion.accelerations(chain, x, v, scale(are_free[1], load), mass, a)
    if chain.parameters[at.IS_PORTION] != 0.0:
        put(a, 0, vector_at(state, at.START_ACCELERATION))
        put(a, chain.n, vector_at(state, at.END_ACCELERATION))
    counted = are_free[0] if chain.parameters[at.IS_PORTION] == at.BEHIND_SHEAVE else 0.0, are_free[1]
    energies[KINETIC] += flow.energy_of_flow(chain, x, v, counted)
    energies[WINCH] += flow.power(chain, x, v, a, are_free, counted)
    for kite_end in range(2):  # part of the power of driven ends
        s, node = (chain.n - 1) * kite_end, chain.n * kite_end
        push = flow.end_force(chain, kite_end == 1, get(x, s), get(x, s + 1), get(v, s), get(v, s + 1))
        energies[WINCH] += (1.0 - are_free[kite_end]) * dot(push, get(v, node))


@kernel
def balance_nodes(chain, x, v, mass, energies):
    """Add energies [J] and losses [W] of nodes to `energies` (modified); for MATERIAL, those of their `growing_mass`."""
    for i in range(chain.n + 1):
        free = 1.0
        if i == 0:
            free = chain.parameters[at.GROUND_IS_FREE]
        elif i == chain.n:
            free = chain.parameters[at.KITE_IS_FREE]
        tether = mass[i] - point_mass(chain, i)
        moving = 0.5 * free * dot(get(v, i), get(v, i))
        specific = node_loads.specific_potential(chain, get(x, i), free > 0.0)
        slide = flow.slide(chain, i, flow.passing_at(chain, i), x)
        of_rope = add(get(v, i), slide)
        contact, sliding = node_loads.specific_losses(chain, get(x, i), of_rope, free > 0.0)
        energies[WINCH] -= mass[i] * node_loads.specific_friction(chain, get(x, i), of_rope, slide)
        energies[KINETIC] += mass[i] * moving
        energies[POTENTIAL] += (tether + free * point_mass(chain, i)) * specific
        growing = mass_rate(chain, i) if PARTS and chain.is_parted else growing_mass(chain, i, mass[i])
        energies[MATERIAL] += growing * (moving + specific)
        energies[CONTACT_LOSS] += mass[i] * contact
        energies[SLIDING_LOSS] += mass[i] * sliding


@kernel
def mass_rate(chain, i):
    """Rate of the rope mass of node i [kg/s] of a portion in two parts."""
    total = 0.0
    for s in range(max(i - 1, 0), min(i + 1, chain.n)):
        total += half_density(chain, s) * rest_length(chain, s) * growth_at(chain, s)
    return total


@kernel
def balance_segments(chain, x, v, energies):
    """Add elastic energies [J], powers and losses [W] of segments to `energies` (modified), and write their tensions [N]."""
    for s in range(chain.n):
        x_p, x_q, v_p, v_q = get(x, s), get(x, s + 1), get(v, s), get(v, s + 1)
        length, e = segment.geometry(sub(x_q, x_p))
        rest, rate = rest_length(chain, s), dot(e, sub(v_q, v_p))
        k, c = segment.stiffness(chain, s, length - rest, rest)
        tension, growth = segment.tension(chain, s, length, rate, rest, k, c), growth_at(chain, s)
        drag = scale(2.0, segment.half_drag_between(chain, s, length, e, x_p, x_q, v_p, v_q))
        air_velocity, _, _, _ = segment.air_of(chain, s, segment.mean_height(x_p, x_q))
        energies[ENERGIES + s] = tension
        elastic = segment.elastic_energy(k, length - rest)
        energies[ELASTIC] += elastic
        energies[MATERIAL] += growth * elastic if PARTS and chain.is_parted else in_section(chain, s, elastic) - elastic
        energies[WINCH] -= tension * length * growth
        energies[WIND] += dot(drag, air_velocity)
        energies[DAMPING_LOSS] += c * segment.seen_rate(chain, s, length, rate) * (rate - growth * length)
        energies[DRAG_LOSS] += dot(drag, sub(air_velocity, segment.mean_velocity(v_p, v_q)))


@kernel
def balance_ends(chain, x, v, mass, kite_load, energies):
    """Powers [W] of the supports of driven ends, or of the load [N] on a free kite end, into `energies` (modified)."""
    ground_force, _ = end_force(chain, False, x, v, mass)
    kite_force, _ = end_force(chain, True, x, v, mass)
    kite_is_free = chain.parameters[at.KITE_IS_FREE]
    load = sub(scale(kite_is_free, kite_load), scale(1.0 - kite_is_free, kite_force))
    energies[GROUND_POWER] = (chain.parameters[at.GROUND_IS_FREE] - 1.0) * dot(ground_force, get(v, 0))
    energies[KITE_POWER] = dot(load, get(v, chain.n))


@kernel
def balance_drum(parameters, speed, tension, force, energies):
    """Energy and powers of a drum controlled by a force [N] into `energies` (modified); 0 for any other winch.

    speed : of the drum [m/s].  tension : at the drum [N].
    """
    drum = drum_of(parameters, force, 0.0)
    is_there = 1.0 if follows_force(parameters) else 0.0
    energies[DRUM] = is_there * 0.5 * drum.mass * speed * speed
    energies[DRUM_POWER] = is_there * tension * speed
    energies[MOTOR_POWER] = -is_there * force * speed
    energies[FRICTION_LOSS] = is_there * (drum.damping * speed * speed + drum.friction * abs(speed))
