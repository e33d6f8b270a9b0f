"""PythonFMU slave: a kite that moves along a circle or a figure of eight, for a first system of two FMUs.

    circle           p = R (cos(a) c + sin(a) (cos(phi) e1 + sin(phi) e2))
    figure of eight  p = R d(azimuth + a sin(phi), elevation + b sin(2 phi))

R distance, c direction to the centre, e1 horizontal and e2 upward across it, d(azimuth, elevation) a direction;
a `half_width`, b `half_height`, phi rate times time. The start values are the circle of
`examples/first_flight/circular_flight.py`.
"""

from dataclasses import dataclass
from math import cos, pi, radians, sin

from tetherfmu.runtime.quantities import DEGREES, check, quantity
from tetherfmu.wiring.variables import OUTPUT

from .model_slave import ModelSlave, vector

CIRCLE, FIGURE_OF_EIGHT = 1, 2


@dataclass(frozen=True)
class Path:
    """Where the kite moves."""

    path: int = quantity(
        CIRCLE,
        "",
        "shape of the path",
        choices={"circle": "circle around the centre", "figure_of_eight": "figure of eight that lies at the centre"},
    )
    distance: float = quantity(500.0, "m", "distance R from the ground station", 1e-3, 1e5)
    elevation: float = quantity(radians(20.0), "rad", "elevation of the centre", -0.5 * pi, 0.5 * pi, display=DEGREES)
    azimuth: float = quantity(-0.5 * pi, "rad", "azimuth of the centre, from the x axis", -pi, pi, display=DEGREES)
    half_width: float = quantity(radians(10.0), "rad", "half angle of the circle, or of the width", 0.0, pi, display=DEGREES)
    half_height: float = quantity(
        radians(5.0), "rad", "half angle of the height of the eight", 0.0, 0.5 * pi, display=DEGREES
    )
    rate: float = quantity(0.05, "rad/s", "rate of phi", -1e3, 1e3)

    def __post_init__(self):
        check(self)


def on_circle(path, phi):
    """Position [m] and velocity [m/s]."""
    c, e1, e2 = frame(path.azimuth, path.elevation)
    near, far = path.distance * cos(path.half_width), path.distance * sin(path.half_width)
    right, up, speed = far * cos(phi), far * sin(phi), path.rate
    position = [near * x + right * y + up * z for x, y, z in zip(c, e1, e2, strict=True)]
    return position, [speed * (right * z - up * y) for y, z in zip(e1, e2, strict=True)]


def on_figure_of_eight(path, phi):
    """Position [m] and velocity [m/s]."""
    across, upward = path.half_width * sin(phi), path.half_height * sin(2.0 * phi)
    c, e1, e2 = frame(path.azimuth + across, path.elevation + upward)
    turning = path.rate * path.half_width * cos(phi) * cos(path.elevation + upward)
    rising = path.rate * 2.0 * path.half_height * cos(2.0 * phi)
    return [path.distance * x for x in c], [path.distance * (turning * y + rising * z) for y, z in zip(e1, e2, strict=True)]


def frame(azimuth, elevation):
    """Direction with this azimuth and elevation [rad], and the directions in which they grow: three unit vectors."""
    ca, sa, ce, se = cos(azimuth), sin(azimuth), cos(elevation), sin(elevation)
    return (ce * ca, ce * sa, se), (-sa, ca, 0.0), (-se * ca, -se * sa, ce)


class KiteOnPath(ModelSlave):
    """A kite that moves along a given path."""

    description = (
        "A kite that moves along a circle or a figure of eight. It feels no force. "
        "Out: its position and velocity, which lead a tether with a driven kite end."
    )
    outputs = (
        vector(OUTPUT, "kite_position", "m", "position of the kite", depends_on=tuple(Path.__dataclass_fields__)[:6]),
        vector(OUTPUT, "kite_velocity", "m/s", "velocity of the kite", depends_on=tuple(Path.__dataclass_fields__)),
    )
    records = (Path,)
    memory = 1  # time since the start

    def first(self, inputs):
        """Where the path begins."""
        return self._at(0.0)

    def next(self, begin, end, step, outputs, memory):
        """Where the path is at the end of the step."""
        return self._at(memory[0] + step)

    def _at(self, time):
        follow = on_circle if self.parameters.path == CIRCLE else on_figure_of_eight
        position, velocity = follow(self.parameters, self.parameters.rate * time)
        return (*position, *velocity), (time,)
