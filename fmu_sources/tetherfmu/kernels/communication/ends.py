"""Motion with which the ends are led in a communication step: from the inputs alone, or derived from positions.

With `end_velocities = given` the velocities are inputs. With `derived` they are differences of the positions of the last
steps, and the inputs are not read (`driven_end.derived_motion`). Derivatives that the importer gives replace both: that of a
velocity the acceleration, that of a position the derived velocity.
"""

from tetherfmu.runtime import layout as at

from ..algebra.vectors import put, vector_at
from ..arrays import positions_and_velocities
from ..compilation import kernel
from .driven_end import derived_motion, difference, estimated_acceleration, target
from .given_derivatives import given_derivatives


@kernel
def are_derived(parameters):
    """Whether the velocities of the ends come from their positions."""
    return parameters[at.END_VELOCITIES] == at.DERIVED


@kernel
def velocity_of_end(parameters, inputs, state, position, velocity, last_position):
    """Velocity [m/s] of an end: its input, or that over the last step; places of its inputs and of its last position."""
    if are_derived(parameters):
        return difference(vector_at(inputs, position), vector_at(state, last_position), state[at.LAST_STEP])
    return vector_at(inputs, velocity)


@kernel
def velocities(parameters, inputs, state):
    """Velocities [m/s] of the ground end and of the kite end, which the next step remembers."""
    return (
        velocity_of_end(parameters, inputs, state, at.GROUND_POSITION, at.GROUND_VELOCITY, at.LAST_GROUND_POSITION),
        velocity_of_end(parameters, inputs, state, at.KITE_POSITION, at.KITE_VELOCITY, at.LAST_KITE_POSITION),
    )


@kernel
def motion_of_end(parameters, inputs, place, velocity, last_velocity, step, state):
    """Position [m], velocity [m/s] and acceleration [m/s2] with which an end is led in a step [s].

    place : of its position among the inputs; its velocity stands behind.  velocity, last_velocity : of `velocities` [m/s].
    """
    position, last_step = vector_at(inputs, place), state[at.LAST_STEP]
    if are_derived(parameters):
        motion = derived_motion(position, velocity, last_velocity, last_step, state[at.STEP_BEFORE], step)
        position, velocity, acceleration = motion
        velocity = given_derivatives(state, place, velocity)
    else:
        acceleration = estimated_acceleration(velocity, last_velocity, last_step, step)
    return position, velocity, given_derivatives(state, place + 3, acceleration)


@kernel
def motions(parameters, inputs, step, state):
    """What `motion_of_end` says of the ground end, then of the kite end."""
    ground, kite = velocities(parameters, inputs, state)
    last_ground, last_kite = vector_at(state, at.LAST_GROUND_VELOCITY), vector_at(state, at.LAST_KITE_VELOCITY)
    return (
        motion_of_end(parameters, inputs, at.GROUND_POSITION, ground, last_ground, step, state),
        motion_of_end(parameters, inputs, at.KITE_POSITION, kite, last_kite, step, state),
    )


@kernel
def put_ends(n, state, ground, kite):
    """Write position [m] and velocity [m/s] of both ends to a state (modified)."""
    x, v = positions_and_velocities(n, state)
    put(x, 0, ground[0])
    put(v, 0, ground[1])
    put(x, n, kite[0])
    put(v, n, kite[1])


@kernel
def place_at_start(n, parameters, inputs, state):
    """Put both ends of a new state (modified, all 0) where the inputs say; a free kite end has its velocity from them."""
    ground, kite = velocities(parameters, inputs, state)
    if parameters[at.KITE_IS_FREE] != 0.0:
        kite = vector_at(inputs, at.KITE_VELOCITY)
    ground_position, kite_position = vector_at(inputs, at.GROUND_POSITION), vector_at(inputs, at.KITE_POSITION)
    put_ends(n, state, (ground_position, ground), (kite_position, kite))


@kernel
def move_ends(n, parameters, inputs, step, state):
    """Put both ends of a state (modified) where they are led to by the end of the step; for variants without waves."""
    ground, kite = motions(parameters, inputs, step, state)
    put_ends(n, state, target(*ground, step), target(*kite, step))
