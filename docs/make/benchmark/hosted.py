"""FMUs in a host: FMPy sets the inputs that change, steps, and gets both end forces; each flight in its own process."""

import multiprocessing
from concurrent.futures import ProcessPoolExecutor
from time import perf_counter

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from fmpy.simulation import apply_start_values

from tetherfmu.study.measuring.runs import parameters_of
from tetherfmu.study.measuring.scene_fmus import inputs_of


def fly(path, parameters, inputs, step):
    """A flight of an FMU with these parameters and inputs (`fmus.by_name`) at a communication step [s], in this process.

    Returns the time [s] from instantiation to the end of the first step, an array (steps, 3) of the times [s] of setting,
    stepping and getting, and a list, the last force on the kite [N].
    """
    description = read_model_description(path)
    name = description.coSimulation.modelIdentifier
    fmu = FMU2Slave(guid=description.guid, unzipDirectory=extract(path), modelIdentifier=name, instanceName=name)
    places = {variable.name: variable.valueReference for variable in description.modelVariables}
    moving = inputs.loc[:, inputs.nunique() > 1]
    sets = [places[name] for name in moving]
    gets = [places[f"{end}_force[{axis}]"] for end in ("ground", "kite") for axis in (1, 2, 3)]
    rows, times = moving.to_numpy().tolist(), np.zeros((len(inputs), 4))
    began = perf_counter()
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    apply_start_values(fmu, description, parameters)
    fmu.enterInitializationMode()
    apply_start_values(fmu, description, inputs.iloc[0].to_dict())
    fmu.exitInitializationMode()
    for k, row in enumerate(rows):
        before = perf_counter()
        if row:
            fmu.setReal(sets, row)
        after_set = perf_counter()
        fmu.doStep(k * step, step)
        after_step = perf_counter()
        forces = fmu.getReal(gets)
        times[k] = before, after_set, after_step, perf_counter()
    fmu.terminate()
    fmu.fmi2FreeInstance(fmu.component)  # the library stays loaded: see `fmi.workarounds`
    return times[0, 2] - began, np.diff(times), forces[3:]


def hosted(path, scene, config, steps=None, repeats=1):
    """What `fly` returns of flights of a configuration through a scene, or its first steps; each in a new process."""
    flight = str(path), parameters_of(scene, config), inputs_of(scene, config.step)[:steps], config.step
    with ProcessPoolExecutor(1, multiprocessing.get_context("spawn"), max_tasks_per_child=1) as executor:
        return [executor.submit(fly, *flight).result() for _ in range(repeats)]
