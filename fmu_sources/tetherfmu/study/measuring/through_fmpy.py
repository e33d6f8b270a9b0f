"""FMUs in a host: FMPy sets the inputs that change, steps, and gets both end forces; each flight in its own process."""

import multiprocessing
from pathlib import Path
from time import perf_counter
from zipfile import is_zipfile

import numpy as np
import pandas as pd

from tetherfmu.console.ending import WrongUse
from tetherfmu.export.archive import build
from tetherfmu.export.build_options import BuildOptions
from tetherfmu.runtime.variables import INPUT, variables, wind_at_names
from tetherfmu.runtime.variants import DYNAMIC_FREE, VARIANTS, class_name

from .executors import executor_of
from .runs import fmu_of, parameters_of


def fmus_in(folder, variants=VARIANTS, wind_points=0):
    """Paths of the FMUs of variants by name; those that are missing are built for this platform.

    wind_points : of the FMUs, which are in a folder of their own if they have any.
    """
    folder = Path(folder, f"wind_points_{wind_points}") if wind_points else Path(folder)
    paths = {name: folder / f"{name}.fmu" for name in map(class_name, variants)}
    for name, path in paths.items():
        if not path.exists():
            build(name, folder, BuildOptions(wind_points=wind_points))
        if not is_zipfile(path):
            raise WrongUse(f"{path} is no FMU: it is no zip archive")
    return paths


def by_name(inputs, kite_is_free=False):
    """Inputs (steps, `layout.INPUTS`) as a DataFrame with a column for each input of an FMU that is a number."""
    table = variables(DYNAMIC_FREE.name if kite_is_free else VARIANTS[0], 0)
    places = {each.name: each.place for each in table if each.causality == INPUT and each.kind == "Real"}
    return pd.DataFrame(inputs[:, list(places.values())], columns=list(places))


def inputs_of(scene, step):
    """Inputs of all communication steps [s] of a scene, likewise, with the wind at its wind points if it has them."""
    found, wind = by_name(scene.inputs(step), scene.kite_is_free), scene.wind_at(step)
    if wind is None:
        return found
    names = list(wind_at_names(scene.wind_points))
    return pd.concat([found, pd.DataFrame(wind.reshape(len(wind), -1), columns=names)], axis=1)


def fly(path, parameters, inputs, step):
    """A flight of an FMU with these parameters and inputs (`by_name`) at a communication step [s], in this process.

    Returns the time [s] from instantiation to the end of the first step, an array (steps, 3) of the times [s] of setting,
    stepping and getting, and a list, the last force on the kite [N].
    """
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Slave
    from fmpy.simulation import apply_start_values

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
    flight = (
        str(path),
        parameters_of(scene, config),
        inputs_of(scene, config.step)[:steps],
        config.step,
    )
    with executor_of(processes=1, mp_context=multiprocessing.get_context("spawn"), max_tasks_per_child=1) as executor:
        tasks = [executor.submit(fly, *flight) for _ in range(repeats)]
        return [task.result() for task in tasks]


def flown(folder, scene, config):
    """Time per simulated second [-] and last force on the kite [N] of a configuration, through FMPy; FMUs in a folder."""
    variant = DYNAMIC_FREE.name if scene.kite_is_free else config.variant
    path = fmus_in(folder, (variant,), scene.wind_points)[fmu_of(scene, config)]
    ((_, costs, kite_force),) = hosted(path, scene, config)
    return float(costs.sum()) / (scene.count * scene.every), kite_force
