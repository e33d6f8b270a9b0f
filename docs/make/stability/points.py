"""Points of the stability map: random tethers, flights and solvers at the extremes of what an importer may ask for.

A point is made from a seed and its number alone: the same point whatever the number of points, the control of the winch,
the ground and the slack stiffness ratio, which are axes with few values: each combination is a map of its own. The path: a
circle on the sphere around the ground station, whose radius follows the reeled length, so that slack stays.

With ground, its height is below both ends wherever they are led; a tether with a free kite stands for the straight one,
which ignores it: the kite begins on the circle and is then pulled along the tether by a constant force, or by none.
"""

from collections import namedtuple
from math import ceil, exp, log, pi, sin
from types import SimpleNamespace

import numpy as np

from tetherfmu.runtime.layout import MAX_SEGMENTS, MIN_SEGMENT_LENGTH, WINCH_BY_SPEED
from tetherfmu.runtime.parameters import Tether

CALLS = 30  # communication steps of a flight
SHARPEST_TURN = 0.3  # [rad] of the kite on its circle in one communication step
MOST_REELED = 0.5  # of the length during a flight
LONGEST_SEGMENT = 1000.0  # [m]
VARIANTS = ("dynamic", "dynamic_fixed_step", "quasi_steady", "catenary", "straight")
FREE = "dynamic_free"
VARIANTS_ON_GROUND = ("dynamic", "dynamic_fixed_step", FREE, "quasi_steady", "catenary")
EARTH = 9.81  # [m/s2] where there is ground but no gravity
SLACK_RATIO = Tether().slack_stiffness_ratio  # [-]


def segments_of(p):
    """Fewest and most segments for the length of a point, as numbers that need not be whole."""
    return max(1.0, p.length / LONGEST_SEGMENT), min(MAX_SEGMENTS, p.length / MIN_SEGMENT_LENGTH)


def fastest(p):
    """Largest speed of the kite across the tether [m/s]."""
    return min(150.0, SHARPEST_TURN * (p.length / (1.0 + p.slack) * sin(p.cone)) / p.step)


def reeling(p):
    """Largest reel-out speed [m/s]."""
    return min(20.0, MOST_REELED * p.length / (CALLS * p.step))


def fixed_steps(p):
    """Whole parts of the communication step [s]; 0 for a solver that chooses its steps."""
    return [p.step / parts for parts in range(1, 9)] if p.variant == "dynamic_fixed_step" else [0.0]


# In the order in which they are drawn: uniform on a scale between two bounds, or values and their shares, which may be
# functions of what was drawn before; then pairs of a probability and what is taken instead. SI units, angles in rad.
AXES = {
    "variant": ("choice", VARIANTS, (0.4, 0.3, 0.15, 0.075, 0.075)),
    "length": ("log", 1.0, 1e4),
    "segments": ("log", lambda p: segments_of(p)[0], lambda p: segments_of(p)[1] + 1.0),
    "slack": ("linear", -0.01, 0.9, (0.5, ("linear", -0.01, 0.05))),  # L/d - 1 for the distance d of the ends
    "step": ("log", 1e-4, 1.0),  # communication step
    "cone": ("linear", pi / 18.0, pi / 4.0),  # half angle of the circle
    "speed": ("linear", 0.0, fastest, (0.1, 0.0)),  # of the kite across the tether
    "axial_stiffness": ("log", 1e3, 1e9),
    "axial_damping": ("log", 0.1, 1e5, (0.1, 0.0)),
    "fixed_step": ("choice", fixed_steps, (0.125,) * 8),
    "relative_tolerance": ("log", 1e-6, 1e-2, (0.7, 1e-4)),
    "initial_shape": ("choice", (2, 1, 3), (0.5, 0.3, 0.2)),  # quasi_steady, static_equilibrium, straight
    "wind": ("linear", 0.0, 60.0, (0.1, 0.0)),
    "wind_azimuth": ("linear", -pi, pi),
    "reel_out_speed": ("linear", lambda p: -reeling(p), reeling, (0.3, 0.0)),
    "gravity": ("linear", 0.0, 25.0, (0.05, 0.0), (0.3, 9.81)),
    "elevation": ("linear", pi / 18.0, pi / 3.0),  # of the axis of the circle
    "phase": ("linear", -pi, pi),
    "winch_mass": ("log", 0.1, 1e4, (0.3, 0.0)),  # this and the following count where force controls the winch
    "winch_damping": ("log", 0.1, 1e3, (0.5, 0.0)),
    "winch_friction": ("log", 0.1, 1e3, (0.5, 0.0)),
    "force_ratio": ("log", 0.5, 5.0),  # of the force to the tension at the start plus the weight
    "ground_depth": ("choice", (0.0, 4.0), (0.5, 0.5)),  # below the ends; with ground, as all that follow
    "ground_friction": ("choice", (0.0, 0.5, 1.0), (0.25, 0.5, 0.25)),
    "ground_sink": ("log", 5e-4, 1e-2),
    "kite_mass": ("log", 0.1, 1e3),  # of a free kite
    "load_ratio": ("linear", 0.0, 3.0, (0.3, 0.0)),  # of the force on a free kite to the weight of kite and tether
}


