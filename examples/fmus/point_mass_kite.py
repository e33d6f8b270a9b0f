"""PythonFMU slave: a soft kite without mass, for `TetherDynamicFree`, which has the mass."""

from tetherfmu.runtime.parameters import Environment
from tetherfmu.wiring.variables import INPUT, OUTPUT

from .aerodynamics import Wing, angle_of, apparent_wind, first_heading, load, norm, turn_rate, turned, unit
from .model_slave import ModelSlave, names, scalar, vector

MOTION = (
    vector(INPUT, "kite_position", "m", "position of the kite", (300.0, 0.0, 400.0)),
    vector(INPUT, "kite_velocity", "m/s", "velocity of the kite", (0.0, 0.0, 0.0)),
)
CONTROL = (
    vector(INPUT, "wind_velocity", "m/s", "wind at wind_reference_height", (0.0, 0.0, 0.0)),
    scalar(INPUT, "steering", "", "steering, positive turns right as seen from the ground station", -1.0, 1.0, start=0.0),
    scalar(INPUT, "depower", "", "0: full lift, 1: depowered", 0.0, 1.0, start=0.0),
)
WING = tuple(Wing.__dataclass_fields__)
AIR = tuple(name for name in Environment.__dataclass_fields__ if name != "gravity")


def flight_outputs(*motion):
    """Outputs of a kite; motion : names of what says where it is and how fast."""
    felt = (*motion, *names(CONTROL[0]), *(name for name in AIR if not name.startswith("air_density")))
    return (
        scalar(
            OUTPUT, "heading", "rad", "heading, from the zenith to the right", depends_on=(*motion[:3], "initial_heading")
        ),
        scalar(OUTPUT, "apparent_wind_speed", "m/s", "wind that the kite feels", depends_on=felt),
    )


class PointMassKite(ModelSlave):
    """A soft kite as a load on a point mass."""

    description = (
        "Lift and drag of a soft kite, a point with a heading that steering turns. In: motion of the kite, wind, steering, "
        "depower. Out: the load on the kite, which TetherDynamicFree moves."
    )
    inputs = (*MOTION, *CONTROL)
    outputs = (
        vector(OUTPUT, "kite_load", "N", "lift and drag", depends_on=(*names(*MOTION, *CONTROL), *AIR, *WING)),
        *flight_outputs(*names(*MOTION)),
    )
    records = (Wing, Environment)
    left_out = ("gravity",)
    memory = 4  # heading, turn rate

    def first(self, inputs):
        """Load with the first heading."""
        return self._at(inputs, first_heading(inputs[:3], self.parameters.initial_heading))

    def next(self, begin, end, step, outputs, memory):
        """Turn by the mean of the turn rates at the begin and at the end, then the load at the end."""
        direction, rate = unit(end[:3]), memory[3]
        felt = apparent_wind(end[:3], end[3:6], end[6:9], self.parameters)
        ahead = turned(memory[:3], direction, rate * step)
        change = turn_rate(direction, ahead, felt, end[9], self.parameters) - rate
        return self._at(end, turned(ahead, direction, 0.5 * change * step))

    def _at(self, inputs, heading):
        known, position, steering = self.parameters, inputs[:3], inputs[9]
        direction = unit(position)
        felt = apparent_wind(position, inputs[3:6], inputs[6:9], known)
        force = load(position, heading, felt, steering, inputs[10], known)
        rate = turn_rate(direction, heading, felt, steering, known)
        return (*force, angle_of(heading, direction), norm(felt)), (*heading, rate)
