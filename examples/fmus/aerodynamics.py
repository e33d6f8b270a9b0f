"""A soft kite as a point with a heading: lift and drag in the apparent wind, a turn rate from the steering.

Apparent wind v_a = f(z) v_w - v, dynamic pressure q = rho(z) |v_a|^2/2, both at the height of the kite. The heading x is
a unit vector across the direction r from the ground station to the kite, the span of the wing y = r x x.

    lift      q S C_L  along y x v_a: across the apparent wind, away from the ground station
    drag      q S C_D (1 + k |u|)  along v_a
    turning   the heading turns about r by c1 |v_a| u + (c2/|v_a|) sin(psi) cos(beta)

u steering, positive turns right as seen from the ground station; psi heading from the direction to the zenith, positive
to the right; beta elevation. C_L and C_D go linearly from powered to depowered with `depower`. If the wing slips, the
lift tilts with its span, and pulls the motion towards the heading.

Sources. Wing: the 25 m2 kite V2 of TU Delft, 19.6 kg, by van der Vlugt et al. (Renewable Energy 131, 2019; arXiv
1705.04133). Turn rate law: Erhard and Strauch (arXiv 1202.3641), Jehle and Schmehl (J. Guidance, Control and Dynamics 37,
2014). c1, c2: KiteControllers.jl, kite of 20 m2 (`fpc_settings_hydra20.yaml`). k: Fechner et al. (Renewable Energy 83,
2015).
"""

from dataclasses import dataclass
from math import atan2, cos, pi, sin, sqrt

from tetherfmu.runtime.quantities import check, quantity

from .air import density, wind_factor
from .model_slave import Refused

SLOWEST = 1.0  # apparent wind below which the weight does not turn the kite faster [m/s]


@dataclass(frozen=True)
class Wing:
    """A soft kite."""

    wing_area: float = quantity(19.8, "m2", "projected area S of the wing", 1e-6, 1e5)
    powered_lift: float = quantity(0.59, "", "lift coefficient C_L of the powered kite", 0.0, 10.0)
    powered_drag: float = quantity(0.164, "", "drag coefficient C_D of the powered kite, lift over 3.6", 0.0, 10.0)
    depowered_lift: float = quantity(0.15, "", "lift coefficient C_L of the depowered kite", 0.0, 10.0)
    depowered_drag: float = quantity(0.043, "", "drag coefficient C_D of the depowered kite, lift over 3.5", 0.0, 10.0)
    steering_drag: float = quantity(0.6, "", "part of the drag that full steering adds", 0.0, 10.0)
    turning: float = quantity(0.0613, "rad/m", "c1 of the turn rate law", 0.0)
    turning_by_weight: float = quantity(1.226, "m/s2", "c2 of the turn rate law: weight turns the nose down", 0.0)
    initial_heading: float = quantity(0.0, "rad", "heading at the start, from the zenith to the right", -pi, pi)

    def __post_init__(self):
        check(self)


def dot(a, b):
    """Scalar product of two vectors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    """Vector product of two vectors."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def norm(a):
    """Length of a vector."""
    return sqrt(dot(a, a))


def unit(a):
    """A vector over its length; Refused if it has none."""
    length = norm(a)
    if length == 0.0:
        raise Refused("the kite is at the ground station, or its heading points away from there: no direction is left")
    return a[0] / length, a[1] / length, a[2] / length


def angle_of(direction, r):
    """Angle from the zenith to the right, as seen from the ground station, of what a vector has across r [rad]."""
    return atan2(rightward(direction, r), direction[2] - dot(direction, r) * r[2])


def rightward(direction, r):
    """Component along r x z, which points to the right and is cos(beta) long: of a heading sin(psi) cos(beta)."""
    return direction[0] * r[1] - direction[1] * r[0]


def first_heading(position, angle):
    """Heading, a unit vector across the position, at an angle from the zenith to the right [rad]."""
    r = unit(position)
    to_zenith = (-r[2] * r[0], -r[2] * r[1], 1.0 - r[2] * r[2])
    if dot(to_zenith, to_zenith) < 1e-24:
        to_zenith = (-1.0, 0.0, 0.0)  # of a kite in the zenith every direction is horizontal
    return turned(unit(to_zenith), r, angle)


def turned(heading, r, angle):
    """Heading after a turn about r [rad], across r: what it has along r is taken away."""
    along = dot(heading, r)
    x = unit((heading[0] - along * r[0], heading[1] - along * r[1], heading[2] - along * r[2]))
    y = cross(r, x)
    c, s = cos(angle), sin(angle)
    return c * x[0] + s * y[0], c * x[1] + s * y[1], c * x[2] + s * y[2]


def apparent_wind(position, velocity, wind, air):
    """Wind that the kite feels [m/s]; wind [m/s] at the reference height."""
    factor = wind_factor(position[2], air)
    return factor * wind[0] - velocity[0], factor * wind[1] - velocity[1], factor * wind[2] - velocity[2]


def turn_rate(r, heading, felt, steering, wing):
    """Turn rate of the heading about the direction r to the kite [rad/s]; felt : apparent wind [m/s]."""
    speed = max(norm(felt), SLOWEST)
    return wing.turning * speed * steering + wing.turning_by_weight / speed * rightward(heading, r)


def load(position, heading, felt, steering, depower, known):
    """Lift plus drag [N]; felt : apparent wind [m/s].  known : parameters of `Wing` and `Environment`."""
    squared = dot(felt, felt)
    span = cross(unit(position), heading)
    across = cross(span, felt)
    length = norm(across)
    area = 0.5 * density(position[2], known) * known.wing_area
    lift = known.powered_lift + depower * (known.depowered_lift - known.powered_lift)
    drag = known.powered_drag + depower * (known.depowered_drag - known.powered_drag)
    along = area * drag * (1.0 + known.steering_drag * abs(steering)) * sqrt(squared)
    upward = area * lift * squared / length if length > 0.0 else 0.0
    return along * felt[0] + upward * across[0], along * felt[1] + upward * across[1], along * felt[2] + upward * across[2]
