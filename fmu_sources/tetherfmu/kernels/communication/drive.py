"""What drives a chain within one communication step: its ends, its reeling, the wind and a load."""

from collections import namedtuple

from tetherfmu.runtime import layout as at

from ..algebra.vectors import along, get, put, scale, vector_at
from ..chain.properties import chain_at
from ..compilation import kernel, view
from .continuation import load_rate, reel_acceleration, reeled, wind_after
from .driven_end import curve, position_at, turning_accelerations, velocity_at
from .ends import motions
from .given_derivatives import given_derivatives

Drive = namedtuple("Drive", "n parameters ground kite first last length reeling reel_acceleration wind load load_rate")
Drive.__doc__ = """A chain and what acts on it during one communication step.

n, parameters : number of segments and flat array of the chain, see `layout.py`.
ground, kite : curves of the driven ends, see `driven_end.curve`.
first, last : first and last node that moves freely.
length, reeling, reel_acceleration : unstretched length at the start [m], its rate there [m/s], constant rate of that [m/s2].
wind : mean over the step, at the reference height [m/s].
load, load_rate : force on a free kite end at the start [N], its constant rate [N/s].
"""


@view
def drive_of_step(n, parameters, inputs, step, state, x, v):
    """`Drive` of a communication step of `step` [s] from a state with the node positions x [m] and velocities v [m/s]."""
    ground, kite = motions(parameters, inputs, step, state)
    if state[at.LAST_STEP] <= 0.0 and parameters[at.INITIAL_SHAPE] == at.QUASI_STEADY:
        ground_turns, kite_turns = turning_accelerations(ground, kite, step)
        ground = ground[0], ground[1], given_derivatives(state, at.GROUND_VELOCITY, ground_turns)
        kite = kite[0], kite[1], given_derivatives(state, at.KITE_VELOCITY, kite_turns)
    kite_is_free = parameters[at.KITE_IS_FREE] != 0.0
    return Drive(
        n,
        parameters,
        curve(get(x, 0), get(v, 0), *ground, step),
        curve(get(x, n), get(v, n), *kite, step),
        0 if parameters[at.GROUND_IS_FREE] != 0.0 else 1,
        n if kite_is_free else n - 1,
        state[at.LENGTH],
        inputs[at.REEL_OUT_SPEED],
        reel_acceleration(parameters, inputs, step, state),
        wind_after(inputs, 0.5 * step, state),
        scale(1.0 if kite_is_free else 0.0, vector_at(inputs, at.KITE_LOAD)),
        scale(1.0 if kite_is_free else 0.0, load_rate(parameters, inputs, step, state)),
    )


@view
def chain_during(drive, time):
    """The `Chain` at a time [s] of the communication step."""
    length = reeled(drive.length, drive.reeling, drive.reel_acceleration, time)
    return chain_at(drive.n, drive.parameters, length, drive.reeling + drive.reel_acceleration * time, drive.wind)


@kernel
def load_during(drive, time):
    """Load [N] on a free kite end at a time [s] of the communication step, else 0."""
    return along(drive.load, time, drive.load_rate)


@kernel
def place_ends(drive, time, x, v):
    """Put the driven ends into x [m] and v [m/s] (both modified) at a time [s] of the communication step."""
    if drive.first == 1:
        put(x, 0, position_at(drive.ground, time))
        put(v, 0, velocity_at(drive.ground, time))
    if drive.last == drive.n - 1:
        put(x, drive.n, position_at(drive.kite, time))
        put(v, drive.n, velocity_at(drive.kite, time))


@kernel
def hold_ends(drive, a):
    """Set the vectors of the driven ends to zero in an array of node vectors (modified)."""
    if drive.first == 1:
        put(a, 0, (0.0, 0.0, 0.0))
    if drive.last == drive.n - 1:
        put(a, drive.n, (0.0, 0.0, 0.0))
