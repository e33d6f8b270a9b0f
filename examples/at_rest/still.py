"""How does a tether FMU hang while nothing moves? Helper of the examples on tethers at rest."""

from typing import NamedTuple

import numpy as np

from shared.fmu_tools import running, variables_of
from shared.named_fmu import NamedFmu


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
    with running(fmu_file, variables.description) as (instance, stop_if_pressed):
        fmu = NamedFmu(variables, instance)
        for case in cases:
            inputs, wind = {"kite_position": kite}, case.get("wind", (0.0, 0.0, 0.0))
            if any(wind) or variables.those_of("wind_velocity"):  # an FMU of a scene without wind has none
                inputs["wind_velocity"] = wind
            fmu.start(inputs, **{name: value for name, value in case.items() if name != "wind"})
            values = np.array(instance.getReal(outputs))
            rests.append(Rest(values[:3], values[3:6], values[6:].reshape(-1, 3)))
            instance.reset()
            stop_if_pressed()
    return rests
