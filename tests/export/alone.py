"""Run FMUs with nothing but fmpy: `python alone.py FOLDER`; prints the time from instantiation to the end of the first step.

Used in two ways: by a test, with all other packages forbidden, and by the CI script in an environment without them.
"""

import atexit
import sys
import time
from pathlib import Path

from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

FORBIDDEN = ("tetherfmu", "numba", "llvmlite", "scipy")


class Forbid:
    """Import hook that refuses the packages which an FMU must not need."""

    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in FORBIDDEN:
            raise ImportError(f"{name} is forbidden here")


def first_step(path):
    """Seconds from instantiation to the end of the first step of 20 ms."""
    description = read_model_description(str(path))
    folder = extract(str(path))
    started = time.perf_counter()
    fmu = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName=path.stem,
    )
    fmu.instantiate(loggingOn=True)
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    fmu.doStep(0.0, 0.02)
    elapsed = time.perf_counter() - started
    tension = next(v.valueReference for v in description.modelVariables if v.name == "kite_tension")
    assert 1.0 < fmu.getReal([tension])[0] < 1000.0
    return elapsed, fmu


if __name__ == "__main__":
    sys.meta_path.insert(0, Forbid())
    for path in sorted(Path(sys.argv[1]).glob("*.fmu")):
        elapsed, fmu = first_step(path)
        atexit.register(fmu.dll.finalizePythonInterpreter)
        print(f"{path.stem}: first step after {elapsed:.3f} s, {path.stat().st_size} bytes")
