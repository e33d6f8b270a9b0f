"""A scene flown with an FMU in FMPy: what a step costs there. Each flight runs in a process of its own."""

import atexit
import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from time import perf_counter

import pandas as pd

from tetherfmu.runtime.variables import INPUT_NAMES
from tetherfmu.runtime.variants import class_name

from .runs import parameters_of
from .through_fmpy import references, vectors


def inputs_by_name(scene, step):
    """Inputs of an FMU in all communication steps [s] of a scene, a DataFrame with a column for each."""
    return pd.DataFrame(scene.inputs(step)[:, list(INPUT_NAMES)], columns=INPUT_NAMES.values())


def fly(path, parameters, inputs, step):
    """Time [s] of all steps, those inputs set that change and both forces got, and the last force on the kite [N]."""
    from fmpy import extract, instantiate_fmu, read_model_description
    from fmpy.simulation import apply_start_values

    description = read_model_description(path)
    fmu = instantiate_fmu(extract(path), description, "CoSimulation")
    # PythonFMU's library must stay loaded, and must not end the interpreter of this process a second time
    if hasattr(fmu.dll, "finalizePythonInterpreter"):
        atexit.register(fmu.dll.finalizePythonInterpreter)
    fmu.setupExperiment(startTime=0.0)
    apply_start_values(fmu, description, parameters)
    fmu.enterInitializationMode()
    apply_start_values(fmu, description, inputs.iloc[0].to_dict())
    fmu.exitInitializationMode()
    table = references(description)
    moving = inputs.loc[:, inputs.nunique() > 1]
    changed, wanted = [table[name] for name in moving], vectors(table, "ground_force", "kite_force")
    rows = moving.to_numpy().tolist()
    began = perf_counter()
    for k, row in enumerate(rows):
        if row:
            fmu.setReal(changed, row)
        fmu.doStep(k * step, step)
        forces = fmu.getReal(wanted)
    seconds = perf_counter() - began
    fmu.terminate()
    fmu.fmi2FreeInstance(fmu.component)
    return seconds, forces[3:]


def flown(folder, scene, config):
    """Time per simulated second [-] through FMPy, and the last force on the kite [N], of a configuration.

    folder : with the FMUs.
    """
    path = str(Path(folder) / f"{class_name(config.variant)}.fmu")
    task = path, parameters_of(scene, config), inputs_by_name(scene, config.step), config.step
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as own_process:
        seconds, force = own_process.submit(fly, *task).result()
    return seconds / (scene.count * scene.every), force
