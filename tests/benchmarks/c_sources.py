"""FMUs compiled by their importer: built from their C sources by FMPy, they give the numbers of the native ones.

    python tests/benchmarks/c_sources.py [--names NAME or FILE ...] [--fmi 2 3] [--levels 0 2 3]

All tethers, two systems and both versions of FMI: compiled by cmake from the files of the FMU alone, in an empty folder
without any environment, by FMPy with all warnings, and by gcc with several options; validated; flown with their evidence
sets beside the native library. The memory that an instance takes, with room for all segments and for 40. Needs cmake and
gcc. FILE : of a system of tethers.
"""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from as_script import EXAMPLES, options
from fmpy import extract
from fmpy.build import build_platform_binary
from fmpy.validation import validate_fmu

from native import as_importers_do as importer
from tetherfmu.export import system_fmus
from tetherfmu.export.archive import SLAVES
from tetherfmu.export.native import native_fmus as native
from tetherfmu.runtime.kernel_library import SUFFIXES

SYSTEMS = [str(EXAMPLES / "systems" / f"{name}.toml") for name in ("y_bridle", "two_kites")]


def built(name, folder, fmi):
    """Path of the FMU of a tether, or of the system in a file, with its sources."""
    if name.endswith(".toml"):
        return system_fmus.build(name, folder, native=fmi, with_sources=True)
    return native.build(name, folder, fmi=fmi, with_sources=True)


def compiled_by_fmpy(path, folder):
    """The library that FMPy makes of the sources of an FMU, with all warnings."""
    unpacked = Path(extract(str(path), str(folder / "fmpy")))
    shutil.rmtree(unpacked / "binaries")
    build_platform_binary(unpacked, all_warnings=True)
    return next((unpacked / "binaries").glob(f"*/*{SUFFIXES['linux']}"))


def compiled_alone(path, folder):
    """The library that cmake makes of the sources of an FMU by their own project, in a folder with nothing else."""
    alone = folder / "alone"
    shutil.copytree(importer.unpacked(path, folder), alone)
    for command in (["cmake", "-S", ".", "-B", "build"], ["cmake", "--build", "build"]):
        subprocess.run(command, cwd=alone, env={"PATH": os.defpath}, check=True, capture_output=True)
    return alone / "build" / f"{path.stem}{SUFFIXES['linux']}"


def different(one, other):
    """How many numbers of two flights differ in any bit, and of how many."""
    assert one.keys() == other.keys()
    pairs = [(np.array(one[name]), np.array(other[name])) for name in one]
    return sum(int((a.view(np.uint64) != b.view(np.uint64)).sum()) for a, b in pairs), sum(a.size for a, _ in pairs)


def memory(path, folder, options=()):
    """Memory of an instance [MB]."""
    sources = importer.unpacked(path, folder)
    size = '#include "fmu.c"\n#include <stdio.h>\nint main(void) { return printf("%zu", ARRAYS_AT + PLACES * PLACE) < 0; }\n'
    (sources / "size.c").write_text(size, encoding="utf-8")
    subprocess.run(["gcc", *options, "size.c", "-o", "size", "-lm"], cwd=sources, check=True)
    return 1e-6 * int(subprocess.run([sources / "size"], capture_output=True, text=True, check=True).stdout)


def main(names, versions, levels):
    """Print a table; versions : of FMI.  levels : of optimization by gcc, which is the same for both."""
    print("FMU, FMI, compiled by, numbers of the evidence run that differ from the native FMU's, problems of validation")
    for name in names:
        for fmi in versions:
            with tempfile.TemporaryDirectory() as temporary:
                folder = Path(temporary) / f"fmi{fmi}"
                path = built(name, folder, fmi)
                most, forty = (memory(path, folder, options) for options in ((), ("-DMAX_SEGMENTS=40",)))
                print(f"{path.stem}, {fmi}: an instance takes {most:.2f} MB, {forty:.2f} MB for 40 segments", flush=True)
                expected = importer.evidence_run(path)
                libraries = {"cmake": compiled_alone(path, folder), "FMPy": compiled_by_fmpy(path, folder)}
                for level in levels if fmi == versions[0] else ():
                    libraries[f"gcc -O{level}"] = importer.compiled(path, folder, [f"-O{level}", "-ffp-contract=off"])
                for how, library in libraries.items():
                    place = folder / how.replace(" ", "_")
                    place.mkdir()
                    other = importer.with_library(path, library, place, fmi)
                    wrong, count = different(expected, importer.evidence_run(other))
                    print(f"{path.stem}, {fmi}, {how}, {wrong} of {count}, {len(validate_fmu(str(other)))}", flush=True)


if __name__ == "__main__":
    wanted = options(__doc__, names=[*SLAVES, *SYSTEMS], fmi=[2, 3], levels=[0, 2, 3])
    main(wanted.names, wanted.fmi, wanted.levels)
