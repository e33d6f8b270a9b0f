"""How long does the slowest of a million fixed steps take?

    python tests/benchmarks/real_time.py [--steps 1000000] [--segments 20] [--fixed-step 0.001]

Two flights of the default tether: a circle, taut; and a kite that dives at the ground station and turns back, so that the
tether goes slack and snaps again and again. Each step is one call of the kernel through ctypes. Times are of the processor
(what the operating system takes away in between does not count) and of the clock, in microseconds, with the time of an
empty measurement in them. Iterations: the largest number in a step; at most `limits.WORST_WORK`.
"""

import argparse
import gc
from time import perf_counter_ns, thread_time_ns

import numpy as np

from tetherfmu.libraries.ready import kernels
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.instance import Instance, address
from tetherfmu.runtime.parameters import Environment, Solver, Tether
from tetherfmu.study.measuring.tables import circumstances
from tetherfmu.wiring.packing import pack_records
from tetherfmu.wiring.variables import line_of_tether

WIND = (8.0, 0.0, 0.0)


def circle(time):
    """Kite 500 m away on a circle of 87 m, 4.3 m/s: position [m] and velocity [m/s]."""
    angle = 0.05 * time
    direction = np.array((470.0, 87.0 * np.cos(angle), 171.0 + 87.0 * np.sin(angle)))
    return direction, 0.05 * 87.0 * np.array((0.0, -np.sin(angle), np.cos(angle)))


def snaps(time):
    """Kite between 480 and 526 m from the ground station, 0.25 Hz: 36 m/s at most; the tether is 525 m long."""
    rate = 0.5 * np.pi
    direction = np.array((0.8, 0.0, 0.6))
    return (503.0 + 23.0 * np.sin(rate * time)) * direction, 23.0 * rate * np.cos(rate * time) * direction


def run(path, steps, segments, fixed_step):
    """Times of all steps [us], of the processor and of the clock, and the largest number of iterations in a step."""
    solver = Solver(fixed_step=fixed_step, initial_shape=2)
    instance = Instance(kernels("dynamic"), (line_of_tether(segments + 1),))
    tether = Tether(segments=segments, initial_length=525.0)
    _, parameters = pack_records(instance.kernels, (tether,), Environment(), solver)
    instance.set_up((segments,), parameters)
    motion, inputs = slice(at.KITE_POSITION, at.KITE_VELOCITY + 3), np.frombuffer(instance.values)
    inputs[motion] = np.concatenate(path(0.0))
    inputs[at.WIND_VELOCITY : at.WIND_VELOCITY + 3] = WIND
    assert instance.start() is None
    arrays = instance.plan, instance.parameters, instance.values, instance.state, instance.before, instance.work
    advance, (plan, parameters, values, state, previous, work) = instance.kernels.advance, map(address, arrays)
    outputs = values + 8 * instance.outputs_at
    times, most, before = np.zeros((steps, 2)), 0, 0.0
    for k in range(steps):
        inputs[motion] = np.concatenate(path(k * fixed_step))
        clock, processor = perf_counter_ns(), thread_time_ns()
        status = advance(plan, parameters, values, fixed_step, state, previous, outputs, work)
        times[k] = thread_time_ns() - processor, perf_counter_ns() - clock
        assert status == 0, status
        most = max(most, instance.state[at.ITERATIONS] - before)
        before = instance.state[at.ITERATIONS]
    return 1e-3 * times, int(most)


def main():
    parser = argparse.ArgumentParser(description="Slowest of many fixed steps.")
    parser.add_argument("--steps", type=int, default=1_000_000)
    parser.add_argument("--segments", type=int, default=20)
    parser.add_argument("--fixed-step", type=float, default=1e-3)
    options = parser.parse_args()
    print(circumstances())
    gc.disable()
    for name, path in (("circle", circle), ("snaps", snaps)):
        run(path, 100, options.segments, options.fixed_step)
        times, most = run(path, options.steps, options.segments, options.fixed_step)
        for what, column in (("processor", times[:, 0]), ("clock", times[:, 1])):
            median, rare, largest = np.percentile(column, (50, 99.99, 100))
            print(f"{name:8} {what:10} median {median:8.1f} us   99.99 % {rare:8.1f} us   largest {largest:8.1f} us")
        print(f"{name:8} iterations in a step: {most} at most")


if __name__ == "__main__":
    main()
