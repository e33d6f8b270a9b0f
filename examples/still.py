"""How does a tether FMU hang while nothing moves? Helper of the examples on tethers at rest."""

import shutil
from typing import NamedTuple

import numpy as np
from circular_flight import load
from fmpy import read_model_description


class Rest(NamedTuple):
    """A tether at rest, SI units."""

    ground_force: np.ndarray  # (3,), of the tether on the ground station
    kite_force: np.ndarray  # (3,), of the tether on the kite
    shape: np.ndarray  # (points, 3), ground first, kite last


def hold(fmu_file, cases, kite):
    """Initialize an FMU once for each case, with its kite at rest; list of `Rest`.

    cases : dicts of the parameters to change, and `wind` [m/s], a vector.  kite [m] : its position.
    """
    description = read_model_description(str(fmu_file))
    variables = {variable.name: variable for variable in description.modelVariables}
    outputs = [f"{name}[{i}]" for name in ("ground_force", "kite_force") for i in (1, 2, 3)]
    outputs += [name for name in variables if name.startswith("shape[")]
    fmu, folder = load(fmu_file, description)

    def set_values(values):
        for name, value in values.items():
            put = fmu.setInteger if variables[name].type in ("Integer", "Enumeration") else fmu.setReal
            put([variables[name].valueReference], [value])

    rests = []
    for case in cases:
        parameters = {name: value for name, value in case.items() if name != "wind"}
        fmu.setupExperiment(startTime=0.0)
        set_values(parameters)
        fmu.enterInitializationMode()
        set_values({f"kite_position[{i + 1}]": value for i, value in enumerate(kite)})
        set_values({f"wind_velocity[{i + 1}]": value for i, value in enumerate(case.get("wind", (0.0, 0.0, 0.0)))})
        fmu.exitInitializationMode()
        values = np.array(fmu.getReal([variables[name].valueReference for name in outputs]))
        rests.append(Rest(values[:3], values[3:6], values[6:].reshape(-1, 3)))
        fmu.reset()
    fmu.fmi2FreeInstance(fmu.component)  # not freeInstance, see `load`
    shutil.rmtree(folder, ignore_errors=True)
    return rests
