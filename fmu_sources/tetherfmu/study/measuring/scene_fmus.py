"""FMUs of scenes: all variants in a folder, and their inputs along a scene."""

from pathlib import Path
from zipfile import is_zipfile

import pandas as pd

from tetherfmu.export.archive import build
from tetherfmu.export.build_options import BuildOptions
from tetherfmu.files.toml_files import WrongUse
from tetherfmu.runtime.variants import DYNAMIC_FREE, VARIANTS, class_name
from tetherfmu.wiring.variables import INPUT, variables, wind_at_names


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
            raise WrongUse(f"{path} is not an FMU: it is not a zip archive")
    return paths


def inputs_of(scene, step):
    """Inputs of all communication steps [s] of a scene, a DataFrame with a column for each of its FMU that is a number.

    With the wind at its wind points if it has them.
    """
    table = variables(DYNAMIC_FREE.name if scene.kite_is_free else VARIANTS[0], 0)
    places = {each.name: each.place for each in table if each.causality == INPUT and each.kind == "Real"}
    found, wind = pd.DataFrame(scene.inputs(step)[:, [*places.values()]], columns=[*places]), scene.wind_at(step)
    if wind is None:
        return found
    names = list(wind_at_names(scene.wind_points))
    return pd.concat([found, pd.DataFrame(wind.reshape(len(wind), -1), columns=names)], axis=1)
