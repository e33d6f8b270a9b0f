"""PythonFMU slave: flight controller of a pumping kite: figures of eight while reeling out, a climb while reeling in.

The kite is steered to a point on a figure of eight, the angle `look_ahead` in front of the kite; while reeling in, to a
point high above. A course error e requests the turn rate `course_gain` e, and the turn rate law of `aerodynamics` gives
the steering.

    traction     s = sqrt(T/K)
    reeling in   s = -s0 max(0, 1 - T/T0) min(1, (steepest - elevation)/20 deg)

T tension at the ground. A kite that pulls with C (w - s)^2 in a wind w along the tether has its largest power at s = w/3
(Loyd, J. Energy 4, 1980): K = 4 C. Reeling in slows down where the kite is high, or it would fly over the ground station. It
begins at `longest_length` and ends at `shortest_length`; depower and speed change together.

Sources: steering as in Erhard and Strauch (arXiv 1202.3641); the control unit of KiteModels.jl moves by 0.075 of its
range per second; depower uses a quarter of the range (`depower_rate`). Other values are chosen for the kite of TU Delft.
"""

from dataclasses import dataclass
from math import atan2, cos, hypot, pi, radians, sin, sqrt

from tetherfmu.runtime.quantities import DEGREES, check, quantity
from tetherfmu.wiring.variables import INPUT, OUTPUT

from .aerodynamics import angle_of, cross, dot, norm, unit
from .kite_on_path import frame
from .model_slave import ModelSlave, names, scalar, vector

TRACTION, REEL_IN = 1, 2
UPWARD = radians(100.0)  # elevation of the target while reeling in: beyond the zenith, which the kite stays below [rad]
FADING = radians(20.0)  # below `steepest`, where reeling in becomes slower [rad]
ENTRY = 0.5 * pi  # point of the figure of eight that is flown to after reeling in [rad]
SLOWEST = 3.0  # apparent wind for which the steering is computed at least [m/s]


@dataclass(frozen=True)
class Flight:
    """How a pumping kite flies."""

    shortest_length: float = quantity(200.0, "m", "tether_length at which reeling in ends", 1.0, 1e5)
    longest_length: float = quantity(350.0, "m", "tether_length at which reeling in begins", 1.0, 1e5)
    elevation: float = quantity(radians(30.0), "rad", "elevation of the figure of eight", 0.0, 1.5, display=DEGREES)
    downwind: float = quantity(0.0, "rad", "azimuth to which the wind blows", -pi, pi, display=DEGREES)
    half_width: float = quantity(radians(25.0), "rad", "half of the width of the eight", 0.0, 1.5, display=DEGREES)
    half_height: float = quantity(radians(8.0), "rad", "half of the height of the eight", 0.0, 1.0, display=DEGREES)
    look_ahead: float = quantity(radians(10.0), "rad", "angle from the kite to its target", 1e-3, 1.0, display=DEGREES)
    course_gain: float = quantity(1.5, "1/s", "turn rate over course error", 0.0, 100.0)
    turning: float = quantity(0.0613, "rad/m", "c1 of the turn rate law of the kite", 1e-6)
    turning_by_weight: float = quantity(1.226, "m/s2", "c2 of the turn rate law of the kite", 0.0)
    tension_over_squared_speed: float = quantity(
        300.0, "N.s2/m2", "K: tension of the tether over the square of the reel-out speed, in traction", 1e-6, 1e9
    )
    reel_in_speed: float = quantity(8.0, "m/s", "speed of reeling in a tether without tension", 0.0, 100.0)
    reel_in_tension: float = quantity(1800.0, "N", "tension at which reeling in comes to rest", 1.0, 1e9)
    steepest: float = quantity(radians(85.0), "rad", "elevation at which reeling in rests", 0.1, 1.57, display=DEGREES)
    depower_rate: float = quantity(0.3, "1/s", "rate of depower", 1e-3, 1e3)

    def __post_init__(self):
        check(self)
        if self.shortest_length >= self.longest_length:
            raise ValueError(
                f"shortest_length is {self.shortest_length!r}; it must be less than longest_length "
                f"({self.longest_length!r} m)"
            )


