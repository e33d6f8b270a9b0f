"""The C sources of TetherDynamic on other processors, and what the slowest of many fixed steps costs.

    python tests/benchmarks/c_sources_elsewhere.py
    chrt -f 50 taskset -c 1 python tests/benchmarks/c_sources_elsewhere.py --of steps [--steps 1000000] [--segments 5 10]

processors : compiles for several processors with all warnings as errors, by the compiler inside `ziglang` with its small C
library, runs each program (needs qemu-user), compares the forces of a circle with those of this processor, and looks for
warnings in the sources of a system of tethers.
steps : fixed steps of 5 ms in communication steps of 20 ms, in a host in C compiled by gcc, as a table: the circle, on which
the tether is taut, and one on which it goes slack and snaps taut every 4 s. By the clock, and of the processor, with 0.5 us
of the measurement in it; what the operating system does to caches in between counts in both. Run it on a core that nothing
else uses (`taskset` keeps it on one, `chrt` first in the queue for it): eight minutes. With
`--into docs/data/c_sources_steps.csv` the table goes to the manual.
"""

import os
import subprocess
import tempfile
from datetime import UTC, datetime
from pathlib import Path
from platform import system

import numpy as np
import pandas as pd
from as_script import EXAMPLES, options
from fmpy import read_model_description

from native import as_importers_do as importer
from scenes import REVOLUTION, circle
from tetherfmu.export import system_fmus
from tetherfmu.export.native import native_fmus as native
from tetherfmu.libraries.linking import zig
from tetherfmu.runtime.limits import WORST_WORK
from tetherfmu.study.measuring.tables import markdown, processor

NAME, STEP, FIXED_STEP, STEPS = "TetherDynamic", 0.02, 0.005, 1000
OPTIONS = ("-std=c99", "-O2", *importer.WARNINGS)
HOST = Path(__file__).with_name("c_sources_host.c")
PLACES = {
    "SEGMENTS_AT": "segments",
    "FIXED_STEP_AT": "fixed_step",
    "KITE_AT": "kite_position[1]",
    "FORCES_AT": "ground_force[1]",
    "ITERATIONS_AT": "solver_iterations",
}
BRIDLE = EXAMPLES / "systems" / "y_bridle.toml"
SNAPPED = (483.0, 23.0, 4.0)  # mean distance of the kite [m], amplitude [m] and period [s]: the tether is 505 m long
PROCESSORS = {  # target of the compiler, its options, and what runs the program
    "x86_64": ("x86_64-linux-musl", (), ()),
    "aarch64": ("aarch64-linux-musl", (), ("qemu-aarch64",)),
    "riscv64": ("riscv64-linux-musl", (), ("qemu-riscv64",)),
    "armv7": ("arm-linux-musleabihf", ("-mcpu=generic+v7a+vfp3",), ("qemu-arm",)),
}


def snaps(time):
    """Position [m] and velocity [m/s] of a kite that comes nearer, and goes until the tether is taut."""
    distance, amplitude, period = SNAPPED
    rate, along = 2.0 * np.pi / period, np.array([0.6, 0.0, 0.8])
    return along * (distance + amplitude * np.sin(rate * time)), along * amplitude * rate * np.cos(rate * time)


FLIGHTS = {"circle": (circle, REVOLUTION), "snaps": (snaps, SNAPPED[2])}  # motion and its period [s]


def prepared(folder):
    """Folder with the sources, the host and its inputs; options of the compiler."""
    path = native.build(NAME, folder, with_sources=True)
    sources = importer.unpacked(path, folder)
    (sources / HOST.name).write_bytes(HOST.read_bytes())
    for name, (motion, period) in FLIGHTS.items():
        np.array([np.ravel(motion(k * STEP)) for k in range(round(period / STEP))]).tofile(sources / name)
    places = {each.name: each.valueReference for each in read_model_description(str(path)).modelVariables}
    defined = [f"-D{name}={places[variable]}" for name, variable in PLACES.items()]
    return sources, [*OPTIONS, "-Wno-unused-parameter", *defined, "-DFMI2_FUNCTION_PREFIX=T_"]


def printed(sources, program, flight, *arguments):
    """Numbers that the host prints."""
    command = [*program, flight, *map(str, arguments)]
    done = subprocess.run(command, cwd=sources, capture_output=True, text=True, check=True)
    return [float(word) for word in done.stdout.split()]


def processors(sources, options):
    """Print how far the forces on other processors are from those on this one."""
    print("processor, size of the program [kB], fixed step [s], largest difference of a force, relative to the largest")
    expected = {}
    for name, (target, more, runner) in PROCESSORS.items():
        zig(sources, "cc", "-target", target, *more, *options, HOST.name, "-static", "-s", "-lm", "-o", name)
        size = (sources / name).stat().st_size / 1000
        for fixed_step in (0.0, FIXED_STEP):
            printed(sources, [*runner, f"./{name}"], "circle", STEPS, STEP, 20, fixed_step, "outputs")
            found = np.fromfile(sources / "outputs")
            reference = expected.setdefault(fixed_step, found)
            difference = abs(found - reference).max() / abs(reference).max()
            print(f"{name}, {size:.0f}, {fixed_step:g}, {difference:.1e}", flush=True)


def systems_without_warnings(folder):
    """Compile the sources of a system for all processors, both versions of FMI, without optimization."""
    for fmi in (2, 3):
        sources = importer.unpacked(
            system_fmus.build(BRIDLE, folder / str(fmi), native=fmi, with_sources=True), folder / str(fmi)
        )
        for name, (target, more, _) in PROCESSORS.items():
            zig(sources, "cc", "-target", target, *more, *OPTIONS, "-O0", "-c", "fmu.c")
            print(f"{BRIDLE.stem}, FMI {fmi}, {name}: no warning", flush=True)


def steps(sources, options, count, segments):
    """How long steps take, and how many iterations: a table (DataFrame)."""
    importer.run(["gcc", *options, HOST.name, "-lm", "-o", "host"], sources)
    cases = [(n, flight) for n in segments for flight in FLIGHTS]
    rows = [(*case, *printed(sources, ["./host"], case[1], count, STEP, case[0], FIXED_STEP)) for case in cases]
    columns = ["segments", "flight", "clock: median [us]", "99.99 % [us]", "longest [us]"]
    columns += ["processor: median [us]", "99.99 %  [us]", "longest  [us]", "iterations, at most"]
    return pd.DataFrame(rows, columns=columns)


def described(count):
    """Where and how often steps were taken, and the bound of their work."""
    at_most = round(STEP / FIXED_STEP) * WORST_WORK
    machine = f"{datetime.now(UTC):%Y-%m-%d}, {processor()}, {os.cpu_count()} cores, {system()}"
    bound = f"{count:_} communication steps each, of which the code bounds the iterations to {at_most}.".replace("_", " ")
    return f"{bound}\n{machine}; load {os.getloadavg()[0]:.1f}.\n"


if __name__ == "__main__":
    wanted = options(__doc__, of=("processors", "steps"), steps=1_000_000, segments=[5, 10, 20, 40], into="")
    with tempfile.TemporaryDirectory() as temporary:
        made = prepared(Path(temporary))
        if wanted.of == "processors":
            processors(*made)
            systems_without_warnings(Path(temporary))
        else:
            table = steps(*made, wanted.steps, wanted.segments)
            print(described(wanted.steps), markdown(table), sep="\n")
            if wanted.into:
                table.to_csv(wanted.into, index=False)
