"""Energies of a chain and the powers that change them. Source: docs/models/theory.md, "Energy"."""

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import OK

from ..arrays import copy, positions_and_velocities, shared_arrays
from ..compilation import kernel
from ..equations import node_loads, segment
from ..equations.assembly import end_force, node_masses
from ..equations.boundary import wind_of
from ..equations.drum import drum_of
from ..equations.properties import chain_at, point_mass, rest_length
from ..equations.winch import follows_force
from ..flat_arrays import part
from ..linear_algebra.vectors import dot, get, scale, sub, vector_at

# the fields of `tetherfmu.energy.Energy`, in their order; behind them the tensions of the segments [N], then the velocities
# of the nodes [m/s]
KINETIC, ELASTIC, POTENTIAL, GROUND_POWER, KITE_POWER, WINCH, MATERIAL, WIND, DAMPING_LOSS, DRAG_LOSS = range(10)
DRUM, DRUM_POWER, MOTOR_POWER, FRICTION_LOSS = range(10, 14)
CONTACT_LOSS, SLIDING_LOSS = 14, 15
ENERGIES = 16


@kernel
def size(n):
    """Length of the array that `balance` writes."""
    return ENERGIES + n + 3 * (n + 1)


@kernel
def balance_drum(parameters, speed, tension, force, energies):
    """Energy and powers of a drum that is controlled by force [N] into `energies` (modified); 0 of any other winch.

    speed : of the drum [m/s].  tension : of the first segment [N].
    """
    drum = drum_of(parameters, force, 0.0)
    is_there = 1.0 if follows_force(parameters) else 0.0
    energies[DRUM] = is_there * 0.5 * drum.mass * speed * speed
    energies[DRUM_POWER] = is_there * tension * speed
    energies[MOTOR_POWER] = -is_there * force * speed
    energies[FRICTION_LOSS] = is_there * (drum.damping * speed * speed + drum.friction * abs(speed))


@kernel
def balance(n, parameters, state, v, inputs, energies, work):
    """Energies [J], powers [W], tensions [N] and velocities of a state into `energies` (modified), see `ENERGIES`; a status.

    v : velocities of its nodes [m/s].  inputs : its reel-out speed, wind, load of a free kite end and force of the winch
    count.
    work (modified) : for node masses.
    """
    chain = chain_at(n, parameters, state[at.LENGTH], inputs[at.REEL_OUT_SPEED], wind_of(inputs))
    x, _ = positions_and_velocities(n, state)
    _, _, mass, _ = shared_arrays(n, work)
    node_masses(chain, mass)
    kinetic = potential = new_material = contact_loss = sliding_loss = 0.0
    for i in range(n + 1):
        free = 1.0
        if i == 0:
            free = parameters[at.GROUND_IS_FREE]
        elif i == n:
            free = parameters[at.KITE_IS_FREE]
        moving = 0.5 * free * dot(get(v, i), get(v, i))
        tether = mass[i] - point_mass(chain, i)
        kinetic += mass[i] * moving
        specific = node_loads.specific_potential(chain, get(x, i), free > 0.0)
        potential += (tether + free * point_mass(chain, i)) * specific
        new_material += tether * (moving + specific)
        contact, sliding = node_loads.specific_losses(chain, get(x, i), get(v, i), free > 0.0)
        contact_loss += mass[i] * contact
        sliding_loss += mass[i] * sliding
    elastic = winch = wind = damping = friction = 0.0
    for s in range(n):
        x_p, x_q, v_p, v_q = get(x, s), get(x, s + 1), get(v, s), get(v, s + 1)
        length, e = segment.geometry(sub(x_q, x_p))
        rest = rest_length(chain, s)
        rate = dot(e, sub(v_q, v_p))
        k, c = segment.stiffness(chain, s, length - rest, rest)
        drag = scale(2.0, segment.half_drag_between(chain, s, length, e, x_p, x_q, v_p, v_q))
        air_velocity, _, _, _ = segment.air_of(chain, s, segment.mean_height(x_p, x_q))
        elastic += segment.elastic_energy(k, length - rest)
        tension = segment.tension(chain, length, rate, rest, k, c)
        energies[ENERGIES + s] = tension
        winch -= tension * length * chain.growth
        wind += dot(drag, air_velocity)
        damping += c * segment.seen_rate(chain, length, rate) * (rate - chain.growth * length)
        friction += dot(drag, sub(air_velocity, segment.mean_velocity(v_p, v_q)))
    ground_force, _ = end_force(chain, False, x, v, mass)
    kite_force, _ = end_force(chain, True, x, v, mass)
    kite_is_free = parameters[at.KITE_IS_FREE]
    energies[KINETIC] = kinetic
    energies[ELASTIC] = elastic
    energies[POTENTIAL] = potential
    energies[GROUND_POWER] = (parameters[at.GROUND_IS_FREE] - 1.0) * dot(ground_force, get(v, 0))
    load = sub(scale(kite_is_free, vector_at(inputs, at.KITE_LOAD)), scale(1.0 - kite_is_free, kite_force))
    energies[KITE_POWER] = dot(load, get(v, n))
    energies[WINCH] = winch
    energies[MATERIAL] = chain.growth * (elastic + new_material)
    energies[WIND] = wind
    energies[DAMPING_LOSS] = damping
    energies[DRAG_LOSS] = friction
    energies[CONTACT_LOSS] = contact_loss
    energies[SLIDING_LOSS] = sliding_loss
    balance_drum(parameters, state[at.REELING], energies[ENERGIES], inputs[at.WINCH_FORCE], energies)
    copy(v, part(energies, ENERGIES + n, 3 * (n + 1)))
    return OK
