"""A rig in C with a native FMU in it, `real_time_host.c`: compiled for this machine, and run."""

import subprocess
from pathlib import Path

from native import programs
from tetherfmu.wiring.variables import table_of

HOST = Path(__file__).with_name("real_time_host.c")
WRAPPED = "-Wl," + ",".join(f"--wrap={name}" for name in ("malloc", "calloc", "realloc", "free"))
SHAPE_POINTS = 0


def compiled(folder, segments):
    """Path of the program, with an FMU of the dynamic tether."""
    return programs.compiled(folder, "dynamic", 2, HOST, ("-O2", "-D_GNU_SOURCE", WRAPPED), segments, SHAPE_POINTS)


def run(program, segments, mode, flight, steps, step, fixed_step):
    """The finished process of such a program; see `real_time_host.c`."""
    table = table_of("dynamic", {"segments": segments, "shape_points": SHAPE_POINTS})
    reference = {each.name: each.place for each in table}
    fixed = f"{reference['fixed_step']},{fixed_step!r},{reference['solver_iterations']}"
    command = [program, "{token}", mode, flight, str(steps), repr(step), fixed]
    return subprocess.run(command, capture_output=True, text=True, check=False)
