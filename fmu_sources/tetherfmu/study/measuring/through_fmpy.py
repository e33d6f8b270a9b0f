"""Cost of an FMU in a host: FMPy sets, steps, gets. Each measurement runs in a process of its own."""

import atexit
import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from time import perf_counter

import numpy as np

from tetherfmu.export.archive import SLAVES, build
from tetherfmu.runtime.kernel_library import this_platform
from tetherfmu.study.scenes.standard import CIRCLE_LENGTH, QUASI_STEADY_START, STEP, circle_inputs


def fmus_in(folder):
    """Paths of all FMUs by name; those that are missing are built for this platform."""
    paths = {name: Path(folder) / f"{name}.fmu" for name in SLAVES}
    for name, path in paths.items():
        if not path.exists():
            build(name, folder, platforms=(this_platform(),))
    return paths


def references(description):
    """Value references by name."""
    return {variable.name: variable.valueReference for variable in description.modelVariables}


def vectors(table, *names):
    """Value references of three-vectors."""
    return [table[f"{name}[{i}]"] for name in names for i in (1, 2, 3)]


def loaded(path):
    """The FMU at a path, ready to be instantiated, and its value references by name."""
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Slave

    description = read_model_description(path)
    name = description.coSimulation.modelIdentifier
    fmu = FMU2Slave(guid=description.guid, unzipDirectory=extract(path), modelIdentifier=name, instanceName=name)
    # PythonFMU's library must stay loaded, and must not end the interpreter of this process a second time
    if hasattr(fmu.dll, "finalizePythonInterpreter"):
        atexit.register(fmu.dll.finalizePythonInterpreter)
    return fmu, references(description)


def prepared(fmu, table, inputs):
    """Instantiate, set the scene "circle" and end the initialization."""
    fmu.instantiate()
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
    prepared(fmu, table, inputs[0])
    times = np.zeros((len(inputs), 4))
    for k, values in enumerate(inputs):
        begin = perf_counter()
        fmu.setReal(sets, values)
        after_set = perf_counter()
        fmu.doStep(k * STEP, STEP)
        after_step = perf_counter()
        fmu.getReal(gets)
        times[k] = begin, after_set, after_step, perf_counter()
    return np.median(np.diff(times), axis=0).tolist()


def start(fmu, table, inputs):
    """Time [s] from instantiation to the end of the first step."""
    begin = perf_counter()
    prepared(fmu, table, inputs[0])
    fmu.doStep(0.0, STEP)
    return [perf_counter() - begin]


def measure(what, path, steps):
    """Times [s] of one measurement in this process."""
    fmu, table = loaded(path)
    times = {"costs": costs, "start": start}[what](fmu, table, circle_inputs(steps)[:, :6].tolist())
    fmu.terminate()
    fmu.fmi2FreeInstance(fmu.component)
    return times


def measured(what, path, steps, repeats):
    """Medians [s] of a measurement over so many new processes: of the "costs" of a step, or of the "start"."""
    one_each = {"max_workers": 1, "mp_context": multiprocessing.get_context("spawn"), "max_tasks_per_child": 1}
    with ProcessPoolExecutor(**one_each) as executor:
        tasks = [executor.submit(measure, what, str(path), steps) for _ in range(repeats)]
        return np.median([task.result() for task in tasks], axis=0).tolist()
