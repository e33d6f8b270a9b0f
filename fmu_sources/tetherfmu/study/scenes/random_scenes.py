"""Scenes that nobody has seen: flights, tethers and winds at random, always the same for a seed."""

from pathlib import Path

import numpy as np

from .files import read
from .flights import KINDS

SEED = 6
ALLOWED = (0.1, 0.03, 0.01, 0.003)
DURATION = 20.0  # [s]


def random_flight(random, kind):
    """Table of a flight."""
    uniform = random.uniform
    table = {
        "circle": lambda: {"distance": uniform(100, 600), "half_angle": uniform(0.1, 0.4), "rate": uniform(0.05, 0.5)},
        "figure_of_eight": lambda: {"distance": uniform(150, 600), "elevation": uniform(0.3, 0.9), "speed": uniform(10, 45)},
        "parked": lambda: {"distance": uniform(50, 500), "sway": uniform(0, 10), "sway_period": uniform(8, 30)},
        "launch": lambda: {"distance": uniform(20, 60), "climb_time": uniform(6, 15)},
        "landing": lambda: {"distance": 100.0, "final_distance": uniform(60, 90), "reeled_in": uniform(5, 9)},
        "towing": lambda: {"distance": uniform(50, 300), "speed": uniform(3, 20), "weave": uniform(0, 0.3)},
        "reel": lambda: {"distance": uniform(100, 400), "speed": uniform(1, 8), "weave": uniform(0, 0.2)},
    }[kind]()
    return {"kind": kind, **table}


def random_table(random, kind):
    """Table of a scene file. The tether is up to 0.3 % shorter than the distance of the kite, or up to 5 % longer."""
    flight = random_flight(random, kind)
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
    scenes = []
    for k in range(count):
        kind = list(KINDS)[k % len(KINDS)]
        scenes.append(read(random_table(random, kind), Path(), f"{k + 1} {kind}"))
    return scenes
