"""How evenly does a native FMU with fixed steps run in a rig in C? Printed as a table.

    python tests/benchmarks/jitter.py [--steps 1000000] [--segments 10 20] [--fixed-steps 0.001 0.005]

Each flight is one process, `tests/native/real_time_host.c`: nine inputs, fmi2DoStep of one fixed step, six outputs. By the
clock, and of the processor, which leaves out what other processes take, with 0.5 us of the measurement in it. Circle: taut.
Snaps: slack, and taut again every 4 s, at 36 m/s. Rest: in still air, where motions die away until nothing is left but
rounding. Iterations: the most in a step; the bound is `limits.WORST_WORK`. Needs gcc on 64-bit Linux.
"""

import os
import sys
import tempfile
from pathlib import Path

import pandas as pd
from as_script import options

from native import real_time
from tetherfmu.study.measuring.tables import circumstances, markdown

FLIGHTS = ("circle", "snaps", "rest")


def main():
    """Fly all and print the table."""
    given, rows = options(__doc__, steps=1_000_000, segments=[10, 20], fixed_steps=[1e-3, 5e-3]), []
    for n in given.segments:
        with tempfile.TemporaryDirectory() as folder:
            program = real_time.compiled(Path(folder), n)
            for step in given.fixed_steps:
                for flight in FLIGHTS:
                    done = real_time.run(program, n, "time", flight, given.steps, step, step)
                    if done.returncode != 0:
                        sys.exit(f"{flight}: exit status {done.returncode}: {done.stderr}")
                    *clock, median, rare, largest, iterations = map(float, done.stdout.split())
                    times = [*clock, median, rare, largest, int(iterations)]
                    rows.append((n, f"{1e3 * step:g} ms", flight, *times))
    columns = ["segments", "step", "flight", "clock: median [us]", "99.99 % [us]", "largest [us]"]
    columns += ["processor: median [us]", "99.99 %  [us]", "largest  [us]", "iterations, at most"]
    print(f"{circumstances()} Load of the machine: {os.getloadavg()[0]:.1f}.\n")
    print(markdown(pd.DataFrame(rows, columns=columns)))


if __name__ == "__main__":
    main()
