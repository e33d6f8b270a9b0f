"""What wind at points costs: time of a step with 11 points over that with one wind, and time to read a box, as tables.

    python tests/benchmarks/wind_points.py [--variants NAME,...] [--segments 5,10,20,40]

Each tether flies the circle of the benchmark, 2000 communication steps of 20 ms, in one call of its compiled kernel: without
outputs, and with those after each step, as an importer gets them. With points, all of them have that one wind, so that it
takes the same internal steps. The flights take turns, and the fastest of each counts, in time of the processor. Then the
wind at 21 points is read from a box by `wind.frozen_turbulence`: in a call for each step, as in the FMU `TurbulentWind`, and
in one for 2000 steps, as in scenes.
"""

import argparse
import sys
from pathlib import Path
from time import process_time
from timeit import repeat

import numpy as np
import pandas as pd

from tetherfmu.python import models
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import by_name
from tetherfmu.runtime.instance import address
from tetherfmu.runtime.parameters import Environment
from tetherfmu.runtime.variants import BY_NAME, VARIANTS, class_name
from tetherfmu.study.measuring.tables import circumstances, markdown
from tetherfmu.wind.frozen_turbulence import FrozenTurbulence, MeanWind
from tetherfmu.wind.wind_boxes import of_space

sys.path[:0] = [str(Path(__file__).resolve().parents[2] / "docs" / "make")]

from benchmark.scenes import STEP, circle_scene  # noqa: E402

STEPS, SEGMENTS, POINTS, SAMPLED = 2000, (5, 10, 20, 40), 11, 21
WIND = (8.0, 0.0, 0.0)
WINDS = {"uniform": (0, at.UNIFORM), "power law": (0, at.POWER_LAW), "points": (POINTS, at.UNIFORM)}
OUTPUTS = {"without": at.NEVER, "with": at.ALWAYS}


def flight(variant, segments, points, profile, outputs):
    """A flight that can be repeated: a function that gives its processor time [s], and one that gives its work."""
    scene = circle_scene(segments)
    model = getattr(models, class_name(variant))(scene.tether, Environment(wind_profile=profile), wind_points=points)
    inputs = scene.inputs(STEP)[:STEPS]
    columns = by_name(inputs)
    wind = {"wind_at": np.tile(WIND, (points, 1))} if points else {"wind_velocity": WIND}
    columns["wind_velocity"][:] = 0.0 if points else WIND
    model.initialize(columns["kite_position"][0], columns["kite_velocity"][0], **wind)
    inputs = np.ascontiguousarray(np.concatenate([inputs, np.tile(WIND, (STEPS, points))], axis=1))
    start, instance = model.get_state(), model._instance
    kept = np.zeros(len(instance.values) + 1 + 6 * (instance.segments + 1))  # room enough for a row

    def fly():
        model.set_state(start)
        arrays = instance.plan, instance.parameters, instance.state, instance.before, instance.work
        plan, parameters, state, before, work = map(address, arrays)
        flown = inputs.ctypes.data, STEPS, STEP, 0, outputs
        began = process_time()
        done = instance.kernels.fly(plan, parameters, *flown, state, before, kept.ctypes.data, work)
        taken = process_time() - began
        assert done == STEPS
        return taken

    return fly, lambda: sum(model.counters.values())


def row(variant, segments, outputs, rounds):
    """A row of the table of steps."""
    flights = {name: flight(variant, segments, *given, OUTPUTS[outputs]) for name, given in WINDS.items()}
    taken = [[fly() for fly, _ in flights.values()] for _ in range(rounds)]
    times = dict(zip(flights, np.min(taken, axis=0), strict=True))
    return {
        "tether": variant,
        "segments": segments if BY_NAME[variant].has_nodes else None,
        "outputs": outputs,
        **{f"{name} [us]": 1e6 * seconds / STEPS for name, seconds in times.items()},
        "points/uniform": times["points"] / times["uniform"],
        "points/power law": times["points"] / times["power law"],
        **{f"work, {name}": work() / STEPS for name, (_, work) in flights.items()},
    }


def sampling(rounds):
    """Time to read the wind at 21 points [us]: in a call for each step, and for each step of a call for 1000 of them."""
    shape = (128, 32, 64)
    numbers = np.random.default_rng(1).normal(size=(*shape, 3)).astype("f4")
    flat, strides = numbers.ravel(), (3 * 32 * 64, 3 * 64, 3)
    box = of_space("box", [flat[k:] for k in range(3)], strides, shape, (10.0, 10.0, 10.0))
    wind = FrozenTurbulence(MeanWind(8.0, 0.3, 10.0, 0.14), box)
    points = np.linspace((0.0, 0.0, 0.0), (150.0, 20.0, 260.0), SAMPLED)
    time, every = np.repeat(STEP * np.arange(STEPS), SAMPLED), np.tile(points, (STEPS, 1))
    alone = min(repeat(lambda: wind.at(1.0, points), number=200, repeat=rounds, timer=process_time)) / 200
    together = min(repeat(lambda: wind.at(time, every), number=1, repeat=rounds, timer=process_time)) / STEPS
    return 1e6 * alone, 1e6 * together


def main():
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--rounds", type=int, default=60, help="flights of each, of which the fastest counts")
    parser.add_argument("--variants", default=",".join(VARIANTS), help="tethers, separated by commas")
    parser.add_argument("--segments", default=",".join(map(str, SEGMENTS)), help="of those that have them")
    options = parser.parse_args()
    counts = [int(each) for each in options.segments.split(",")]
    cases = [(each, n) for each in options.variants.split(",") for n in (counts if BY_NAME[each].has_nodes else counts[:1])]
    print(markdown(pd.DataFrame([row(*case, outputs, options.rounds) for case in cases for outputs in OUTPUTS])))
    alone, together = sampling(options.rounds)
    print(f"\n{SAMPLED} points of a box: {alone:.2g} us in a call for each step, {together:.2g} us in a call for {STEPS}\n")
    print(circumstances())


if __name__ == "__main__":
    main()
