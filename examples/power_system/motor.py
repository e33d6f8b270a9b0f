"""How hard does the motor of a winch pull, whose drum is inside the tether? For `winch_inside.py`.

The flight controller wants a speed s(T) for a tension T, which the winch as an FMU follows. Here the motor, by its force W,
lets a drum of mass m move as one of mass m' that is held by a tension T', which is the one for its speed:

    W = T - (T - T') m/m' - friction,   s(T') = s + (T - T') h/m'

The right side is the speed at the end of the communication step h. T and s at the start of the step are good enough as long
as m' is not much less than m: what the tension does within the step, the drum itself feels.
"""

from math import atan2, hypot, sqrt

from fmus.flight_controller import FADING, Flight
from fmus.winch import CRAWL, Drum
from power_system.kite_power_system import START

DRUM, FLIGHT, BY_FORCE = Drum(), Flight(), 2
MASS, MOST = DRUM.inertia / DRUM.drum_radius**2, DRUM.torque_limit / DRUM.drum_radius  # m [kg], largest force [N]
FELT = MASS / 3.0  # m' [kg]; with m itself the drum would follow the controller in 1.3 s while it reels in
HELD = {"input_continuation": 2}  # start value: the inputs of the tether stay as they are within a step
OF_DRUM = {  # start values of the tether
    "winch_control": BY_FORCE,
    "winch_mass": MASS,
    "winch_damping": DRUM.viscous_friction,
    "winch_friction": DRUM.coulomb_friction,
    "reel_out_speed": START["initial_speed"],
    "tether.longest_length": 0.0,  # no stop of the drum where the controller, which has the same name, begins to reel in
    "tether.shortest_length": 0.0,
}


def wanted_speed(tension, depower, elevation):
    """Reel-out speed s [m/s] that the flight controller wants for a tension [N], at an elevation of the kite [rad]."""
    out = sqrt(max(tension, 0.0) / FLIGHT.tension_over_squared_speed)
    back = FLIGHT.reel_in_speed * max(0.0, 1.0 - max(tension, 0.0) / FLIGHT.reel_in_tension)
    return (1.0 - depower) * out - depower * back * min(1.0, max(0.0, (FLIGHT.steepest - elevation) / FADING))


def pull(tension, speed, depower, position, step):
    """`winch_force` [N] in a step [s] that starts with this tension [N], drum speed [m/s], and position of the kite [m]."""
    elevation, change = atan2(position[2], hypot(*position[:2])), FELT * DRUM.largest_acceleration
    low, high = tension - change, tension + change
    for _ in range(50):  # bisection for T': s(T') rises with it, the other side falls
        middle = 0.5 * (low + high)
        above = wanted_speed(middle, depower, elevation) > speed + (tension - middle) * step / FELT
        low, high = (low, middle) if above else (middle, high)
    friction = DRUM.viscous_friction * speed + DRUM.coulomb_friction * speed / hypot(speed, CRAWL)
    return min(max(tension - (tension - high) * MASS / FELT - friction, -MOST), MOST)
