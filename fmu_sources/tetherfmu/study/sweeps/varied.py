"""Varied values of a sweep: values of a scene on a grid, in a list, or drawn from a distribution.

tether.diameter=3 mm..6 mm:4       four values, evenly spaced
wind.seed=1..20                    whole numbers
tether.drag_coefficient=0.9,1.1    a list
wind.file=boxes/seed_*.bts         all files of this name
wind.speed~weibull(2, 9 m/s)       a distribution
series.winch_force.factor=0.8,1.2  what the rows of a course are multiplied by
"""

import re
from contextlib import suppress
from dataclasses import dataclass
from glob import glob
from itertools import product
from pathlib import Path
from typing import Any
from warnings import catch_warnings

import numpy as np

from tetherfmu.files.courses import CHANGES
from tetherfmu.files.driven import MOVED, OF_A_SCENE
from tetherfmu.files.flights import KINDS
from tetherfmu.files.scene_files import NOT_OF_A_SCENE, RECORDS, Scene
from tetherfmu.files.settings import ELEMENT, OF_THE_WIND, SEED, check_settings, key_meant
from tetherfmu.files.toml_files import in_si, keys_of
from tetherfmu.files.winds import Box
from tetherfmu.runtime.inputs import BY_NAME
from tetherfmu.runtime.naming import check_names, meant_or_all, prefixed
from tetherfmu.runtime.quantities import can_be_given

WRITTEN = re.compile(r"\s*([\w.\[\]]+)\s*([=~])\s*(.+?)\s*")
RANGE = re.compile(r"(.+?)\.\.(.+?)(?::\s*(\d+))?")
DISTRIBUTION = re.compile(r"(\w+)\s*\(([^()]*)\)")
MOST_VALUES = 1_000_000  # of one quantity
UNIT, NONE = True, False  # whether a parameter of a distribution has the unit of the quantity
DISTRIBUTIONS = {  # parameters by name, and whether they have the unit
    "uniform": {"least": UNIT, "largest": UNIT},
    "normal": {"mean": UNIT, "deviation": UNIT},
    "lognormal": {"median": UNIT, "deviation of the logarithm": NONE},
    "weibull": {"shape": NONE, "scale": UNIT},
    "triangular": {"least": UNIT, "mode": UNIT, "largest": UNIT},
}
HOW = "NAME=FROM..TO:COUNT, NAME=A,B,C or NAME~DISTRIBUTION(...)"


@dataclass(frozen=True)
class Varied:
    """A value of a scene that a sweep varies: by a grid or a list of values, or by a distribution."""

    name: str  # as for `settings.with_settings`
    unit: str | None  # None for a value that is not a number
    values: tuple = ()  # in SI units; () with a distribution
    distribution: Any = None  # a frozen one of scipy.stats


def unit_in_series(name, known):
    """Unit of a value of the table [series], as of `unit_of`; ValueError if it has none.

    name : such as series.winch_force, or one of `CHANGES` of a course.  known : unit and size by key, without "series.".
    """
    key, _, last = name.removeprefix("series.").rpartition(".")
    if key in known and last in (*CHANGES, "file"):
        return CHANGES.get(last)
    element = ELEMENT.fullmatch(name.removeprefix("series."))
    key = element[1] if element else name.removeprefix("series.")
    if key not in known:
        raise ValueError(f"the table [series] has no {name}{meant_or_all(key, known, 'it can have {}')}")
    unit, size = known[key]
    if (size > 1) is not bool(element):
        raise ValueError(
            f"series.{key} is {'three numbers' if size > 1 else 'one number'}; vary "
            f"{f'series.{key}[1], ' if size > 1 else f'series.{key}, '}"
            f"{', '.join(f'series.{key}.{each}' for each in (*CHANGES, 'file'))}"
        )
    return unit