class MapPoint(namedtuple("MapPoint", ("seed", "number", "control", "ground", "slack_stiffness_ratio", *AXES))):
    """One flight. `number`, `seed`, `control` of its winch (`winch_control`), `ground` and slack ratio make it again.

    ground : whether there is a ground (`ground_contact`).  slack_stiffness_ratio : of the tether [-]; 0 also removes the
    damping of slack segments.
    """

    @property
    def kite_is_free(self):
        """Whether the kite end moves by itself after the start."""
        return self.variant == FREE

    @property
    def segment_length(self):
        """Unstretched length of a segment at the start [m]."""
        return self.length / self.segments

    @property
    def distance(self):
        """Distance of the two ends at the start [m]."""
        return self.length / (1.0 + self.slack)


def draw(random, p, scale, low, high, *instead):
    """A number on one of `AXES`, for a point of which those before are drawn."""
    instead = [(share, draw(random, p, *other) if isinstance(other, tuple) else other) for share, other in instead]
    low, high = (bound(p) if callable(bound) else bound for bound in (low, high))
    if scale == "choice":
        value = low[random.choice(len(low), p=high)] if len(low) > 1 else low[0]
    else:
        value = exp(random.uniform(log(low), log(high))) if scale == "log" else random.uniform(low, high)
    for share, other in instead:
        value = other if random.uniform() < share else value
    return value


def point(seed, number, control=WINCH_BY_SPEED, ground=False, slack_ratio=SLACK_RATIO):
    """Point `number` of the map with this seed; the same flight in each map, see the head of this file.

    slack_ratio : its `slack_stiffness_ratio` [-].
    """
    random = np.random.default_rng((seed, number))
    p = SimpleNamespace(seed=seed, number=number, control=control, ground=ground, slack_stiffness_ratio=slack_ratio)
    for name, axis in AXES.items():
        setattr(p, name, draw(random, p, *axis))
    fewest, most = segments_of(p)
    p.segments = max(ceil(fewest), min(int(most), int(p.segments)))
    if ground:
        p.variant = p.variant if p.variant in VARIANTS_ON_GROUND else FREE
        p.gravity = p.gravity or EARTH
    return MapPoint(**vars(p))


def kite(point, time):
    """Position [m] and velocity [m/s] of the kite at a time [s] of the flight; arrays of 3."""
    ratio = 1.0 / (1.0 + point.slack)
    distance = ratio * (point.length + point.reel_out_speed * time)
    rate = point.speed / (point.distance * np.sin(point.cone))
    angle = point.phase + rate * time
    axis = np.array((np.cos(point.elevation), 0.0, np.sin(point.elevation)))
    up = np.array((-np.sin(point.elevation), 0.0, np.cos(point.elevation)))
    side = np.array((0.0, 1.0, 0.0))
    direction = np.cos(point.cone) * axis + np.sin(point.cone) * (np.cos(angle) * side + np.sin(angle) * up)
    turning = rate * np.sin(point.cone) * (np.cos(angle) * up - np.sin(angle) * side)
    return distance * direction, ratio * point.reel_out_speed * direction + distance * turning


def ground_height(point):
    """Height [m] of the ground: so far below the lowest place of the ends, also where the path is extrapolated to."""
    lowest = 0.0
    for k in range(1 if point.kite_is_free else CALLS + 1):
        position, velocity = kite(point, k * point.step)
        lowest = min(lowest, position[2], position[2] + point.step * velocity[2])
    return lowest - point.ground_depth
