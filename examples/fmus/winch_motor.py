"""PythonFMU slave: motor of a pumping kite's winch, whose drum is inside the tether (`winch_control` = force).

The flight controller requests a speed s(T) at the tension T. The motor force W lets a drum of mass m move as one of mass m'
that is held by the tension T', at which its speed is requested:

    W = T - (T - T') m/m' - friction,   s(T') = s + (T - T') h/m'

The right side is the speed at the end of the next communication step, h long. T and s at its start suffice as long as m' is
not much less than m.

Sources: s(T) of `FlightController`, drum of `Winch`.
"""

from dataclasses import dataclass
from math import atan2, hypot, sqrt

from tetherfmu.runtime.quantities import check, quantity
from tetherfmu.wiring.variables import INPUT, OUTPUT

from .flight_controller import FADING, MOTION, TENSION, Flight
from .model_slave import ModelSlave, names, scalar
from .winch import CRAWL, Drum

LAW = ("tension_over_squared_speed", "reel_in_speed", "reel_in_tension", "steepest")  # what is taken of `Flight`
DRUM = ("drum_radius", "inertia", "viscous_friction", "coulomb_friction", "torque_limit", "largest_acceleration")
HALVINGS = 50  # of the interval in which T' is: to the last digit


@dataclass(frozen=True)
class Feel:
    """How the drum is made to feel."""

    felt_share: float = quantity(
        1.0 / 3.0, "", "mass m' that the drum is made to feel, over its own; 1 follows the controller in 1.3 s", 0.01, 100.0
    )

    def __post_init__(self):
        check(self)


def wanted_speed(tension, depower, elevation, flight):
    """Reel-out speed s [m/s] that the flight controller wants for a tension [N], at an elevation of the kite [rad]."""
    out = sqrt(max(tension, 0.0) / flight.tension_over_squared_speed)
    back = flight.reel_in_speed * max(0.0, 1.0 - max(tension, 0.0) / flight.reel_in_tension)
    return (1.0 - depower) * out - depower * back * min(1.0, max(0.0, (flight.steepest - elevation) / FADING))


def pull(tension, speed, depower, position, step, motor):
    """`winch_force` [N] in a step [s] that starts with this tension [N], drum speed [m/s], and position of the kite [m].

    motor : parameters of `WinchMotor`.
    """
    mass, largest = motor.inertia / motor.drum_radius**2, motor.torque_limit / motor.drum_radius
    felt, elevation = motor.felt_share * mass, atan2(position[2], hypot(*position[:2]))
    change = felt * motor.largest_acceleration
    low, high = tension - change, tension + change
    for _ in range(HALVINGS):  # bisection for T': s(T') rises with it, the other side falls
        middle = 0.5 * (low + high)
        above = wanted_speed(middle, depower, elevation, motor) > speed + (tension - middle) * step / felt
        low, high = (low, middle) if above else (middle, high)
    friction = motor.viscous_friction * speed + motor.coulomb_friction * speed / hypot(speed, CRAWL)
    return min(max(tension - (tension - high) * mass / felt - friction, -largest), largest)


class WinchMotor(ModelSlave):
    """The motor of a drum inside the tether, which makes the drum follow a flight controller."""

    description = (
        "Motor of a winch whose drum is inside the tether (winch_control = force), for the kite of FlightController. "
        "In: tension, speed of the drum, position and depower of the kite. Out: force of the winch, power, energy."
    )
    inputs = (
        MOTION[0],
        TENSION,
        scalar(INPUT, "winch_speed", "m/s", "reel-out speed of the drum", start=0.0),
        scalar(INPUT, "depower", "", "0: full lift, 1: depowered", 0.0, 1.0, start=0.0),
    )
    outputs = (
        scalar(
            OUTPUT,
            "winch_force",
            "N",
            "force with which the winch pulls at the tether, positive reels in",
            depends_on=(*names(MOTION[0], TENSION), "winch_speed", "depower", *LAW, *DRUM, "felt_share"),
        ),
        scalar(OUTPUT, "power", "W", "tension times reel-out speed", depends_on=("ground_tension", "winch_speed")),
        scalar(OUTPUT, "energy", "J", "integral of the power since the start"),
    )
    records = (Drum, Flight, Feel)
    left_out = tuple(
        name for record, taken in ((Drum, DRUM), (Flight, LAW)) for name in record.__dataclass_fields__ if name not in taken
    )

    def first(self, inputs):
        """As if the next step were short."""
        return self._driven(inputs, 0.0, 0.0), ()

    def next(self, begin, end, step, outputs, memory):
        """For a step like this one; the energy by the trapezoidal rule."""
        return self._driven(end, step, outputs[2] + 0.5 * (outputs[1] + end[3] * end[4]) * step), ()

    def _driven(self, inputs, step, energy):
        *position, tension, speed, depower = inputs
        return pull(tension, speed, depower, position, step, self.parameters), tension * speed, energy
