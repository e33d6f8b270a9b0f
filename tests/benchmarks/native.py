"""What a native FMU costs: in a host in C beside the bare kernels, in FMPy beside PythonFMU's, to start, to hold, to build.

    python tests/benchmarks/native.py

Kernels must be compiled (`tetherfmu build` does it). Needs gcc and 64-bit Linux. What is compared alternates in one run.
"""

import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from statistics import median
from time import process_time

import numpy as np
from as_script import TESTS  # noqa: F401 (the tests are found)
from fmpy import extract, read_model_description

from native import programs
from runtime.host import Host
from scenes import circle, kite_at_start
from tetherfmu.export import archive
from tetherfmu.export.build_options import BuildOptions
from tetherfmu.export.native import native_fmus as native
from tetherfmu.libraries import ready
from tetherfmu.runtime.kernel_library import file_name, this_platform

NAME, STEP, STEPS, ROUNDS = "TetherDynamic", 0.02, 500, 15
OPTIONS = BuildOptions()


def rows():
    """Position and velocity of the kite on the circle, a row for each step."""
    return np.array([np.ravel(circle(k * STEP)) for k in range(STEPS)])


def in_c(path, folder):
    """Numbers that `native_host.c` prints."""
    source = Path(__file__).with_name("native_host.c")
    sizes = OPTIONS.segments, OPTIONS.shape_points
    host = programs.compiled(folder, "dynamic", 2, source, ("-O2", "-ldl"), *sizes, shell=False)
    (folder / "inputs").write_bytes(rows().tobytes())
    library = Path(extract(str(path), str(folder / "fmu"))) / "binaries" / "linux64" / f"{NAME}.so"
    kernels = ready.folders(["dynamic"], [this_platform()])["dynamic"] / file_name("dynamic", this_platform())
    command = [host, library, read_model_description(str(path)).guid, kernels, folder / "inputs"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"native_host: exit status {done.returncode}: {done.stderr}")
    return map(float, done.stdout.split())


def in_fmpy(path, motion):
    """Time of the processor for a step [us] in FMPy: six inputs, the step, six outputs."""
    host = Host(path).start(**kite_at_start(NAME, *circle(0.0)))
    moved = [host.reference[f"{name}[{i}]"] for name in ("kite_position", "kite_velocity") for i in (1, 2, 3)]
    read = [host.reference[f"{name}[{i}]"] for name in ("ground_force", "kite_force") for i in (1, 2, 3)]
    began = process_time()
    for k, row in enumerate(motion):
        host.fmu.setReal(moved, row)
        host.fmu.doStep(k * STEP, STEP)
        host.fmu.getReal(read)
    taken = process_time() - began
    host.free()
    return 1e6 * taken / len(motion)


def building(folder, platforms):
    """Time of all processors [s] to build all native FMUs with an empty cache of Zig."""
    environment = {**os.environ, "ZIG_GLOBAL_CACHE_DIR": str(folder / "zig"), "ZIG_LOCAL_CACHE_DIR": str(folder / "zig")}
    build = ["build", "--native", "--platforms", platforms, "--out", str(folder / "out")]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-m", "tetherfmu", *build], env=environment, capture_output=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main(folder):
    """Print a line for each number."""
    builders = {"PythonFMU": archive, "native": native}
    paths = {flavour: builder.build(NAME, folder / flavour, OPTIONS) for flavour, builder in builders.items()}
    bare, whole, above, first, each = in_c(paths["native"], folder)
    print(f"in a host in C, {OPTIONS.segments} segments: kernels {bare:.2f} us, FMU {whole:.2f} us, {above:.2f} us above")
    print(f"from instantiation to the end of the first step: {first / 1e3:.2f} ms; an instance holds {each / 1e3:.1f} kB")
    folders, motion = {flavour: extract(str(path)) for flavour, path in paths.items()}, rows().tolist()
    times = [{flavour: in_fmpy(place, motion) for flavour, place in folders.items()} for _ in range(ROUNDS)]
    shares = [time["native"] / time["PythonFMU"] for time in times]
    middle = {flavour: median(time[flavour] for time in times) for flavour in paths}
    print(f"in FMPy: PythonFMU {middle['PythonFMU']:.1f} us, native {middle['native']:.1f} us, {100 * median(shares):.0f} %")
    for platforms in (this_platform(), "all"):
        with tempfile.TemporaryDirectory() as empty:
            print(f"building all native FMUs for {platforms}: {building(Path(empty), platforms):.1f} s of all processors")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as temporary:
        main(Path(temporary))
