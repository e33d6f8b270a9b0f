"""PythonFMU slave: the soft kite with its own mass, moved by the force of a tether with a driven kite end."""

from dataclasses import dataclass
from math import ceil

from tetherfmu.runtime.parameters import Environment
from tetherfmu.runtime.quantities import check, quantity
from tetherfmu.wiring.variables import INPUT, OUTPUT, PARAMETER

from .aerodynamics import Wing, angle_of, apparent_wind, first_heading, load, norm, turn_rate, turned, unit
from .model_slave import ModelSlave, Refused, names, vector
from .point_mass_kite import CONTROL, flight_outputs

LONGEST = 0.01  # internal step [s]
MOST = 100_000  # internal steps in a communication step
POSITION = vector(PARAMETER, "initial_kite_position", "m", "position of the kite at the start", (300.0, 0.0, 400.0))
VELOCITY = vector(PARAMETER, "initial_kite_velocity", "m/s", "velocity of the kite at the start", (0.0, 0.0, 0.0))


@dataclass(frozen=True)
class Mass:
    """What the kite weighs."""

    kite_mass: float = quantity(19.6, "kg", "mass of the kite", 1e-3, 1e9)

    def __post_init__(self):
        check(self)


def moved(position, velocity, before, after, step):
    """Position and velocity after a step in which the acceleration goes linearly from `before` to `after`."""
    motion = zip(position, velocity, before, after, strict=True)
    ahead = [x + step * (v + step * (2.0 * a + b) / 6.0) for x, v, a, b in motion]
    return ahead, [v + 0.5 * step * (a + b) for v, a, b in zip(velocity, before, after, strict=True)]


class FlyingKite(ModelSlave):
    """A soft kite with mass."""

    description = (
        "A soft kite with mass, a point with a heading that steering turns. "
        "In: force of the tether on the kite, wind, steering, depower. "
        "Out: position and velocity of the kite, which lead a tether with a driven kite end."
    )
    inputs = (vector(INPUT, "kite_force", "N", "force of the tether on the kite", (0.0, 0.0, 0.0)), *CONTROL)
    outputs = (
        *(
            vector(OUTPUT, f"kite_{name}", unit, f"{name} of the kite", depends_on=names(parameter))
            for name, unit, parameter in (("position", "m", POSITION), ("velocity", "m/s", VELOCITY))
        ),
        *flight_outputs(*names(POSITION, VELOCITY)),
    )
    records = (Mass, Wing, Environment)
    vectors = (POSITION, VELOCITY)
    memory = 3  # heading

    def first(self, inputs):
        """The motion at the start is given."""
        start = [getattr(self.parameters, name) for name in names(*self.vectors)]
        return self._outputs(start[:3], start[3:], first_heading(start[:3], self.parameters.initial_heading), inputs)

    def next(self, begin, end, step, outputs, memory):
        """Predictor and corrector in steps of at most 10 ms; force, wind and steering go linearly from begin to end."""
        position, velocity, heading = outputs[:3], outputs[3:6], memory
        count = ceil(step / LONGEST - 1e-6)
        if count > MOST:
            raise Refused(f"the communication step is {step} s; it must be at most {MOST * LONGEST:g} s")
        h, slope = step / count, [(b - a) / count for a, b in zip(begin, end, strict=True)]
        before = begin
        for k in range(count):
            after = [a + (k + 1) * s for a, s in zip(begin, slope, strict=True)]
            acceleration, rate = self._rates(position, velocity, heading, before)
            ahead, faster = moved(position, velocity, acceleration, acceleration, h)
            there, rate_there = self._rates(ahead, faster, turned(heading, unit(ahead), h * rate), after)
            position, velocity = moved(position, velocity, acceleration, there, h)
            heading = turned(heading, unit(position), 0.5 * h * (rate + rate_there))
            before = after
        return self._outputs(position, velocity, heading, end)

    def _rates(self, position, velocity, heading, inputs):
        """Acceleration [m/s2] and turn rate [rad/s]."""
        known, steering = self.parameters, inputs[6]
        felt = apparent_wind(position, velocity, inputs[3:6], known)
        force = load(position, heading, felt, steering, inputs[7], known)
        x, y, z = ((f + g) / known.kite_mass for f, g in zip(force, inputs[:3], strict=True))
        return (x, y, z - known.gravity), turn_rate(unit(position), heading, felt, steering, known)

    def _outputs(self, position, velocity, heading, inputs):
        speed = norm(apparent_wind(position, velocity, inputs[3:6], self.parameters))
        return (*position, *velocity, angle_of(heading, unit(position)), speed), heading