def unit_of(name, flight="circle"):
    """Unit of a value of a scene, "" for a dimensionless number, None for other values; ValueError if there is none.

    flight : kind of the flight of the scene.
    """
    if name in (SEED, *OF_THE_WIND):
        return OF_THE_WIND.get(name, "")
    if name.startswith("series."):
        return unit_in_series(
            name, {each: MOVED.get(each) or (BY_NAME[each].unit, BY_NAME[each].size) for each in OF_A_SCENE}
        )
    key = key_meant(name)
    element = ELEMENT.fullmatch(key)
    section, _, last = (element[1] if element else key).rpartition(".")
    kinds = {"": Scene, "flight": KINDS.get(flight), "wind.box": Box, **RECORDS}
    if section not in kinds:
        raise ValueError(f"a scene has no {name}{meant_or_all(section, kinds, 'its sections are {}')}")
    kind = kinds[section]
    known = ["file"] if kind is None else [each for each in keys_of(kind) if each not in NOT_OF_A_SCENE]
    known += ["file"] if section == "wind" else []
    if last not in known:
        raise ValueError(f"a scene has no {name}{meant_or_all(last, known, f'{section} has {{}}')}")
    return unit_of_field(kind, last, bool(element)) if kind else None


def unit_of_field(kind, key, is_element):
    """Unit of a field of a record, or of an element of it; None for another value than a number."""
    declared = dict(can_be_given(kind)).get(key)
    if declared:
        return None if declared.choices else declared.unit
    facts = kind.__dataclass_fields__[key].metadata if key in kind.__dataclass_fields__ else {}
    return facts.get("unit") if is_element else None


def number_of(text, unit):
    """A number in SI units, a whole one where it is written so; ValueError for another unit."""
    for kind in (int, float):
        with suppress(ValueError):
            return kind(text)
    with prefixed(f"{text.strip()!r} is not possible; "):
        return float(in_si(text.strip(), unit))


def grid(first, last, count, unit):
    """Evenly spaced values between two texts, a tuple; without a count whole numbers."""
    ends = [number_of(each, unit) for each in (first, last)]
    if count is None:
        if not all(isinstance(each, int) for each in ends) or ends[0] > ends[1]:
            raise ValueError("a range without :COUNT is one of whole numbers, from the least to the largest")
        count = ends[1] - ends[0] + 1
    if not 1 <= int(count) <= MOST_VALUES:
        raise ValueError(f"it has {count} values; there must be from 1 to {MOST_VALUES}")
    if all(isinstance(each, int) for each in ends) and int(count) == ends[1] - ends[0] + 1:
        return tuple(range(ends[0], ends[1] + 1))
    return tuple(np.linspace(*ends, int(count)).tolist())


def distribution(name, texts, unit):
    """Frozen distribution of scipy.stats from its name and parameters, a list of texts; ValueError for a wrong one."""
    from scipy import stats  # slow to import

    if name not in DISTRIBUTIONS:
        raise ValueError(f"there is no distribution {name}{meant_or_all(name, DISTRIBUTIONS)}")
    wanted = DISTRIBUTIONS[name]
    if len(texts) != len(wanted):
        raise ValueError(f"{name} has {len(wanted)} parameters: {', '.join(wanted)}")
    given = [number_of(text, unit if has_unit else "") for text, has_unit in zip(texts, wanted.values(), strict=True)]
    positive = {"normal": given[1:], "lognormal": given, "weibull": given}.get(name, ())
    if any(each <= 0.0 for each in positive) or (not positive and (given != sorted(given) or given[0] == given[-1])):
        rule = "above 0" if positive else "in ascending order"
        raise ValueError(f"its parameters {', '.join(list(wanted)[-len(positive or given) :])} must be {rule}")
    made = {
        "uniform": lambda least, largest: stats.uniform(least, largest - least),
        "normal": stats.norm,
        "lognormal": lambda median, deviation: stats.lognorm(deviation, scale=median),
        "weibull": lambda shape, scale: stats.weibull_min(shape, scale=scale),
        "triangular": lambda least, mode, largest: stats.triang((mode - least) / (largest - least), least, largest - least),
    }
    return made[name](*given)


def listed(text, unit, folder):
    """Values of a list, a tuple; names of files with * are expanded to files in a folder."""
    parts = [each.strip() for each in text.split(",")]
    if unit is not None:
        return tuple(number_of(each, unit) for each in parts)
    found = []
    for part in parts:
        files = sorted(glob(part, root_dir=folder, recursive=True)) if "*" in part else [part]
        if not files:
            raise ValueError(f"no file is called {part}")
        found += files
    return tuple(found)


