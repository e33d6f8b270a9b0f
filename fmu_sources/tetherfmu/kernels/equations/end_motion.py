"""Motion of a driven end within a communication step: a curve with continuous position and velocity.

At the start of a step of length h the importer gives position p and velocity v. With the acceleration estimated from the
velocity inputs, a = (v - v_last)/h_last (h_last counts as at least h/4, so that a jump of the velocity is extrapolated to no
more than four times itself; in the first step a is 0, or that of `turning_accelerations`), the end moves from the position
and velocity it has reached to

    p + v h + a h^2/2,   v + a h

by the cubic Hermite polynomial, so neither position nor velocity ever jumps. Where the importer knows positions only, the
differences u = (p - p_last)/h_last belong to the middles of the steps, so that

    a = (u - u_last)/((h_last + h_before)/2),   v = u + a h_last/2

Theory: docs/models/theory.md, "Driven ends".
"""

from tetherfmu.runtime.limits import SHORTEST_LAST_STEP

from ..compilation import kernel
from ..linear_algebra.vectors import add, add_scaled, dot, scale, sub

LARGEST_TURN = 2.0  # [rad] of the chord in a first step: beyond, half of the square is further off than no turning at all


@kernel
def per_last_step(last_step, step):
    """1/h_last [1/s], with h_last no shorter than `SHORTEST_LAST_STEP` times the communication step [s]."""
    return 1.0 / max(last_step, SHORTEST_LAST_STEP * step)


@kernel
def estimated_acceleration(velocity, last_velocity, last_step, step):
    """Acceleration [m/s2] from two velocities [m/s] that are `last_step` [s] apart; 0 without a last.

    `step` [s] is the communication step that it is for: after a much shorter one it counts in part only.
    """
    if last_step <= 0.0:
        return 0.0, 0.0, 0.0
    return scale(per_last_step(last_step, step), sub(velocity, last_velocity))


@kernel
def turning_accelerations(ground, kite, step):
    """Accelerations [m/s2] of two ends that turn around each other, for a first step [s], which knows no last velocity.

    Together w^2/|r| along the chord r [m], with the part w of the relative velocity [m/s] across it; each end takes its
    share of the squares of the two speeds, so that an end at rest stays. Without them the first step would take a turning
    kite outwards along its tangent, by w^2 h^2/(2 |r|). ground, kite : position [m], velocity [m/s], ... of an end.
    """
    chord, velocity = sub(kite[0], ground[0]), sub(kite[1], ground[1])
    square = dot(chord, chord)
    speeds = dot(ground[1], ground[1]) + dot(kite[1], kite[1])
    if square <= 0.0 or speeds <= 0.0:
        return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    across = add_scaled(velocity, -dot(chord, velocity) / square, chord)
    turning = scale(min(dot(across, across) / square, (LARGEST_TURN / step) ** 2) / speeds, chord)
    return scale(dot(ground[1], ground[1]), turning), scale(-dot(kite[1], kite[1]), turning)


@kernel
def difference(position, last_position, last_step):
    """Velocity [m/s] over the last communication step [s]; 0 before the second."""
    if last_step <= 0.0:
        return 0.0, 0.0, 0.0
    return scale(1.0 / last_step, sub(position, last_position))


@kernel
def derived_motion(position, velocity, last_velocity, last_step, step_before, step):
    """Position [m], velocity [m/s] and acceleration [m/s2] at the start of a step [s], from the last three positions.

    velocity, last_velocity : `difference` over the last step and over the one before [m/s].  last_step, step_before : [s].
    The acceleration is 0 before the third step.
    """
    between = 0.5 * (last_step + step_before) if step_before > 0.0 else 0.0
    acceleration = estimated_acceleration(velocity, last_velocity, between, step)
    return position, add_scaled(velocity, 0.5 * last_step, acceleration), acceleration


@kernel
def target(position, velocity, acceleration, step):
    """Position [m] and velocity [m/s] that an end reaches at the end of a step [s]."""
    return add_scaled(add_scaled(position, step, velocity), 0.5 * step * step, acceleration), add_scaled(
        velocity, step, acceleration
    )


@kernel
def curve(reached_position, reached_velocity, position, velocity, acceleration, step):
    """Coefficients of the curve x0 + v0 t + c2 t^2 + c3 t^3: returns (x0, v0, c2, c3), SI units."""
    target_position, target_velocity = target(position, velocity, acceleration, step)
    mean = scale(1.0 / step, sub(target_position, reached_position))
    c2 = scale(1.0 / step, sub(scale(3.0, mean), add(scale(2.0, reached_velocity), target_velocity)))
    c3 = scale(1.0 / (step * step), sub(add(reached_velocity, target_velocity), scale(2.0, mean)))
    return reached_position, reached_velocity, c2, c3


@kernel
def position_at(end, time):
    """Position [m] on the curve at a time [s] since the start of the step."""
    return add_scaled(add_scaled(add_scaled(end[0], time, end[1]), time * time, end[2]), time * time * time, end[3])


@kernel
def velocity_at(end, time):
    """Velocity [m/s] on the curve at a time [s] since the start of the step."""
    return add_scaled(add_scaled(end[1], 2.0 * time, end[2]), 3.0 * time * time, end[3])


@kernel
def acceleration_at(end, time):
    """Acceleration [m/s2] on the curve at a time [s] since the start of the step."""
    return add_scaled(scale(2.0, end[2]), 6.0 * time, end[3])
