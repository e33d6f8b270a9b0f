"""The drum of a winch that is controlled by force: how it turns, when it is held, where it stops.

    m du/dt = T - W - c u - F sign(u),   dL/dt = u

L is the unstretched length, u the reel-out speed, T the tension of the first segment, m `winch_mass`, W `winch_force`, c
`winch_damping` and F `winch_friction`. Without mass T = W + c u + F sign(u) at every instant.

Held: a drum at rest stays while |T - W| is at most F, and at a stop while it is pushed into it. It is never at rest but
held: within a piece of time it pays out (direction 1), reels in (-1) or is held (0), and the end of the piece is where that
changes. Stops are inelastic.

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
# part of its friction from which on a drum without mass, which turns at just this force, goes on turning
ALMOST = 1.0 - 1e-9
SAME_PLACE = 1e-12  # of the length, relative: so near to a stop the drum is at it


@view
def drum_of(parameters, force, force_rate):
    """`Drum` with this force [N] and its rate [N/s]."""
    return drum_with(parameters, 0.0, force, force_rate)


@view
def drum_with(parameters, rope, force, force_rate):
    """The same with so much mass of rope [kg]."""
    mass, friction = parameters[at.WINCH_MASS] + rope, parameters[at.WINCH_FRICTION]
    if pulls_only(parameters):
        force = max(force, -friction)  # of which rounding may take a little, see `transaction.check_reeling`
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
    """Force of the winch W [N] at a time [s] of the communication step."""
    return drum.force + time * drum.force_rate


@kernel
def balance(drum, direction, tension, speed, time):
    """T - W - c u - F sign(u) [N] at a time [s] of the communication step, of a drum that turns in a direction."""
    return tension - force_at(drum, time) - drum.damping * speed - drum.friction * direction


@kernel
def is_at_stop(drum, length, direction):
    """Whether the drum can turn no further in a direction at an unstretched length [m]."""
    margin = SAME_PLACE * length
    return (direction > 0.0 and length >= drum.longest - margin) or (direction < 0.0 and length <= drum.shortest + margin)


@kernel
def direction_of(drum, length, speed, tension, time):
    """Direction in which a drum turns next from a length [m] and a speed [m/s].

    tension : T at rest [N], at this time [s]. Without mass the drum has no speed of its own.
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


@kernel
def freedom(drum, length, tension, time):
    """Force [N] that a drum which is held at a length [m] under a tension [N] lacks to turn; below 0: it turns."""
    excess = tension - force_at(drum, time)
    if is_at_stop(drum, length, OUTWARDS):
        return drum.friction + excess
    if is_at_stop(drum, length, INWARDS):
        return drum.friction - excess
    return drum.friction - abs(excess)
