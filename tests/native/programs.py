"""Programs in C around the shell of native FMUs, compiled with gcc for this machine: with sanitizers, or to be measured."""

import shutil
import subprocess

from tetherfmu.export.native.c_tables import header
from tetherfmu.export.native.native_fmus import HEADERS
from tetherfmu.libraries import ready
from tetherfmu.libraries.ahead_of_time import object_name
from tetherfmu.libraries.native_shell import SHELL, unit
from tetherfmu.runtime.kernel_library import this_platform
from tetherfmu.runtime.variants import library_of
from tetherfmu.wiring.fmu import of_tether

SANITIZED = ("-g", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all")
WARNINGS = ("-Wall", "-Wextra", "-Werror", "-Wno-unused-parameter", "-Wno-cast-function-type")


def available():
    """Whether programs can be compiled and run here."""
    return shutil.which("gcc") is not None and this_platform() == "x86_64-linux"


def compiled(folder, variant, fmi, source, options, segments=3, shape_points=5, shell=True):
    """Path of the program that a C file (its path) becomes, with the tables of a variant for a version of FMI.

    shell : whether the shell and the kernels are in the program.
    """
    wiring = of_tether(variant, {"segments": segments, "shape_points": shape_points})
    (folder / "tables.h").write_text(header(wiring, fmi, "{token}"))
    (folder / "unit.c").write_text(f'{unit(fmi) if shell else ""}#include "{source}"\n')
    library = library_of(variant)
    kernels = ready.folders([library], [this_platform()])[library] / object_name(this_platform())
    places = [f"-I{place}" for place in (folder, SHELL, HEADERS)]
    parts = ["unit.c", *([str(kernels)] if shell else [])]
    program = folder / source.stem
    defined = f"-DFMI={fmi}", f"-DSHAPE_POINTS={shape_points}"
    command = ["gcc", "-std=c99", *WARNINGS, *defined, *places, *parts, *options, "-o", str(program)]
    done = subprocess.run([*command, "-lm"], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return program
