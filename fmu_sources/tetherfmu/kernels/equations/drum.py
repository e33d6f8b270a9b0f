"""The drum of a force-controlled winch: its motion, its friction and its stops.

    m du/dt = T - W - c u - F sign(u),   dL/dt = u

L is the unstretched length, u the reel-out speed, T the tension of the first segment, m `winch_mass`, W `winch_force`, c
`winch_damping` and F `winch_friction`. Without mass T = W + c u + F sign(u) at every instant.

A drum at rest is held while |T - W| is at most F, or while it is pushed into a stop. Within a piece of time a drum pays out
(direction 1), reels in (-1) or is held (0); a piece ends where the direction changes. Stops are inelastic.

Theory: docs/models/theory.md, "Winch".
"""

from collections import namedtuple

from tetherfmu.runtime import layout as at

from ..compilation import kernel, view
from .winch import pulls_only

Drum = namedtuple("Drum", "mass damping friction shortest longest force force_rate")
Drum.__doc__ = """A drum during one communication step.

mass, damping, friction : m [kg], c [N s/m], F [N].  shortest, longest : unstretched lengths [m] at its stops.
force, force_rate : W at the start [N], its constant rate [N/s].
"""

OUTWARDS, INWARDS, HELD = 1.0, -1.0, 0.0  # directions: it pays out, reels in, is held
# fraction of its friction above which a massless drum, which turns at exactly this force, keeps turning
ALMOST = 1.0 - 1e-9
SAME_PLACE = 1e-12  # distance to a stop at which the drum counts as stopped, relative to the length


@view
def drum_of(parameters, force, force_rate):
    """`Drum` with this force [N] and its rate [N/s]."""
    return drum_with(parameters, 0.0, force, force_rate)


@view
def drum_with(parameters, rope, force, force_rate):
    """`drum_of` with additional rope mass [kg]."""
    mass, friction = parameters[at.WINCH_MASS] + rope, parameters[at.WINCH_FRICTION]
    if pulls_only(parameters):
        force = max(force, -friction)  # rounding may lower it, see `transaction.check_reeling`
    return Drum(
        mass,
        parameters[at.WINCH_DAMPING],
        friction,
        parameters[at.SHORTEST_LENGTH],
        parameters[at.LONGEST_LENGTH],
        force,
        force_rate,
    )


@kernel
def force_at(drum, time):
    """Winch force W [N] at a time [s] of the communication step."""
    return drum.force + time * drum.force_rate


@kernel
def balance(drum, direction, tension, speed, time):
    """T - W - c u - F sign(u) [N] of a drum that turns in a direction, at a time [s] of the communication step."""
    return tension - force_at(drum, time) - drum.damping * speed - drum.friction * direction


@kernel
def is_at_stop(drum, length, direction):
    """Whether the drum is at the stop in a direction, at an unstretched length [m]."""
    margin = SAME_PLACE * length
    return (direction > 0.0 and length >= drum.longest - margin) or (direction < 0.0 and length <= drum.shortest + margin)


@kernel
def direction_of(drum, length, speed, tension, time):
    """Next direction of a drum from a length [m] and a speed [m/s].

    tension : T at rest [N], at this time [s]. The speed of a massless drum follows from the force balance.
    """
    moving = 0.0
    if drum.mass > 0.0 and speed != 0.0:
        moving = OUTWARDS if speed > 0.0 else INWARDS
    if moving == 0.0 or is_at_stop(drum, length, moving):
        excess = tension - force_at(drum, time)
        break_away = ALMOST * drum.friction if drum.mass == 0.0 else drum.friction
        moving = HELD
        if excess < -break_away or (excess < 0.0 and drum.friction == 0.0):
            moving = INWARDS
        elif excess > break_away or drum.friction == 0.0:
            moving = OUTWARDS
    return HELD if is_at_stop(drum, length, moving) else moving


@kernel
def stop_ahead(drum, direction):
    """Unstretched length [m] of the stop in a direction."""
    return drum.longest if direction > 0.0 else drum.shortest
