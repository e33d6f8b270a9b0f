"""The C sources of TetherDynamic on other processors, and what the slowest of many fixed steps costs.

    python tests/benchmarks/c_sources_elsewhere.py processors
    python tests/benchmarks/c_sources_elsewhere.py steps [--steps 1000000] [--segments 5,10,20,40]

processors : compiles for several processors with all warnings as errors, by the compiler inside `ziglang` with its small C
library, runs each program (needs qemu-user) and compares the forces of a circle with those of this processor.
steps : the circle with fixed steps of 5 ms in communication steps of 20 ms, in a host in C compiled by gcc. Times are of the
processor; what the operating system does to caches in between counts.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from fmpy import read_model_description

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from native import as_importers_do as importer
from scenes import REVOLUTION, circle
from tetherfmu.export import native
from tetherfmu.libraries.linking import zig

NAME, STEP, FIXED_STEP, STEPS = "TetherDynamic", 0.02, 0.005, 1000
HOST = Path(__file__).with_name("c_sources_host.c")
PLACES = {
    "SEGMENTS_AT": "segments",
    "FIXED_STEP_AT": "fixed_step",
    "KITE_AT": "kite_position[1]",
    "FORCES_AT": "ground_force[1]",
}
PROCESSORS = {  # target of the compiler, its options, and what runs the program
    "x86_64": ("x86_64-linux-musl", (), ()),
    "aarch64": ("aarch64-linux-musl", (), ("qemu-aarch64",)),
    "riscv64": ("riscv64-linux-musl", (), ("qemu-riscv64",)),
    "armv7": ("arm-linux-musleabihf", ("-mcpu=generic+v7a+vfp3",), ("qemu-arm",)),
}


def prepared(folder):
    """Folder with the sources, the host and its inputs; options of the compiler."""
    path = native.build(NAME, folder, with_sources=True)
    sources = importer.unpacked(path, folder)
    (sources / HOST.name).write_bytes(HOST.read_bytes())
    np.array([np.ravel(circle(k * STEP)) for k in range(round(REVOLUTION / STEP))]).tofile(sources / "inputs")
    places = {each.name: each.valueReference for each in read_model_description(str(path)).modelVariables}
    defined = [f"-D{name}={places[variable]}" for name, variable in PLACES.items()]
    return sources, ["-std=c99", "-O2", *importer.WARNINGS, "-Wno-unused-parameter", *defined, "-DFMI2_FUNCTION_PREFIX=T_"]


def printed(sources, program, *arguments):
    """Numbers that the host prints."""
    command = [*program, "inputs", *map(str, arguments)]
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
            printed(sources, [*runner, f"./{name}"], STEPS, STEP, 20, fixed_step, "outputs")
            found = np.fromfile(sources / "outputs")
            reference = expected.setdefault(fixed_step, found)
            difference = abs(found - reference).max() / abs(reference).max()
            print(f"{name}, {size:.0f}, {fixed_step:g}, {difference:.1e}", flush=True)


def steps(sources, options, count, segments):
    """Print the time of the slowest step, and of all."""
    importer.run(["gcc", *options, HOST.name, "-lm", "-o", "host"], sources)
    print("segments, slowest step [us], mean [us]")
    for n in segments:
        slowest, mean = printed(sources, ["./host"], count, STEP, n, FIXED_STEP)
        print(f"{n}, {slowest:.0f}, {mean:.1f}", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("processors", "steps"))
    parser.add_argument("--steps", type=int, default=1_000_000)
    parser.add_argument("--segments", default="5,10,20,40")
    wanted = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        made = prepared(Path(temporary))
        if wanted.what == "processors":
            processors(*made)
        else:
            steps(*made, wanted.steps, [int(each) for each in wanted.segments.split(",")])
