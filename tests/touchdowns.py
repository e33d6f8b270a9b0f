"""Tethers on a flat ground whose catenary has a closed form: scenes for the tests of touchdowns."""

import numpy as np

from mechanics import line_density
from tetherfmu import Tether, TetherCatenary

GRAVITY = 9.81
ROPE = Tether(initial_length=100.0, axial_stiffness=1e5)
WEIGHT = line_density(ROPE) * GRAVITY  # per unstretched length [N/m]


def over_ground(tether, friction=0.0, height=0.0, points=0, model=TetherCatenary):
    """A tether over a ground at a height [m]."""
    return model(tether, ground_contact="flat", ground_friction=friction, ground_height=height, shape_points=points)


def between(model, ground, kite, wind=(0.0, 0.0, 0.0)):
    """Outputs of a tether at rest between two ends [m] in a wind [m/s]."""
    return model.initialize(ground_position=ground, kite_position=kite, wind_velocity=wind)


def held(tether, ground, kite, friction=0.0, wind=(0.0, 0.0, 0.0), height=0.0, points=0, model=TetherCatenary):
    """Outputs of a tether that lies on a ground at a height [m] between two ends [m]."""
    return between(over_ground(tether, friction, height, points, model), ground, kite, wind)


def random_scene(random):
    """Tether, ends [m], friction, wind [m/s] and height of the ground [m] of a tether that is likely to touch it."""
    length = 10.0 ** random.uniform(1.0, 3.0)
    tether = Tether(initial_length=length, axial_stiffness=10.0 ** random.uniform(3.0, 7.0))
    heights = length * np.array([random.choice([0.0, random.uniform(0.0, 0.3)]), random.uniform(0.0, 0.8)])
    random.shuffle(heights)
    out, azimuth = length * random.uniform(0.0, 1.0), random.uniform(-np.pi, np.pi)
    height = random.uniform(-50.0, 50.0)
    ground = np.array([*random.uniform(-50.0, 50.0, 2), height + heights[0]])
    kite = np.array([ground[0] + out * np.cos(azimuth), ground[1] + out * np.sin(azimuth), height + heights[1]])
    wind = random.choice([0.0, 2.0, 8.0]) * random.normal(size=3) * (1.0, 1.0, 0.3)
    return tether, ground, kite, random.choice([0.0, random.uniform(0.0, 1.5)]), wind, height


def forces(outputs):
    """Forces on both ends [N], sag and length on the ground [m]."""
    return [*outputs.ground_force, *outputs.kite_force, outputs.sag, outputs.grounded_length]
