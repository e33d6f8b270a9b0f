"""Do a step with FMPy and let the process end: `python leave.py FOLDER END`.

FOLDER: where an FMU was extracted. END: nothing (the instance lives on), free (the instance is freed, the library stays
loaded), unload (as `freeInstance` of FMPy does) or handler (nothing but the exit handler of docs/contributors/fmus.md).
"""

import atexit
import sys

from fmpy import read_model_description
from fmpy.fmi2 import FMU2Slave


def main(folder, end):
    """Instantiate, step, and leave in one of four ways."""
    description = read_model_description(folder)
    fmu = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="tether",
    )
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    fmu.doStep(0.0, 0.02)
    if end == "free":
        fmu.fmi2FreeInstance(fmu.component)
    elif end == "unload":
        fmu.freeInstance()
    elif end == "handler":
        atexit.register(fmu.dll.finalizePythonInterpreter)


if __name__ == "__main__":
    main(*sys.argv[1:])
