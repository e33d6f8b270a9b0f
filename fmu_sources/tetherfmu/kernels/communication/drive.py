"""What drives a chain within one communication step: its ends, its reeling, the wind and a load."""

from collections import namedtuple

from tetherfmu.kernels.algebra.vectors import get, put, scale
from tetherfmu.kernels.compilation import kernel
from tetherfmu.runtime import layout as at

from .driven_end import curve, position_at, velocity_at
from .inputs import accelerations, vector

Drive = namedtuple("Drive", "ground kite first last length reeling wind load")
Drive.__doc__ = """What acts on the chain during one communication step.

ground, kite : curves of the driven ends, see `end_motion.curve`.
first, last : first and last node that moves freely.
length, reeling : unstretched length at the start [m] and its constant rate [m/s].
wind : at the reference height [m/s].  load : force on a free kite end [N].
"""


@kernel
def drive_of_step(n, parameters, inputs, step, state, x, v):
    """What acts on the chain during a communication step of `step` [s]: a `Drive`."""
    ground_acceleration, kite_acceleration = accelerations(inputs, step, state)
    ground = vector(inputs, at.GROUND_POSITION)
    ground_velocity = vector(inputs, at.GROUND_VELOCITY)
    kite = vector(inputs, at.KITE_POSITION)
    kite_velocity = vector(inputs, at.KITE_VELOCITY)
    kite_is_free = parameters[at.KITE_IS_FREE] != 0.0
    return Drive(
        curve(get(x, 0), get(v, 0), ground, ground_velocity, ground_acceleration, step),
        curve(get(x, n), get(v, n), kite, kite_velocity, kite_acceleration, step),
        0 if parameters[at.GROUND_IS_FREE] != 0.0 else 1,
        n if kite_is_free else n - 1,
        state[at.LENGTH],
        inputs[at.REEL_OUT_SPEED],
        vector(inputs, at.WIND_VELOCITY),
        scale(1.0 if kite_is_free else 0.0, vector(inputs, at.KITE_LOAD)),
    )


@kernel
def place_ends(n, drive, time, x, v):
    """Put the driven ends into x [m] and v [m/s] (both modified) at a time [s] of the communication step."""
    if drive.first == 1:
        put(x, 0, position_at(drive.ground, time))
        put(v, 0, velocity_at(drive.ground, time))
    if drive.last == n - 1:
        put(x, n, position_at(drive.kite, time))
        put(v, n, velocity_at(drive.kite, time))
