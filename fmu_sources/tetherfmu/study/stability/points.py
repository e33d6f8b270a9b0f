"""Points of the stability map: random tethers, flights and solvers at the extremes of what an importer may ask for.

A point is made from a seed and its number alone: the same point whatever the number of points. Axes without another note are
uniform in the logarithm; the values in brackets are taken with the probability that stands before them.

====================  =================================================================================================
variant, solver       dynamic adaptive (40 %), dynamic fixed step (30 %), quasi-steady (15 %), catenary, straight (7.5 %)
length                1 m to 10 km
segments              1 to 300, segments of 0.01 m to 1 km
axial_stiffness       1e3 to 1e9 N
axial_damping         0.1 to 1e5 N s (10 %: 0)
slack                 L/d - 1 for the distance d of the ends, uniform from -1 to 90 % (half of them: -1 to 5 %)
step                  communication step, 1e-4 to 1 s;  fixed_step: a whole part of it, 1 to 8
wind                  uniform, 0 to 60 m/s (10 %: 0)
speed                 of the kite across the tether, uniform, 0 to 150 m/s (10 %: 0); at most `SHARPEST_TURN` in a step
reel_out_speed        uniform, -20 to 20 m/s (30 %: 0); at most half of the length is reeled during the flight
gravity               uniform, 0 to 25 m/s2 (30 %: 9.81; 5 %: 0)
initial_shape         quasi_steady (50 %), static_equilibrium (30 %), straight (20 %)
relative_tolerance    1e-4 (70 %), else 1e-6 to 1e-2
====================  =================================================================================================

The path: a circle on the sphere around the ground station, whose radius follows the reeled length, so that slack stays.
"""

from collections import namedtuple
from math import ceil, exp, log, pi, sin

import numpy as np

from tetherfmu.runtime.layout import MAX_SEGMENTS, MIN_SEGMENT_LENGTH

CALLS = 30  # communication steps of a flight
SHARPEST_TURN = 0.3  # [rad] of the kite on its circle in one communication step
MOST_REELED = 0.5  # of the length during a flight
LONGEST_SEGMENT = 1000.0  # [m]
VARIANTS = ("dynamic", "dynamic_fixed_step", "quasi_steady", "catenary", "straight")
SHARES = (0.4, 0.3, 0.15, 0.075, 0.075)


class MapPoint(
    namedtuple(
        "MapPoint",
        "seed number variant segments length axial_stiffness axial_damping slack step fixed_step relative_tolerance "
        "initial_shape wind wind_azimuth speed reel_out_speed gravity elevation cone phase",
    )
):
    """One flight, SI units; angles in rad. `number` and `seed` make it again."""

    @property
    def segment_length(self):
        """Unstretched length of a segment at the start [m]."""
        return self.length / self.segments

    @property
    def distance(self):
        """Distance of the two ends at the start [m]."""
        return self.length / (1.0 + self.slack)


def point(seed, number):
    """Point `number` of the map with this seed; each axis is drawn whether it is used or not, in a fixed order."""
    random = np.random.default_rng((seed, number))

    def logarithmic(low, high):
        return exp(random.uniform(log(low), log(high)))

    def chosen(choices, shares):
        return choices[random.choice(len(choices), p=shares)]

    def unless(share, special, value):
        return special if random.uniform() < share else value

    variant = chosen(VARIANTS, SHARES)
    length = logarithmic(1.0, 1e4)
    fewest = max(1.0, length / LONGEST_SEGMENT)
    most = min(MAX_SEGMENTS, length / MIN_SEGMENT_LENGTH)
    segments = max(ceil(fewest), min(int(most), int(logarithmic(fewest, most + 1.0))))
    slack = unless(0.5, random.uniform(-0.01, 0.05), random.uniform(-0.01, 0.9))
    step = logarithmic(1e-4, 1.0)
    cone = random.uniform(pi / 18.0, pi / 4.0)
    radius = length / (1.0 + slack) * sin(cone)
    fastest = SHARPEST_TURN * radius / step
    speed = unless(0.1, 0.0, random.uniform(0.0, min(150.0, fastest)))
    reeling = min(20.0, MOST_REELED * length / (CALLS * step))
    return MapPoint(
        seed=seed,
        number=number,
        variant=variant,
        segments=segments,
        length=length,
        axial_stiffness=logarithmic(1e3, 1e9),
        axial_damping=unless(0.1, 0.0, logarithmic(0.1, 1e5)),
        slack=slack,
        step=step,
        fixed_step=step / chosen(range(1, 9), [0.125] * 8) if variant == "dynamic_fixed_step" else 0.0,
        relative_tolerance=unless(0.7, 1e-4, logarithmic(1e-6, 1e-2)),
        initial_shape=chosen((2, 1, 3), (0.5, 0.3, 0.2)),
        wind=unless(0.1, 0.0, random.uniform(0.0, 60.0)),
        wind_azimuth=random.uniform(-pi, pi),
        speed=speed,
        reel_out_speed=unless(0.3, 0.0, random.uniform(-reeling, reeling)),
        gravity=unless(0.3, 9.81, unless(0.05, 0.0, random.uniform(0.0, 25.0))),
        elevation=random.uniform(pi / 18.0, pi / 3.0),
        cone=cone,
        phase=random.uniform(-pi, pi),
    )


def kite(point, time):
    """Position [m] and velocity [m/s] of the kite at a time [s] of the flight; arrays of 3."""
    ratio = 1.0 / (1.0 + point.slack)
    distance = ratio * (point.length + point.reel_out_speed * time)
    rate = point.speed / (point.distance * np.sin(point.cone))
    angle = point.phase + rate * time
    axis = np.array((np.cos(point.elevation), 0.0, np.sin(point.elevation)))
    up = np.array((-np.sin(point.elevation), 0.0, np.cos(point.elevation)))
    side = np.array((0.0, 1.0, 0.0))
    around = np.cos(angle) * side + np.sin(angle) * up
    direction = np.cos(point.cone) * axis + np.sin(point.cone) * around
    turning = rate * np.sin(point.cone) * (np.cos(angle) * up - np.sin(angle) * side)
    return distance * direction, ratio * point.reel_out_speed * direction + distance * turning


def wind(point):
    """Wind [m/s], array of 3."""
    return point.wind * np.array((np.cos(point.wind_azimuth), np.sin(point.wind_azimuth), 0.0))
