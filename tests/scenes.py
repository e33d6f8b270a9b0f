"""Scenes that several tests share, and how outputs are compared."""

from pathlib import Path

import numpy as np

from tetherfmu import Tether

REFERENCE = Path(__file__).parent / "reference"
CIRCLE_TETHER = Tether(initial_length=525.0)
CIRCLE_RATE = 0.05
# relative tolerance, allowed error of a position [m]; steps over taut/slack kinks; observed 16, 0.69, 0.012 micrometres
SCENE_08_ERRORS = [(1e-4, 50e-6), (1e-6, 2e-6), (1e-8, 0.1e-6)]
REVOLUTION = 2.0 * np.pi / CIRCLE_RATE


def circle(time, rate=CIRCLE_RATE):
    """Position [m] and velocity [m/s] of a kite on a cone of half angle 10 deg, 500 m long, tilted by 70 deg about x."""
    phase = rate * time
    half_angle, tilt = np.radians([10.0, 70.0])
    radius = 500.0 * np.sin(half_angle)
    position = np.array([radius * np.cos(phase), radius * np.sin(phase), 500.0 * np.cos(half_angle)])
    velocity = radius * rate * np.array([-np.sin(phase), np.cos(phase), 0.0])
    turn = np.array([[1, 0, 0], [0, np.cos(tilt), -np.sin(tilt)], [0, np.sin(tilt), np.cos(tilt)]])
    return turn @ position, turn @ velocity


def hanging_load(top, height, mass, **rope):
    """File of a system, without its first keys: a load [kg] that hangs on a rope with these keys from a point, `top` [m]."""
    keys = "\n".join(f"{name} = {value}" for name, value in rope.items())
    return f"""
[points.{top}]
position = [0, 0, {height}]
[points.load]
mass = {mass}
[lines.rope]
from = "{top}"
to = "load"
{keys}
"""


def kite_at_start(name, position, velocity=(0.0, 0.0, 0.0)):
    """Values of an FMU, by its name, that place its kite [m] with a velocity [m/s] at the start."""
    initial = "initial_" if name.endswith("Free") else ""
    return {f"{initial}kite_position": position, f"{initial}kite_velocity": velocity}


def kite_inputs(name, position, velocity):
    """Inputs of a tether, by its name, that lead its kite along a path [m, m/s], or pull a free one towards it."""
    if name.endswith("Free"):
        return {"kite_load": 0.6 * np.asarray(position) + 10.0 * np.asarray(velocity) + (0.0, 0.0, 150.0)}
    return {"kite_position": position, "kite_velocity": velocity}


def fly_circle(tether, step, duration, wind=(0.1, 0.0, 0.0), rate=CIRCLE_RATE):
    """Fly a `TetherModel` along the circle; returns the times [s] and the list of outputs after each step."""
    position, velocity = circle(0.0, rate)
    tether.initialize(kite_position=position, kite_velocity=velocity, wind_velocity=wind)
    outputs = []
    count = round(duration / step)
    for k in range(count):
        position, velocity = circle(k * step, rate)
        outputs.append(tether.step(step, kite_position=position, kite_velocity=velocity, wind_velocity=wind))
    return step * np.arange(1, count + 1), outputs


def same(one, other):
    """Whether two records of outputs are equal bit for bit."""
    return all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


def read(name):
    """Columns of a reference file as a dict of arrays."""
    table = np.genfromtxt(REFERENCE / name, delimiter=",", names=True, deletechars="")
    return {column: table[column] for column in table.dtype.names}


def nodes(columns, n):
    """Node positions of a reference file, array (rows, n + 1, 3)."""
    return np.stack([np.stack([columns[f"p{i}_{axis}"] for axis in "xyz"], axis=-1) for i in range(n + 1)], axis=1)
