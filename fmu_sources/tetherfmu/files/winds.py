"""Winds of a scene: a mean with gusts, or a box of turbulence from a file that the mean wind carries past the tether.

A box provides the wind at points between the ends: on the straight line from the ground end to the kite end, at equal
distances, at the time of each communication step. All tethers compared in a scene thus have the same wind, whatever
their shape; for a slack tether the wind is off by its variation over the sag.
"""

from dataclasses import dataclass, field, fields
from functools import lru_cache, partial
from math import atan2, hypot

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.naming import prefixed
from tetherfmu.runtime.quantities import check, quantity
from tetherfmu.wind.frozen_turbulence import MeanWind, Reading, turbulence

from .toml_files import WrongUse, record, require, vector

PROFILES = {at.UNIFORM: "uniform", at.POWER_LAW: "power_law"}  # mean wind profiles of a box


@dataclass(frozen=True)
class Wind:
    """Wind at the reference height of the environment: a mean and a gust that comes again, v (1 + g sin^2(pi t/P))."""

    velocity: tuple = field(
        default=(0.0, 0.0, 0.0), metadata={"read": partial(vector, unit="m/s", limit=200.0), "unit": "m/s"}
    )
    gust: float = quantity(0.0, "", "gust strength relative to the mean wind, g", minimum=0.0, maximum=10.0)
    gust_period: float = quantity(10.0, "s", "gust period, P", minimum=1e-3, maximum=1e6)
    __post_init__ = check

    def __call__(self, time):
        """Wind [m/s] at times [s], array (times, 3)."""
        factor = 1.0 + self.gust * np.sin(np.pi / self.gust_period * time) ** 2
        return np.multiply.outer(factor, self.velocity)


@dataclass(frozen=True)
class Box(Reading):
    """How the box of a scene is read, where it is, and at how many points the tether has its wind."""

    wind_points: int = quantity(11, "", "wind points from the ground end to the kite end", 2, at.MAX_WIND_POINTS)
    origin: tuple = field(default=(0.0, 0.0, 0.0), metadata={"read": partial(vector, unit="m", limit=1e6), "unit": "m"})
    __post_init__ = check


@dataclass(frozen=True)
class BoxedWind:
    """Wind from a box of turbulence in a file."""

    file: str
    box: Box
    mean: MeanWind
    state_of_file: tuple = ()  # size [B] and date [ns]: a file that was written anew is another wind

    def __call__(self, time):
        """Zero wind at the reference height, array (times, 3): `at` provides the wind."""
        return np.zeros((*np.shape(time), 3))

    def doubts(self):
        """Sentences on doubts about the box."""
        return opened(self).doubts()

    def at(self, time, ground, kite):
        """Wind [m/s] between the ends, array (times, wind_points, 3); time [s] (times,), ends [m] (times, 3).

        WrongUse if the box does not reach so far, or has a number that is no wind.
        """
        with prefixed("", WrongUse):
            return opened(self).between(time, ground, kite, self.box.wind_points)


@lru_cache(maxsize=4)
def opened(wind):
    """`FrozenTurbulence` of a `BoxedWind`, which itself remains small, because it is sent to other processes."""
    return turbulence(wind.file, wind.box, wind.mean, wind.box.origin)


def read_wind(table, folder, environment):
    """`Wind` or `BoxedWind` of the table [wind] of a scene in a folder (Path); ValueError names the key."""
    known = [each.name for each in fields(Wind)]
    require(table, "wind", (*known, "file", "box"))
    mean = record(Wind, {key: value for key, value in table.items() if key in known}, "wind")
    if "file" not in table:
        if "box" in table:
            raise ValueError("wind.box is given without wind.file; it says how that file is read")
        return mean
    if not isinstance(table["file"], str) or not table["file"]:
        raise ValueError(f"wind.file is {table['file']!r}; it must be the name of a box: .bts, u.bin, u.turb or .npz")
    for key in ("gust", "gust_period"):
        if key in table:
            raise ValueError(f"wind.{key} is given with wind.file, whose gusts are those of the box; remove one of them")
    if mean.velocity[2] != 0.0:
        raise ValueError(f"wind.velocity is {list(mean.velocity)}; with wind.file it must be horizontal")
    if environment.wind_profile not in PROFILES:
        allowed = " or ".join(f"{number} ({name})" for number, name in PROFILES.items())
        raise ValueError(f"environment.wind_profile is {environment.wind_profile}; with wind.file it must be {allowed}")
    x, y, _ = mean.velocity
    exponent = environment.wind_exponent if environment.wind_profile == at.POWER_LAW else 0.0
    box = record(Box, table.get("box", {}), "wind.box")
    file = folder / table["file"]
    blowing = MeanWind(hypot(x, y), atan2(y, x), environment.wind_reference_height, exponent)
    with prefixed("wind.file: "):
        turbulence(file, box, blowing, box.origin)
    status = file.stat()
    return BoxedWind(str(file), box, blowing, (status.st_size, status.st_mtime_ns))
