"""PythonFMU slave: a winch, a drum with inertia, friction and a motor of limited torque.

    m ds/dt = T - F - c s - f s/sqrt(s^2 + s0^2),   m = I/r^2

s reel-out speed, T tether tension, F = torque/r motor pull. In speed control F = T + G (s - s_set), where s_set follows
`set_speed` within `largest_acceleration`; in force control F = `set_force`. Near the ends of the tether on the drum the
motor brakes with at most half of that acceleration.

Sources: law of WinchModels.jl; drum, inertia (0.204 kg.m2 at a motor behind a gear of 6.2), friction, gain and acceleration
of KiteModels.jl for the winch of Fechner et al. (Renewable Energy 83, 2015), torque from the 8000 N of its larger kite.
"""

from dataclasses import dataclass
from math import copysign, expm1, sqrt

from tetherfmu.runtime.quantities import check, quantity
from tetherfmu.wiring.variables import INPUT, OUTPUT

from .model_slave import ModelSlave, Refused, scalar

SPEED, FORCE = 1, 2
STOPPING = 0.2  # the last centimetres of the tether are reeled in no less than this time [s]
CRAWL = 0.05  # s0: below this speed Coulomb's friction fades [m/s]


@dataclass(frozen=True)
class Drum:
    """A winch."""

    control: int = quantity(
        SPEED,
        "",
        "what the motor follows",
        choices={"speed": "the set speed", "force": "the set force"},
    )
    drum_radius: float = quantity(0.1615, "m", "radius r of the drum", 1e-3, 100.0)
    inertia: float = quantity(7.84, "kg.m2", "moment of inertia I of drum, gear and motor, at the drum", 1e-6, 1e9)
    viscous_friction: float = quantity(30.6, "N.s/m", "friction c per speed of the tether", 0.0, 1e9)
    coulomb_friction: float = quantity(122.0, "N", "friction f that is the same at all speeds", 0.0, 1e9)
    torque_limit: float = quantity(1300.0, "N.m", "largest torque of the motor, at the drum", 0.0, 1e12)
    speed_gain: float = quantity(10000.0, "N.s/m", "gain G of the speed control", 0.0, 1e9)
    largest_acceleration: float = quantity(4.0, "m/s2", "of the reel-out speed in speed control", 1e-6, 1e6)
    minimum_length: float = quantity(50.0, "m", "tether_length at which reeling in ends", 0.0, 1e5)
    maximum_length: float = quantity(1000.0, "m", "tether_length that the drum holds", 0.0, 1e5)
    initial_speed: float = quantity(0.0, "m/s", "reel_out_speed at the start", -100.0, 100.0)

    def __post_init__(self):
        check(self)
        if self.minimum_length >= self.maximum_length:
            raise ValueError(
                f"minimum_length is {self.minimum_length!r}; it must be less than maximum_length ({self.maximum_length!r} m)"
            )


def relaxation(x):
    """(1 - exp(-x))/x, 1 at x = 0: how far a decay at rate x goes in a unit of time, over what its first slope would."""
    return -expm1(-x) / x if x > 0.0 else 1.0


class Winch(ModelSlave):
    """A winch between the tension of a tether and its reel-out speed."""

    description = (
        "Winch: a drum with inertia, friction and a motor of limited torque that follows a speed or a force. "
        "In: tension and length of the tether, set point. Out: reel-out speed, torque, power, energy."
    )
    inputs = (
        scalar(INPUT, "ground_tension", "N", "tension of the tether at the drum", start=0.0),
        scalar(INPUT, "tether_length", "m", "unstretched length that is off the drum", start=505.0),
        scalar(INPUT, "set_speed", "m/s", "reel-out speed that is wanted, in speed control", start=0.0),
        scalar(INPUT, "set_force", "N", "pull of the motor that is wanted, in force control", start=0.0),
    )
    outputs = (
        scalar(OUTPUT, "reel_out_speed", "m/s", "rate of the unstretched length", depends_on=("initial_speed",)),
        scalar(OUTPUT, "motor_torque", "N.m", "torque of the motor at the drum, positive pulls in"),
        scalar(OUTPUT, "power", "W", "tension times reel-out speed", depends_on=("ground_tension", "initial_speed")),
        scalar(OUTPUT, "energy", "J", "integral of the power since the start"),
    )
    records = (Drum,)
    memory = 1  # s_set

    def first(self, inputs):
        """At its first speed, without torque."""
        speed = self.parameters.initial_speed
        return (speed, 0.0, inputs[0] * speed, 0.0), (speed,)

    def next(self, begin, end, step, outputs, memory):
        """Exact solution with the mean of the inputs, torque and friction coefficient of the begin."""
        drum, speed = self.parameters, outputs[0]
        tension, length, wanted, force = (0.5 * (a + b) for a, b in zip(begin, end, strict=True))
        target, following = self._target(wanted, memory[0], length, speed, step)
        pull = tension + drum.speed_gain * (speed - target) if following else force
        largest = drum.torque_limit / drum.drum_radius
        if abs(pull) > largest:
            pull, following = copysign(largest, pull), False
        # m ds/dt = drive - resistance s
        resistance = drum.viscous_friction + drum.coulomb_friction / sqrt(speed * speed + CRAWL * CRAWL)
        drive = tension - pull
        if following:
            drive, resistance = drum.speed_gain * target, resistance + drum.speed_gain
        time = step * drum.drum_radius**2 / drum.inertia  # over m
        final = speed + (drive - resistance * speed) * time * relaxation(resistance * time)
        self._refuse_at_the_ends(end[1], final)
        power = end[0] * final
        return (final, pull * drum.drum_radius, power, outputs[3] + 0.5 * (outputs[2] + power) * step), (target,)

    def _target(self, wanted, before, length, speed, step):
        """Speed to follow, no faster than the winch can accelerate and stop in time; whether it follows it."""
        drum = self.parameters
        change = drum.largest_acceleration * step
        target = min(max(wanted, before - change), before + change) if drum.control == SPEED else speed
        left = max(drum.maximum_length - length, 0.0), max(length - drum.minimum_length, 0.0)
        out, back = (min(sqrt(drum.largest_acceleration * each), each / STOPPING) for each in left)
        if target > out:
            self.warn(f"the winch brakes: tether_length comes to maximum_length ({drum.maximum_length:g} m)")
        if target < -back:
            self.warn(f"the winch brakes: tether_length comes to minimum_length ({drum.minimum_length:g} m)")
        return min(max(target, -back), out), drum.control == SPEED or not -back <= target <= out

    def _refuse_at_the_ends(self, length, speed):
        """Refused if the winch is jammed: the tether would leave the drum, or be reeled in beyond its minimum."""
        drum = self.parameters
        if (length > drum.maximum_length and speed > 0.0) or (length < drum.minimum_length and speed < 0.0):
            raise Refused(
                f"the winch is jammed: tether_length is {length:g} m and goes on at {speed:g} m/s; it must be at least "
                f"minimum_length ({drum.minimum_length:g} m) and at most maximum_length ({drum.maximum_length:g} m), and "
                f"torque_limit ({drum.torque_limit:g} N.m) must be enough to stop it there"
            )
