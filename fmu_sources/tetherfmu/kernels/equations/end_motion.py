"""Motion of a driven end within a communication step: a curve with continuous position and velocity.

At the start of a step of length h the importer sets position p and velocity v. The velocity inputs yield the acceleration
a = (v - v_last)/h_last (in the first step 0, or from `centripetal_accelerations`). From its present position and velocity
the end moves towards

    p + v H + a H^2/2,   v + a H,   H = max(h, h_last, remainder of the last H)

along a cubic Hermite polynomial, so neither position nor velocity ever jumps. H is h unless steps change. If they become
shorter, only the first part of the correction is done: a short step would otherwise correct the error of the long step
before it, and jerk the end.

After a step much shorter than h, the difference quotient would multiply a velocity jump by h/h_last. It is therefore blended
with the earlier acceleration r, so that it rests on at least T = h/4:

    a = (v - v_last + (T - h_last) r)/T,   T = h/4 > h_last

r is the same formula for the longest step so far, h_longest, in place of h; where h > h_longest, r counts over h_longest/4
only. A jump is thus extrapolated to no more than four times its size.

The deviation y = x - p - v t - a t^2/2 from the prescribed motion vanishes after H. In a step much longer than the time in
which y arose, y' would cause a large overshoot. H is therefore at most the larger of 3 |y|/|y'|, for which y does not
overshoot, and the remainder of the last correction, or else h_last. For the rest of the step the end follows the prescribed
motion.

If the importer sets positions only (`past.py`), the displacement v H + a H^2/2 to the target is limited: to between 0 and H
times the smaller of the last two rates u and u' (0 if their signs differ), plus a part that the curvature explains:
`CURVED` H (H/2 + T + T'/2) times the smaller of a and a' (0 if their signs differ). A jump of the position is thus not
extrapolated, and smooth motion is unchanged, also where it reverses.

Theory: docs/models/theory.md, "Driven ends".
"""

from math import sqrt

from tetherfmu.runtime.limits import SHORTEST_LAST_STEP

from ..compilation import kernel
from ..linear_algebra.vectors import ZERO_VECTOR, add, add_scaled, dot, scale, sub

CURVED = 1.5
ROUNDED = 1e-9  # of a step: remainder of a correction if steps differ by rounding
LARGEST_ANGLE = 2.0  # [rad] of the chord in a first step; beyond it, half of the square is worse than no turning at all


@kernel
def estimated_rate(change, recent, last_step, longest, step):
    """Rate of an input [unit/s] in a communication step [s], from its change in the time `last_step` [s]; 0 without a last.

    recent : its rate before that time, over a quarter of the longest step so far [s]; used if `last_step` is much
    shorter than the step, see above.
    """
    if last_step <= 0.0:
        return 0.0
    missing = SHORTEST_LAST_STEP * min(step, longest) - last_step
    if missing > 0.0:
        change += missing * recent
    return 1.0 / max(last_step, SHORTEST_LAST_STEP * step) * change


@kernel
def estimated_rates(now, last, recent, times, longest, step):
    """`estimated_rate` of three inputs, from their present and last values and the times between these [s]."""
    change = sub(now, last)
    return (
        estimated_rate(change[0], recent[0], times[0], longest, step),
        estimated_rate(change[1], recent[1], times[1], longest, step),
        estimated_rate(change[2], recent[2], times[2], longest, step),
    )


@kernel
def centripetal_accelerations(ground, kite, step):
    """Accelerations [m/s2] of two ends that revolve around each other, for a first step [s] without a last velocity.

    w^2/|r| along the chord r [m], with the relative velocity w [m/s] across it, of the kite end; of the ground end only if
    the kite rests: so an observer who moves uniformly sees the same. Otherwise the first step would move a turning kite
    along its tangent, outwards by w^2 h^2/(2 |r|). ground, kite : position [m], velocity [m/s], ... of an end.
    """
    chord, velocity = sub(kite[0], ground[0]), sub(kite[1], ground[1])
    square = dot(chord, chord)
    if square <= 0.0:
        return ZERO_VECTOR, ZERO_VECTOR
    across = add_scaled(velocity, -dot(chord, velocity) / square, chord)
    turning = scale(min(dot(across, across) / square, (LARGEST_ANGLE / step) ** 2), chord)
    if dot(kite[1], kite[1]) > 0.0:
        return ZERO_VECTOR, scale(-1.0, turning)
    return turning, ZERO_VECTOR


