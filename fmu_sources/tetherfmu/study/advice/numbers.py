"""Dimensionless numbers of a scene: what decides how much tether it needs.

    weight    mu g L / T
    drag      |ground_force + kite_force - weight| / T
    stretch   T / EA
    slack     L / c - 1, unstretched length over distance of the ends; 0 if taut
    wave      wave_time rms|dF/dt| / rms|F|:  travel time of a wave times the rate at which the force on the kite changes

T: tension at the kite, root mean square over the scene; the others are means. All from a coarse quasi-steady flight.
"""

from types import SimpleNamespace

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.study.measuring.errors import rms, size
from tetherfmu.study.measuring.runs import Config, run

COARSE = 8  # segments of the flight that the numbers come from


def numbers(scene):
    """All numbers of a scene, as attributes; StepRefused if a coarse quasi-steady tether cannot fly it."""
    flown = run(scene, Config("quasi_steady", COARSE, 0.0, scene.every), exact=True).flown
    motion = scene.flight.motion(scene.times[1:])
    tether, force = scene.tether, flown.kite_force
    tension, length = rms(flown.outputs[:, at.KITE_TENSION]), flown.outputs[:, at.TETHER_LENGTH]
    weight = tether.mass_per_meter * scene.environment.gravity * length
    load = force + flown.ground_force + np.multiply.outer(weight, [0.0, 0.0, 1.0])
    rate = rms(size(np.diff(force, axis=0))) / scene.every / rms(size(force))
    slack = length / size(motion.kite - motion.ground) - 1.0
    return SimpleNamespace(
        weight=float(np.mean(weight)) / tension,
        drag=float(np.mean(size(load))) / tension,
        stretch=tension / tether.axial_stiffness,
        slack=max(0.0, float(np.mean(slack))),
        wave=float(np.mean(flown.outputs[:, at.WAVE_TIME])) * rate,
    )
