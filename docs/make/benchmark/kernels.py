"""Time of the compiled kernels, those of the FMUs: flights over many communication steps, compiled too, and starts."""

from array import array
from functools import partial

import pandas as pd

from tetherfmu.libraries.ready import kernels
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.instance import Instance
from tetherfmu.runtime.parameters import Solver
from tetherfmu.runtime.variants import BY_NAME, VARIANTS
from tetherfmu.study.measuring.start import tether_at_start
from tetherfmu.wiring.packing import pack_records
from tetherfmu.wiring.variables import line_of_tether

from .races import interleaved
from .scenes import STEP, circle_scene

SEGMENTS, STEPS, REPEATS = (6, 10, 20, 40, 80, 160), 5000, 15
FEWER = 50  # starts are so many times fewer than steps
START, OUTPUTS, FLIGHT = "start (cold)", "outputs", "step"


def flight(variant, segments, steps):
    """The circle as a function of whether outputs are computed too; it returns internal steps, or iterations for a shape."""
    scene = circle_scene(segments)
    model = tether_at_start(scene, variant=variant)
    start, inputs, before = model.get_state(), scene.inputs(STEP)[:steps], sum(model.counters.values())

    def fly(with_outputs):
        model.set_state(start)
        model.fly(inputs, STEP, every=0, peaks=with_outputs)
        return sum(model.counters.values()) - before

    return fly


def starts(variant, segments, count):
    """A new start at so many points of the circle, as a function that returns the iterations for all shapes."""
    scene = circle_scene(segments)
    instance = Instance(kernels(variant), (line_of_tether(segments + 1),))
    count_of_segments, parameters = pack_records(instance.kernels, (scene.tether,), scene.environment, Solver())
    instance.set_up((count_of_segments,), parameters)
    inputs = [array("d", row) for row in scene.inputs(STEP)[:count]]

    def start():
        iterations = 0
        for row in inputs:
            instance.values[: at.INPUTS] = row
            problem = instance.start()
            if problem:
                raise RuntimeError(problem)
            iterations += int(instance.state[at.ITERATIONS])
        return iterations

    return start


def kernel_table(segments=SEGMENTS, steps=STEPS, repeats=REPEATS):
    """Time and work (internal steps or iterations) of the kernels per communication step or start."""
    jobs = {}
    for variant in VARIANTS:
        for n in segments if BY_NAME[variant].has_nodes else (1,):
            fly = flight(variant, n, steps)
            jobs |= {(variant, what, n): partial(fly, what == OUTPUTS) for what in (FLIGHT, OUTPUTS)}
            if variant == "quasi_steady":
                jobs[variant, START, n] = starts(variant, n, steps // FEWER)
    times, work = interleaved(jobs, repeats, min)
    rows = []
    for (variant, what, n), seconds in times.items():
        calls = steps // FEWER if what == START else steps
        if what == OUTPUTS:  # flown with them less flown without them
            seconds -= times[variant, FLIGHT, n]
        name = f"{variant} {what}" + (" (warm)" if (variant, what) == ("quasi_steady", FLIGHT) else "")
        count = n if BY_NAME[variant].has_nodes else None
        rows.append((name, count, 1e6 * seconds / calls, 0.0 if what == OUTPUTS else work[variant, what, n] / calls))
    table = pd.DataFrame(rows, columns=("what", "segments", "us per step", "work")).astype({"segments": "Int64"})
    table.insert(3, "ns per segment", 1e3 * table["us per step"] / table.segments.astype(float))
    return table.sort_values("what", kind="stable")
