"""How good are velocities of the ends that are derived from positions, beside those that the importer gives?

    python tests/benchmarks/end_velocities.py [--step 0.02] [--noise 0.001] [--tether dynamic] [--modes given derived]

Printed, to be copied into docs/data/end_velocities.csv of docs/models/theory.md, "Driven ends": error of the force on the
kite, rms over rms of the force, against the same tether at a twentieth of the communication step with exact positions and
velocities. Circle: 500 m away, 4.3 m/s, on 525 m of tether. Figures of eight: 500 m away, 40 m/s, on 499 m of tether. Fast
circle: as the circle, ten times as fast.
Wind 8 m/s, 20 segments; the first 30 s of 60 s are left out. The noise is normal and white, on each component of the
position of the kite in each communication step; given velocities have none.
"""

import warnings
from dataclasses import replace

import numpy as np
from as_script import options

from benchmark.scenes import circle_scene, figure_of_eight_scene
from tetherfmu.files.flights import Circle
from tetherfmu.runtime import layout as at
from tetherfmu.study.measuring.start import MODELS

FINER, DURATION, SETTLED, SEGMENTS = 20, 60.0, 30.0, 20
MODES = {"given": "given", "left at 0": "given", "derived": "derived"}


def scenes():
    """The scenes by name."""
    circle = circle_scene(SEGMENTS, DURATION)
    fast = replace(circle, flight=Circle(rate=0.5))
    return {"circle": circle, "figure of eight": figure_of_eight_scene(SEGMENTS, DURATION), "fast circle": fast}


def force(scene, step, variant, mode="given", noise=0.0, every=1):
    """Force on the kite [N] after each `every` steps, array (rows, 3)."""
    inputs = scene.inputs(step)
    first = inputs[0].copy()
    kite, velocity = slice(at.KITE_POSITION, at.KITE_POSITION + 3), slice(at.KITE_VELOCITY, at.KITE_VELOCITY + 3)
    inputs[:, kite] += noise * np.random.default_rng(1).normal(size=(len(inputs), 3))
    if mode != "given":
        inputs[:, velocity] = 0.0
    model = MODELS[variant](scene.tether, scene.environment, end_velocities=MODES[mode], initial_shape="quasi_steady")
    start = (first[kite], first[velocity]) if MODES[mode] == "given" else (first[kite],)
    model.initialize(*start, wind_velocity=first[at.WIND_VELOCITY : at.WIND_VELOCITY + 3])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return model.fly(inputs, step, every, peaks=False).kite_force


def error(scene, step, variant, mode, noise, reference):
    """Error of the force on the kite: rms over rms of the reference."""
    settled = round(SETTLED / step)
    found, right = force(scene, step, variant, mode, noise)[settled:], reference[settled:]
    return np.sqrt(np.sum((found - right) ** 2) / np.sum(right**2))


def main():
    given = options(__doc__, step=0.02, noise=0.001, tether="dynamic", modes=[*MODES])
    print(f"error of kite_force, communication step {1e3 * given.step:g} ms, noise {1e3 * given.noise:g} mm")
    for name, scene in scenes().items():
        reference = force(scene, given.step / FINER, given.tether, every=FINER)
        size = np.sqrt(np.mean(np.sum(reference[round(SETTLED / given.step) :] ** 2, axis=1)))
        for noise in (0.0, given.noise):
            found = {mode: error(scene, given.step, given.tether, mode, noise, reference) for mode in given.modes}
            texts = ", ".join(f"{mode} {100.0 * each:.3g} %" for mode, each in found.items())
            print(f"{name} ({size:.4g} N rms), noise {1e3 * noise:g} mm: {texts}")


if __name__ == "__main__":
    main()