COURSE = ("elevation", "downwind", "half_width", "half_height", "look_ahead", "course_gain", "turning", "turning_by_weight")
MOTION = (
    vector(INPUT, "kite_position", "m", "position of the kite", (300.0, 0.0, 400.0)),
    scalar(INPUT, "heading", "rad", "heading of the kite, from the zenith to the right", start=0.0),
    scalar(INPUT, "apparent_wind_speed", "m/s", "wind that the kite feels", start=0.0),
)
TRACTION_LAW = "tension_over_squared_speed"
TENSION = scalar(INPUT, "ground_tension", "N", "tension of the tether at the ground", start=0.0)


def point_of_eight(flight, phi):
    """Direction to the point phi [rad] of the figure of eight, flown downwards at its sides, and its rate over phi."""
    azimuth = flight.downwind + flight.half_width * sin(phi)
    direction, _, _ = frame(azimuth, flight.elevation + flight.half_height * sin(2.0 * phi))
    across = flight.half_width * cos(phi) * cos(flight.elevation)
    return direction, hypot(across, 2.0 * flight.half_height * cos(2.0 * phi))


def angle_between(a, b):
    """Angle between two unit vectors [rad]."""
    return atan2(norm(cross(a, b)), dot(a, b))


def steering_to(target, direction, heading, speed, flight):
    """Steering that turns the kite towards a target; target, direction : unit vectors from the ground station."""
    error = (angle_of(target, direction) - heading + pi) % (2.0 * pi) - pi
    speed = max(speed, SLOWEST)
    by_weight = flight.turning_by_weight / speed * sin(heading) * hypot(direction[0], direction[1])
    return (flight.course_gain * error - by_weight) / (flight.turning * speed)


class FlightController(ModelSlave):
    """Flies a kite in pumping cycles."""

    description = (
        "Flight controller of a pumping kite: figures of eight while reeling out, a depowered climb while reeling in. "
        "In: position, heading and apparent wind speed of the kite, tension and length of the tether. "
        "Out: steering, depower, reel-out speed."
    )
    inputs = (*MOTION, TENSION, scalar(INPUT, "tether_length", "m", "unstretched length of the tether", start=505.0))
    outputs = (
        scalar(OUTPUT, "steering", "", "limited to what the kite can do", -1.0, 1.0, depends_on=(*names(*MOTION), *COURSE)),
        scalar(OUTPUT, "depower", "", "0: full lift, 1: depowered", 0.0, 1.0),
        scalar(OUTPUT, "set_speed", "m/s", "wanted reel-out speed", depends_on=(*names(TENSION), TRACTION_LAW)),
        scalar(OUTPUT, "phase", "", "1: traction, 2: reeling in", 1, 2, kind="Integer"),
    )
    records = (Flight,)
    memory = 1  # point of the figure of eight [rad]

    def first(self, inputs):
        """Powered and in traction, flying to the side of the figure of eight."""
        return self._controlled(inputs, 0.0, TRACTION, ENTRY)

    def next(self, begin, end, step, outputs, memory):
        """Steering, depower and speed for the end of the step."""
        flight, phase, phi = self.parameters, self._phase(outputs[3], end[6]), memory[0]
        change = flight.depower_rate * step
        goal = 1.0 if phase == REEL_IN else 0.0
        depower = min(max(goal, outputs[1] - change), outputs[1] + change)
        return self._controlled(end, depower, phase, ENTRY if phase == REEL_IN else phi)

    def _controlled(self, inputs, depower, phase, phi):
        flight, direction = self.parameters, unit(inputs[:3])
        heading, wind, tension, _ = inputs[3:]
        target, rate = point_of_eight(flight, phi)
        if phase == REEL_IN:
            target = frame(flight.downwind, UPWARD)[0]
        else:
            phi += max(0.0, flight.look_ahead - angle_between(direction, target)) / max(rate, flight.half_height)
            target, _ = point_of_eight(flight, phi)
        steering = steering_to(target, direction, heading, wind, flight)
        out = sqrt(max(tension, 0.0) / flight.tension_over_squared_speed)
        back = flight.reel_in_speed * max(0.0, 1.0 - tension / flight.reel_in_tension)
        back *= min(1.0, max(0.0, (flight.steepest - atan2(direction[2], hypot(*direction[:2]))) / FADING))
        set_speed = (1.0 - depower) * out - depower * back
        return (min(max(steering, -1.0), 1.0), depower, set_speed, phase), (phi % (2.0 * pi),)

    def _phase(self, phase, length):
        if length >= self.parameters.longest_length:
            return REEL_IN
        return TRACTION if length <= self.parameters.shortest_length else phase
