"""Cost of an FMU in a host: FMPy sets, steps, gets. Each measurement runs in a process of its own.

python -m tetherfmu.study.measuring.through_fmpy costs|start FMU STEPS      prints a JSON list of times [s]
"""

import atexit
import json
import subprocess
import sys
from statistics import median
from time import perf_counter

STEP = 0.02
CIRCLE_LENGTH = 525.0
QUASI_STEADY_START = 2


def references(description):
    """Value references by name."""
    return {variable.name: variable.valueReference for variable in description.modelVariables}


def vectors(table, *names):
    """Value references of three-vectors."""
    return [table[f"{name}[{i}]"] for name in names for i in (1, 2, 3)]


def prepared(fmu, table, inputs):
    """Set the scene "circle" and end the initialization."""
    fmu.setupExperiment(startTime=0.0)
    fmu.setReal([table["initial_length"]], [CIRCLE_LENGTH])
    fmu.setInteger([table["initial_shape"]], [QUASI_STEADY_START])
    fmu.enterInitializationMode()
    fmu.setReal(vectors(table, "wind_velocity"), [8.0, 0.0, 0.0])
    fmu.setReal(vectors(table, "kite_position", "kite_velocity"), inputs)
    fmu.exitInitializationMode()


def costs(fmu, table, inputs):
    """Median time [s] of setting six inputs, of the step, and of getting six forces."""
    sets, gets = vectors(table, "kite_position", "kite_velocity"), vectors(table, "ground_force", "kite_force")
    fmu.instantiate()
    prepared(fmu, table, inputs[0])
    times = []
    for k, values in enumerate(inputs):
        begin = perf_counter()
        fmu.setReal(sets, values)
        after_set = perf_counter()
        fmu.doStep(k * STEP, STEP)
        after_step = perf_counter()
        fmu.getReal(gets)
        times.append((after_set - begin, after_step - after_set, perf_counter() - after_step))
    return [median(column) for column in zip(*times, strict=True)]


def start(fmu, table, inputs):
    """Time [s] from instantiation to the end of the first step."""
    begin = perf_counter()
    fmu.instantiate()
    prepared(fmu, table, inputs[0])
    fmu.doStep(0.0, STEP)
    return [perf_counter() - begin]


def main(measure, path, steps):
    """Load the FMU, print the times."""
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Slave

    from tetherfmu.study.scenes.standard import circle_inputs

    inputs = circle_inputs(int(steps))[:, :6].tolist()
    description = read_model_description(path)
    identifier = description.coSimulation.modelIdentifier
    fmu = FMU2Slave(guid=description.guid, unzipDirectory=extract(path), modelIdentifier=identifier, instanceName=identifier)
    # PythonFMU's library must stay loaded, and must not end the interpreter of this process a second time
    if hasattr(fmu.dll, "finalizePythonInterpreter"):
        atexit.register(fmu.dll.finalizePythonInterpreter)
    print(json.dumps({"costs": costs, "start": start}[measure](fmu, references(description), inputs)))
    fmu.terminate()
    fmu.fmi2FreeInstance(fmu.component)


def measured(measure, path, steps, repeats):
    """Medians of a measurement over so many new processes."""
    command = [sys.executable, "-m", "tetherfmu.study.measuring.through_fmpy", measure, str(path), str(steps)]
    runs = [
        json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()[-1])
        for _ in range(repeats)
    ]
    return [median(column) for column in zip(*runs, strict=True)]


if __name__ == "__main__":
    main(*sys.argv[1:])