def varied(text, unit_in=unit_of, folder=Path()):
    """`Varied` of a text such as ``wind.speed~weibull(2, 9 m/s)``; ValueError describes a problem in one line.

    unit_in : function of the name that returns its unit, as `unit_of`.  folder : of the scene, where files are.

    >>> varied("tether.diameter=3 mm..6 mm:4").values
    (0.003, 0.004, 0.005, 0.006)
    """
    found = WRITTEN.fullmatch(text)
    if not found:
        raise ValueError(f"{text!r} is not possible; it must be {HOW}")
    name, how, rest = found.groups()
    unit = unit_in(name)
    with prefixed(f"{text!r}: "):
        if how == "~":
            written = DISTRIBUTION.fullmatch(rest)
            if not written or unit is None:
                must = "it must be NAME~DISTRIBUTION(...)" if not written else "it is not a number: give a list, NAME=A,B,C"
                raise ValueError(f"{must}, with one of {', '.join(DISTRIBUTIONS)}" if not written else must)
            parameters = [each.strip() for each in written[2].split(",")]
            return Varied(name, unit, distribution=distribution(written[1], parameters, unit))
        between = RANGE.fullmatch(rest)
        if between and unit is not None:
            return Varied(name, unit, grid(*between.groups(), unit))
        return Varied(name, unit, listed(rest, unit, folder))


def all_varied(given, unit_in, folder, settings=(), check=check_settings):
    """List of `Varied` from the arguments of `sweep`; ValueError describes a problem in one line.

    given : texts, or a dict of values (a sequence), or a distribution of scipy.stats, by name.
    unit_in, folder : as for `varied`.  settings : pairs (name, value), equal in all flights, and not varied.
    check : refuses names that set the same value, as `check_settings`.
    """
    if isinstance(given, dict):
        found = []
        for name, values in given.items():
            unit = unit_in(name)
            if hasattr(values, "ppf"):
                found.append(Varied(name, unit, distribution=values))
                continue
            in_units = (in_si(each, unit) if unit is not None else each for each in values)
            found.append(
                Varied(name, unit, tuple(each.item() if isinstance(each, np.generic) else each for each in in_units))
            )
    else:
        found = [varied(text, unit_in, folder) for text in ([given] if isinstance(given, str) else given)]
    check([*(name for name, _ in settings), *(each.name for each in found)])
    if not found:
        raise ValueError(f"nothing is varied; give at least one {HOW}")
    return found


METHODS = ("latin_hypercube", "sobol")


def draws(drawn, samples, method, seed):
    """Values of quantities that have a distribution, list of tuples, one for each of the samples; [()] without any."""
    if not drawn:
        return [()]
    from scipy.stats import qmc

    check_names("sweep", [method], METHODS, "method")
    engine = {"latin_hypercube": qmc.LatinHypercube, "sobol": qmc.Sobol}[method]
    with catch_warnings(action="ignore", category=UserWarning):  # Sobol with another number than a power of 2
        places = engine(len(drawn), seed=np.random.default_rng(seed)).random(samples)
    places = np.clip(places, 0.5**53, 1.0 - 0.5**53)  # a scrambled point of Sobol may be 0
    columns = (each.distribution.ppf(column).tolist() for each, column in zip(drawn, places.T, strict=True))
    return list(zip(*columns, strict=True))


def points(quantities, samples, method, seed):
    """Values of each flight, a list of tuples of pairs (name, value): all points of the grid, each with all samples."""
    drawn = [each for each in quantities if each.distribution is not None]
    grids = [each for each in quantities if each.distribution is None]
    names = [each.name for each in (*grids, *drawn)]
    pairs = product(product(*(each.values for each in grids)), draws(drawn, samples, method, seed))
    found = (dict(zip(names, (*on_grid, *sample), strict=True)) for on_grid, sample in pairs)
    return [tuple((each.name, values[each.name]) for each in quantities) for values in found]
