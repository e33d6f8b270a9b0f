"""Dimensionless numbers of a scene: what decides how much tether it needs.

    weight    mu g L / T
    drag      |ground_force + kite_force - weight| / T
    stretch   T / EA
    slack     L / c - 1, unstretched length over distance of the ends; 0 if taut
    wave      wave_time rms|dF/dt| / rms|F|:  travel time of a wave times the rate at which the force on the kite changes

T: tension at the kite, root mean square over the scene; the others are means. All from a coarse quasi-steady flight.
"""

from typing import NamedTuple

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.study.measuring.errors import rms, size
from tetherfmu.study.measuring.runs import Config, run

COARSE = 8  # segments of the flight that the numbers come from


class Numbers(NamedTuple):
    """See above; all are dimensionless but the tension [N] and the unstretched length [m]."""

    weight: float
    drag: float
    stretch: float
    slack: float
    wave: float
    tension: float
    length: float

    @property
    def softening(self):
        """q^2/(12 s), q^2 = weight^2 + drag^2, s = stretch: how much softer sag makes a tether than its elasticity [-]."""
        return (self.weight**2 + self.drag**2) / (12.0 * max(self.stretch, 1e-12))


def numbers(scene):
    """`Numbers` of a scene; StepRefused if a coarse quasi-steady tether cannot fly it."""
    flown = run(scene, Config("quasi_steady", COARSE, 0.0, scene.every), exact=True).flown
    motion = scene.flight.motion(scene.times[1:])
    tether, force = scene.tether, flown.kite_force
    tension, length = rms(flown.outputs[:, at.KITE_TENSION]), flown.outputs[:, at.TETHER_LENGTH]
    weight = tether.mass_per_meter * scene.environment.gravity * length
    load = force + flown.ground_force + np.multiply.outer(weight, [0.0, 0.0, 1.0])
    rate = rms(size(np.diff(force, axis=0))) / scene.every / rms(size(force))
    slack = length / size(motion.kite - motion.ground) - 1.0
    return Numbers(
        float(np.mean(weight)) / tension,
        float(np.mean(size(load))) / tension,
        tension / tether.axial_stiffness,
        max(0.0, float(np.mean(slack))),
        float(np.mean(flown.outputs[:, at.WAVE_TIME])) * rate,
        tension,
        float(np.mean(length)),
    )


def lead_error(scene, step, found):
    """Error of the force on the kite [-] that comes from knowing the inputs only at the start of each step [s].

    Lengths: the ends are led to p + v h + a h^2/2 with the last acceleration, and the reel-out speed is held; both err by a
    length d, which counts EA/L / (1 + softening) d / T. Wind: half a step late; counts with its share in the tension.
    """
    time = step * np.arange(1, round(scene.duration / step))
    before, now, after = (scene.flight.motion(time + shift) for shift in (-step, 0.0, step))
    chord = now.kite - now.ground
    speed, last_speed = (each.kite_velocity - each.ground_velocity for each in (now, before))
    led = chord + 1.5 * step * speed - 0.5 * step * last_speed
    gap = np.sum((led - (after.kite - after.ground)) * chord, -1) / size(chord)
    reeled = step * np.cumsum(now.reel_out_speed) - (after.reeled - now.reeled[0])
    stiffness = scene.tether.axial_stiffness / found.length / (1.0 + found.softening)
    wind = scene.wind(time)
    change = rms(size(np.diff(wind, axis=0))) / max(rms(size(wind)), 1e-12) if len(time) > 1 else 0.0
    share = found.softening / (1.0 + found.softening) * found.drag / max(np.hypot(found.drag, found.weight), 1e-12)
    return stiffness * rms(gap - reeled) / found.tension + share * change
