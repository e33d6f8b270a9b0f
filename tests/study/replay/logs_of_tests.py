"""Logs for tests: made by the dynamic tether along a path in closed form, with errors of known size."""

from functools import cache

import numpy as np
import pandas as pd

from tetherfmu import MovingEnd, Tether, TetherDynamic, inputs_along
from tetherfmu.files.csv_files import Table
from tetherfmu.study.replay import columns, log

STEP, DURATION, SEGMENTS = 0.02, 120.0, 4  # s, s, -
WIND = (8.0, 0.0, 0.0)
TETHER = Tether(diameter=0.0135, drag_coefficient=1.1, axial_stiffness=7.0e6, axial_damping=5388.0)


def source(*names):
    """Where a log has a quantity: in columns with these names, in SI units."""
    return columns.Source(tuple(map(columns.Column, names)))


MAP = columns.Columns(
    "of_tests",
    sources={
        "kite_position": source("x", "y", "z"),
        "wind_velocity": source("wx", "wy", "wz"),
        "tether_length": source("length"),
        "ground_tension": source("tension"),
    },
    tether=TETHER,
    smoothing=columns.Smoothing(position_noise=0.5),
)


def path(time):
    """Position of the kite [m]: eights at 225 to 275 m, up to 30 m/s."""
    azimuth, elevation = 0.35 * np.sin(0.25 * time), 0.55 + 0.18 * np.sin(0.5 * time + 0.3)
    across = np.cos(elevation)
    way = np.array([across * np.cos(azimuth), across * np.sin(azimuth), np.sin(elevation)])
    return (250.0 + 25.0 * np.sin(0.09 * time)) * way


def force(time):
    """Force of the winch [N]."""
    return 3000.0 + 1500.0 * np.sin(0.5 * time)


@cache
def flown():
    """Times [s], unstretched length [m] and tension at the ground [N] of a dynamic tether on which the winch pulls."""
    count = round(DURATION / STEP)
    tether = TetherDynamic(
        TETHER, segments=SEGMENTS, initial_length=float(np.linalg.norm(path(0.0))), winch_control="force", shape_points=0
    )
    tether.initialize(path(0.0), wind_velocity=WIND)
    rows = inputs_along(count, STEP, MovingEnd(path), winch_force=force, wind_velocity=WIND)
    made = tether.fly(rows, STEP)
    return STEP * np.arange(1, count + 1), made.of("tether_length"), made.of("ground_tension")


def cells(offset=0.0, origin=(0.0, 0.0, 0.0), delay=0.0, noise=0.5, seed=0, start=5.0, end=115.0):
    """Cells of a log every 0.1 s whose length lacks an offset [m], and whose positions lack an origin [m] and are late [s].

    noise : standard deviation of a position [m]; length and tension have 2 cm and 30 N.
    """
    random, (when, length, tension) = np.random.default_rng(seed), flown()
    time = np.arange(start, end, 0.1)
    x = np.array([path(t) for t in time - delay]) - origin + noise * random.normal(size=(len(time), 3))
    measured = np.interp(time, when, length) - offset + 0.02 * random.normal(size=len(time))
    pulled = np.interp(time, when, tension) + 30.0 * random.normal(size=len(time))
    wind = dict(zip(("wx", "wy", "wz"), WIND, strict=True))
    named = {"time": time, "x": x[:, 0], "y": x[:, 1], "z": x[:, 2], "length": measured, "tension": pulled, **wind}
    return pd.DataFrame(named).astype(str)


def made(**errors):
    """`Log` of `cells`."""
    return log.log_of(Table(cells(**errors)), MAP)
