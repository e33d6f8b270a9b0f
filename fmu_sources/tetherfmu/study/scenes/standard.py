"""The scenes of the benchmark, and scenes that nobody has seen: at random, always the same for a seed.

The benchmark has a tether on a circling kite, on one that flies figures of eight, and a released one. The first two start
turning with the kite (`initial_shape = quasi_steady`). The third is held until at rest; then its lower end is free and the
tether reels out.
"""

from itertools import cycle, islice
from pathlib import Path

import numpy as np
import pandas as pd

from tetherfmu import models
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import by_name, inputs_of
from tetherfmu.runtime.parameters import Tether
from tetherfmu.runtime.variants import VARIANTS, class_name

from .files import Scene, read
from .flights import PRESCRIBED, Circle, FigureOfEight, Flight
from .winds import Wind

STEP = 0.02  # communication step [s]
REVOLUTION = 2.0 * np.pi / Circle().rate
BREEZE = Wind((8.0, 0.0, 0.0))
MODELS = {variant: getattr(models, class_name(variant)) for variant in VARIANTS}
SEED = 6
ALLOWED = (0.1, 0.03, 0.01, 0.003)
DURATION = 20.0  # [s]
FLIGHTS = pd.read_csv(Path(__file__).with_name("random_flights.csv"))  # by kind: limits between which a number lies


class Release(Flight):
    """The kite end is held at a point until it is let go, and the winch pays out."""

    reel_out_speed = 0.3  # [m/s]

    def kite(self, time):
        """Where it is held."""
        return 0.0 * time - 40.0, 0.0 * time, 0.0 * time - 47.0

    def reeled(self, time):
        """Out at a constant speed."""
        return self.reel_out_speed * time


def circle_scene(segments, duration=REVOLUTION):
    """The circle with so many segments."""
    every = 0.5 if duration > 5.0 else 10 * STEP
    tether = Tether(segments=segments, initial_length=525.0)
    return Scene("circle", every * int(duration / every), Circle(), tether, wind=BREEZE, every=every)


def figure_of_eight_scene(segments, duration=40.0):
    """The figures of eight with so many segments."""
    tether = Tether(segments=segments, initial_length=499.0)
    return Scene("figure of eight", duration, FigureOfEight(), tether, wind=BREEZE, every=0.2)


def release_scene(segments, duration=10.0):
    """The release with so many segments."""
    tether, winch = Tether(segments=segments, initial_length=70.0), Release.reel_out_speed
    return Scene("release", duration, Release(), tether, kite_is_free=True, reel_out_speed=winch)


def tether_at_start(scene, tolerance=0.0, variant="dynamic", first=None, wind=None, **options):
    """A tether of a variant, initialized for a scene; `tolerance` 0 is the solver's default.

    first : inputs to start with, array (`layout.INPUTS`,); None: those of the start.  wind : at the wind points of a scene
    that has them [m/s], array (wind_points, 3).  options : of TetherModel.
    """
    options |= {"relative_tolerance": tolerance, "initial_shape": at.QUASI_STEADY}
    if scene.kite_is_free:
        options |= {"initial_shape": at.STATIC_EQUILIBRIUM}
        options |= {"kite_mass": scene.flight.kite_mass} if scene.flight.kite_is_free else {"free_ends": (False, True)}
    kind = models.TetherDynamicFree if scene.flight.kite_is_free else MODELS[variant]
    model = kind(scene.tether, scene.environment, ground=scene.ground, wind_points=scene.wind_points, **options)
    first = scene.inputs(scene.every)[0] if first is None else first
    given = by_name(first)
    known = inputs_of(kite_is_free=False)
    values = {each.name: given[each.name] if each.size > 1 else given[each.name].item() for each in known}
    model.initialize(**values, wind_at=wind)
    return model


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
    kinds = islice(cycle(PRESCRIBED), count)
    return [read(random_table(random, kind), Path(), f"{number} {kind}") for number, kind in enumerate(kinds, 1)]
