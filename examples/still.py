"""How does a tether FMU hang while nothing moves? Helper of the examples on tethers at rest."""

from typing import NamedTuple

import numpy as np
from fmu_tools import running, variables_of


class Rest(NamedTuple):
    """A tether at rest, SI units."""

    ground_force: np.ndarray  # (3,), of the tether on the ground station
    kite_force: np.ndarray  # (3,), of the tether on the kite
    shape: np.ndarray  # (points, 3), ground first, kite last


def hold(fmu_file, cases, kite, shape=False):
    """Initialize an FMU once for each case, with its kite at rest; list of `Rest`.

    cases : dicts of the parameters to change, and `wind` [m/s], a vector.  kite [m] : its position.  shape : whether it
    is wanted; otherwise it is empty.
    """
    variables, rests = variables_of(fmu_file), []
    outputs = variables.of("ground_force", "kite_force", *(["shape"] if shape else []))
    with running(fmu_file, variables.description) as (fmu, stop_if_pressed):

        def set_values(values):
            for name, value in values.items():
                put = fmu.setInteger if isinstance(value, int) else fmu.setReal
                put(variables.of(name), np.ravel(value))

        for case in cases:
            fmu.setupExperiment(startTime=0.0)
            set_values({name: value for name, value in case.items() if name != "wind"})
            fmu.enterInitializationMode()
            set_values({"kite_position": kite})
            wind = case.get("wind", (0.0, 0.0, 0.0))
            if any(wind) or variables.those_of("wind_velocity"):  # an FMU of a scene without wind has none
                set_values({"wind_velocity": wind})
            fmu.exitInitializationMode()
            values = np.array(fmu.getReal(outputs))
            rests.append(Rest(values[:3], values[3:6], values[6:].reshape(-1, 3)))
            fmu.reset()
            stop_if_pressed()
    return rests
