"""Scenes that nobody has seen: at random, always the same for a seed."""

from itertools import cycle, islice
from pathlib import Path

import numpy as np
import pandas as pd

from tetherfmu.files.flights import KINDS
from tetherfmu.files.scene_files import read

SEED = 6
ALLOWED = (0.1, 0.03, 0.01, 0.003)
DURATION = 20.0  # [s]
FLIGHTS = pd.read_csv(Path(__file__).with_name("random_flights.csv"))  # by kind: limits between which a number lies


def random_table(random, kind):
    """Table of a scene file. The tether is up to 0.3 % shorter than the distance of the kite, or up to 5 % longer."""
    limits = FLIGHTS[FLIGHTS.kind == kind].itertuples()
    numbers = {each.number: random.uniform(each.low, each.high) if each.low < each.high else each.low for each in limits}
    flight = {"kind": kind, **numbers}
    slack = random.choice([random.uniform(-0.003, 0.0), random.uniform(0.0, 0.005), random.uniform(0.005, 0.05)])
    diameter, density = random.uniform(0.002, 0.008), random.uniform(700.0, 1400.0)
    stiffness = random.uniform(2e10, 1e11) * np.pi * diameter**2 / 4.0
    tether = {"diameter": diameter, "density": density, "axial_stiffness": stiffness}
    tether["initial_length"] = flight["distance"] * (1.0 + slack)
    velocity = [random.uniform(0.0, 14.0), random.uniform(-2.0, 2.0), 0.0]
    gust = random.choice([0.0, random.uniform(0.0, 0.6)])
    wind = {"velocity": velocity, "gust": gust, "gust_period": random.uniform(5.0, 15.0)}
    wanted = {"outputs": ["kite_force"], "allowed_error": float(random.choice(ALLOWED))}
    return {"duration": DURATION, "flight": flight, "tether": tether, "wind": wind, "wanted": wanted}


def random_scenes(count, seed=SEED):
    """So many scenes, each kind of flight in turn."""
    random = np.random.default_rng(seed)
    kinds = islice(cycle(name for name, kind in KINDS.items() if not kind.kite_is_free), count)
    return [read(random_table(random, kind), Path(), f"{number} {kind}") for number, kind in enumerate(kinds, 1)]