@kernel
def smaller(a, b):
    """The number closer to 0, or 0 if the signs differ."""
    if a * b <= 0.0:
        return 0.0
    return a if abs(a) < abs(b) else b


@kernel
def limited_motion(velocity, acceleration, rates, accelerations, periods, time):
    """Velocity [m/s] and acceleration [m/s2] of a quantity known by positions only, for the next `time` [s].

    velocity, acceleration : without limits.  rates, accelerations : the latest two of each, which limit the displacement
    [m/s], [m/s2].  periods : over which the rates were measured [s].
    """
    way = time * (velocity + 0.5 * time * acceleration)
    steady = time * smaller(rates[0], rates[1])
    constant = 0.5 * time * (time + 2.0 * periods[0] + periods[1])  # times a constant acceleration: remaining displacement
    curved = CURVED * constant * abs(smaller(accelerations[0], accelerations[1]))
    allowed = max(min(0.0, steady) - curved, min(max(0.0, steady) + curved, way))
    if allowed == way:
        return velocity, acceleration
    return allowed / time, 0.0


@kernel
def target(position, velocity, acceleration, time):
    """Target position [m] and velocity [m/s] of an end after a time [s], from its motion at the start."""
    reached = add_scaled(add_scaled(position, time, velocity), 0.5 * time * time, acceleration)
    return reached, add_scaled(velocity, time, acceleration)


@kernel
def time_of_correction(reached_position, reached_velocity, position, velocity, last_step, left, time):
    """Time H [s] in which an end returns to its prescribed motion [m, m/s]: at most `time`.

    last_step, left : the last communication step, and the remainder of its H [s].
    """
    off, moving = sub(reached_position, position), sub(reached_velocity, velocity)
    arose = left if left > ROUNDED * last_step else last_step
    square, speed = 9.0 * dot(off, off), dot(moving, moving)
    if not 0.0 < arose < time or speed * time * time <= square:
        return time
    return min(time, max(arose, sqrt(square / speed)))


@kernel
def curve(reached_position, reached_velocity, position, velocity, acceleration, time):
    """The curve x0 + v0 t + c2 t^2 + c3 t^3 to the target after a time H [s], then the prescribed motion.

    Coefficients (x0, v0, c2, c3), SI units; then (H, 0, 0) and the acceleration [m/s2] after H.
    """
    target_position, target_velocity = target(position, velocity, acceleration, time)
    mean = scale(1.0 / time, sub(target_position, reached_position))
    c2 = scale(1.0 / time, sub(scale(3.0, mean), add(scale(2.0, reached_velocity), target_velocity)))
    c3 = scale(1.0 / (time * time), sub(add(reached_velocity, target_velocity), scale(2.0, mean)))
    return reached_position, reached_velocity, c2, c3, (time, 0.0, 0.0), acceleration


@kernel
def position_at(end, time):
    """Position [m] on the curve at a time [s] since the start of the step."""
    if time > end[4][0]:
        first = end[4][0]
        return target(position_at_once(end, first), velocity_at_once(end, first), end[5], time - first)[0]
    return position_at_once(end, time)


@kernel
def velocity_at(end, time):
    """Velocity [m/s] on the curve at a time [s] since the start of the step."""
    if time > end[4][0]:
        return add_scaled(velocity_at_once(end, end[4][0]), time - end[4][0], end[5])
    return velocity_at_once(end, time)


@kernel
def acceleration_at(end, time):
    """Acceleration [m/s2] on the curve at a time [s] since the start of the step."""
    if time > end[4][0]:
        return end[5]
    return add_scaled(scale(2.0, end[2]), 6.0 * time, end[3])


@kernel
def jerk_at(end, time):
    """Third derivative [m/s3] of the curve at a time [s] since the start of the step."""
    return ZERO_VECTOR if time > end[4][0] else scale(6.0, end[3])


@kernel
def position_at_once(end, time):
    """Position [m] on the curve at a time [s] up to H."""
    return add_scaled(add_scaled(add_scaled(end[0], time, end[1]), time * time, end[2]), time * time * time, end[3])


@kernel
def velocity_at_once(end, time):
    """Velocity [m/s] on the curve at a time [s] up to H."""
    return add_scaled(add_scaled(end[1], 2.0 * time, end[2]), 3.0 * time * time, end[3])
