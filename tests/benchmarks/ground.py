"""What a flat ground costs `TetherDynamic`: tables of times and internal steps.

    python tests/benchmarks/ground.py [--repeats 50]
    python tests/benchmarks/ground.py --bare

Circle with 525 m of tether, 500 m from the ground station, wind 8 m/s, in communication steps of 20 ms: with a ground far
below against none, in turn, the least time of many and the median ratio, with its quartiles. Then a tether of 60 m that lies
at rest on the ground, after it has settled for 2 s: internal steps and time for each communication step. `--bare` times only
the circle without ground, which versions without ground can do too: called in turn in two checkouts, it compares them.
"""

import argparse
import gc
import sys
from pathlib import Path
from time import perf_counter

import numpy as np
import pandas as pd

from tetherfmu import TetherDynamic
from tetherfmu.study.measuring.tables import circumstances, markdown

sys.path[:0] = [str(Path(__file__).resolve().parents[2] / "docs" / "make")]

from benchmark.scenes import circle_scene  # noqa: E402

STEP, STEPS = 0.02, 500
FAR = {"ground_contact": "flat", "ground_height": -1000.0}


class Circle:
    """The circle, flown again and again from its start."""

    def __init__(self, segments, **options):
        scene = circle_scene(segments, STEP * STEPS)
        self.model = TetherDynamic(scene.tether, scene.environment, initial_shape="quasi_steady", **options)
        self.inputs = scene.inputs(STEP)
        position, velocity = scene.flight.motion(0.0)[:2]
        self.model.initialize(position, velocity, wind_velocity=scene.wind.velocity)
        self.start = self.model.get_state()
        self.time()

    def time(self):
        """Time of a communication step [us], mean over the flight."""
        self.model.set_state(self.start)
        start = perf_counter()
        self.model.fly(self.inputs, STEP, every=STEPS, peaks=False)
        return 1e6 * (perf_counter() - start) / STEPS


def lying(segments):
    """A tether at rest on the ground."""
    model = TetherDynamic(segments=segments, initial_length=60.0, initial_shape="straight", ground_contact="flat")
    model.initialize((60.0, 0.0, -0.002), ground_position=(0.0, 0.0, -0.002))
    for _ in range(100):
        model.step(STEP)
    return model


def rest(model, steps=STEPS):
    """Internal steps for each communication step, and its time [us]."""
    before = model.outputs()
    inputs = np.tile(model._inputs, (steps, 1))
    start = perf_counter()
    model.fly(inputs, STEP, every=steps, peaks=False)
    time = 1e6 * (perf_counter() - start) / steps
    now = model.outputs()
    count = now.solver_steps + now.solver_rejections - before.solver_steps - before.solver_rejections
    return count / steps, time


def interleaved(jobs, repeats):
    """Times of jobs by name, done in turn; a DataFrame with a row for each round."""
    return pd.DataFrame([{name: job() for name, job in jobs.items()} for _ in range(repeats)])


def main():
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeats", type=int, default=50)
    parser.add_argument("--bare", action="store_true", help="only the circle without ground")
    given = parser.parse_args()
    gc.disable()
    if given.bare:
        jobs = {segments: Circle(segments).time for segments in (20, 40)}
        print(*(f"{time:.3f}" for time in interleaved(jobs, given.repeats).min()))
        return
    print(circumstances())
    rows = []
    for segments in (20, 40):
        jobs = {"none": Circle(segments).time, "flat": Circle(segments, **FAR).time}
        times = interleaved(jobs, given.repeats)
        least = times.min()
        quartiles = (times["flat"] / times["none"]).quantile([0.25, 0.5, 0.75])
        rest(model := lying(segments))
        steps, time = min((rest(model) for _ in range(given.repeats)), key=lambda each: each[1])
        rows.append(
            {
                "segments": segments,
                "circle without ground us": least["none"],
                "ground far below us": least["flat"],
                "ratio": least["flat"] / least["none"],
                "of each round": "{1:.3f} ({0:.3f} to {2:.3f})".format(*quartiles),
                "at rest on the ground us": time,
                "internal steps at rest": steps,
            }
        )
    print(markdown(pd.DataFrame(rows)))


if __name__ == "__main__":
    main()
