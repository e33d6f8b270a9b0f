"""FMUs compiled by their importer: built from their C sources by FMPy, they give the numbers of the native ones.

    python tests/benchmarks/c_sources.py [NAME ...]

All tethers and both versions of FMI: compiled with all warnings, by cmake from the files of the FMU alone; validated; flown
with their evidence sets beside the native library, with several options of the compiler. Needs cmake and gcc.
"""

import shutil
import sys
import tempfile
from pathlib import Path

import numpy as np
from fmpy import extract
from fmpy.build import build_platform_binary
from fmpy.validation import validate_fmu

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from native import as_importers_do as importer
from tetherfmu.export import native
from tetherfmu.export.archive import SLAVES
from tetherfmu.runtime.kernel_library import SUFFIXES

OPTIONS = ("-O0", "-O2", "-O3")


def compiled_by_fmpy(path, folder):
    """The library that FMPy makes of the sources of an FMU, with all warnings."""
    unpacked = Path(extract(str(path), str(folder / "fmpy")))
    shutil.rmtree(unpacked / "binaries")
    build_platform_binary(unpacked, all_warnings=True)
    return next((unpacked / "binaries").glob(f"*/*{SUFFIXES['linux']}"))


def different(one, other):
    """How many numbers of two flights differ in any bit, and of how many."""
    assert one.keys() == other.keys()
    pairs = [(np.array(one[name]), np.array(other[name])) for name in one]
    return sum(int((a.view(np.uint64) != b.view(np.uint64)).sum()) for a, b in pairs), sum(a.size for a, _ in pairs)


def main(names):
    """Print a table."""
    print("FMU, FMI, compiled by, numbers of the evidence run that differ from the native FMU's, problems of validation")
    for name in names or SLAVES:
        for fmi in (2, 3):
            with tempfile.TemporaryDirectory() as temporary:
                folder = Path(temporary) / f"fmi{fmi}"
                path = native.build(name, folder, fmi=fmi, with_sources=True)
                expected = importer.evidence_run(path)
                libraries = {"FMPy (cmake)": compiled_by_fmpy(path, folder)}
                for options in OPTIONS if fmi == 2 else ():
                    libraries[f"gcc {options}"] = importer.compiled(path, folder, [options, "-ffp-contract=off"])
                for how, library in libraries.items():
                    place = folder / how.replace(" ", "_")
                    place.mkdir()
                    other = importer.with_library(path, library, place, fmi)
                    wrong, count = different(expected, importer.evidence_run(other))
                    print(f"{name}, {fmi}, {how}, {wrong} of {count}, {len(validate_fmu(str(other)))}", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
