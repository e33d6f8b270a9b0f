"""Scenes that nobody has seen: flights, tethers and winds at random, always the same for a seed."""

from itertools import cycle, islice
from pathlib import Path

import numpy as np

from .files import read
from .flights import KINDS

SEED = 6
ALLOWED = (0.1, 0.03, 0.01, 0.003)
DURATION = 20.0  # [s]
FLIGHTS = {  # by kind: a number, or the limits between which it lies
    "circle": {"distance": (100, 600), "half_angle": (0.1, 0.4), "rate": (0.05, 0.5)},
    "figure_of_eight": {"distance": (150, 600), "elevation": (0.3, 0.9), "speed": (10, 45)},
    "parked": {"distance": (50, 500), "sway": (0, 10), "sway_period": (8, 30)},
    "launch": {"distance": (20, 60), "climb_time": (6, 15)},
    "landing": {"distance": 100.0, "final_distance": (60, 90), "reeled_in": (5, 9)},
    "towing": {"distance": (50, 300), "speed": (3, 20), "weave": (0, 0.3)},
    "reel": {"distance": (100, 400), "speed": (1, 8), "weave": (0, 0.2)},
}


def random_table(random, kind):
    """Table of a scene file. The tether is up to 0.3 % shorter than the distance of the kite, or up to 5 % longer."""
    numbers = {name: random.uniform(*each) if isinstance(each, tuple) else each for name, each in FLIGHTS[kind].items()}
    flight = {"kind": kind, **numbers}
    slack = random.choice([random.uniform(-0.003, 0.0), random.uniform(0.0, 0.005), random.uniform(0.005, 0.05)])
    diameter = random.uniform(0.002, 0.008)
    return {
        "duration": DURATION,
        "flight": flight,
        "tether": {
            "initial_length": flight["distance"] * (1.0 + slack),
            "diameter": diameter,
            "density": random.uniform(700.0, 1400.0),
            "axial_stiffness": random.uniform(2e10, 1e11) * np.pi * diameter**2 / 4.0,
        },
        "wind": {
            "velocity": [random.uniform(0.0, 14.0), random.uniform(-2.0, 2.0), 0.0],
            "gust": random.choice([0.0, random.uniform(0.0, 0.6)]),
            "gust_period": random.uniform(5.0, 15.0),
        },
        "wanted": {"outputs": ["kite_force"], "allowed_error": float(random.choice(ALLOWED))},
    }


def random_scenes(count, seed=SEED):
    """So many scenes, each kind of flight in turn."""
    random = np.random.default_rng(seed)
    kinds = islice(cycle(KINDS), count)
    return [read(random_table(random, kind), Path(), f"{number} {kind}") for number, kind in enumerate(kinds, 1)]
