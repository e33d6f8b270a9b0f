"""How hard does the motor of a winch pull, whose drum is inside the tether? For `winch_inside.py`.

The flight controller gives a speed for a tension, and the winch as an FMU follows that speed. Here it is the other way
round, a tension for the speed of the drum: the same pairs of both. The speed of a drum changes slowly, so its value at the
start of a communication step is good enough, which that of the tension is not.
"""

from math import atan2, hypot, sqrt

from fmus.flight_controller import FADING, Flight
from fmus.winch import CRAWL, Drum
from power_system.kite_power_system import START

DRUM, FLIGHT, BY_FORCE = Drum(), Flight(), 2
OF_DRUM = {
    "winch_control": BY_FORCE,
    "winch_mass": DRUM.inertia / DRUM.drum_radius**2,
    "winch_damping": DRUM.viscous_friction,
    "winch_friction": DRUM.coulomb_friction,
    "reel_out_speed": START["initial_speed"],  # at the start
    "tether.longest_length": 0.0,  # no stop of the drum where the controller, which has the same name, begins to reel in
    "tether.shortest_length": 0.0,
}
LEAST = 0.2  # of the speed of reeling in, which the controller lets fade to 0 at the steepest: there T has no end


def tension_for(speed, depower, elevation):
    """Tension T [N] with which the flight controller wants a reel-out speed s [m/s].

    s = (1 - depower) sqrt(T/K) - depower s0 (1 - T/T0),   s0 fades with the elevation [rad]
    """
    back = depower * FLIGHT.reel_in_speed * min(1.0, max(LEAST, (FLIGHT.steepest - elevation) / FADING))
    out, above = (1.0 - depower) / sqrt(FLIGHT.tension_over_squared_speed), speed + back
    if above <= 0.0:
        return 0.0
    return (2.0 * above / (out + sqrt(out**2 + 4.0 * above * back / FLIGHT.reel_in_tension))) ** 2


def pull(speed, depower, position):
    """Force of the motor at the tether [N], `winch_force`: that tension less the friction; position : of the kite [m]."""
    tension = tension_for(speed, depower, atan2(position[2], hypot(*position[:2])))
    friction = DRUM.viscous_friction * speed + DRUM.coulomb_friction * speed / hypot(speed, CRAWL)
    most = DRUM.torque_limit / DRUM.drum_radius
    return min(max(tension - friction, -most), most)
