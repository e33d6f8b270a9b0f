"""What users give to a tether of the Python API: checked, and refused in words."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.parameters import Environment, Solver, Tether
from tetherfmu.runtime.quantities import quantities


def tethers_of(model, given):
    """A tuple of tethers from one or a sequence of them; TypeError with the remedy for anything else."""
    found = (given,) if isinstance(given, Tether) else tuple(given) if isinstance(given, Sequence) else ()
    if not found or not all(isinstance(each, Tether) for each in found):
        raise TypeError(
            f"tether is {given!r}; it must be a Tether or a sequence of them, as in "
            f"{model}(Tether(initial_length=505.0)), or in short {model}(initial_length=505.0)"
        )
    return found


def record_of(model, given, kind):
    """A record of this kind; TypeError for anything else."""
    if not isinstance(given, kind):
        name = kind.__name__
        raise TypeError(f"{name.lower()} is {given!r}; it must be an {name}, as in {model}(Tether(), {name}())")
    return given


def with_quantities(model, given, tethers, *records):
    """Tethers and records with the quantities (a dict) in the place of theirs; TypeError if one does not exist."""
    owners = {name: kind for kind in (Tether, Environment, Solver) for name, _ in quantities(kind)}
    for name in given:
        if name not in owners:
            raise TypeError(f"{model} has no quantity {name}; there are {', '.join(owners)}")
    parts = {kind: {name: value for name, value in given.items() if owners[name] is kind} for kind in set(owners.values())}
    if parts[Tether] and len(tethers) > 1:
        raise TypeError(f"{', '.join(parts[Tether])}: give it to each of the {len(tethers)} tethers in series")
    return tuple(replace(each, **parts[Tether]) for each in tethers), *(
        replace(each, **parts[type(each)]) for each in records
    )


def checked_masses(point_masses, segments):
    """A dict of point masses, node to mass [kg]; ValueError if a node or a mass does not exist."""
    masses = dict(point_masses or {})
    for node, mass in masses.items():
        if node not in range(segments + 1) or not (mass >= 0.0 and np.isfinite(mass)):
            raise ValueError(
                f"point_masses has {mass!r} kg at node {node!r}; it must be at least 0 kg at a node from 0 to {segments}"
            )
    return masses


def node_vectors(name, given, segments):
    """A vector for each node, array (segments + 1, 3); ValueError for another shape, or numbers that no input may have."""
    found = np.asarray(given, dtype=float)
    if found.shape != (segments + 1, 3):
        raise ValueError(f"{name} has the shape {found.shape}; it must be {(segments + 1, 3)}")
    if not np.all(np.abs(found) <= at.LARGEST_INPUT):  # NaN is not
        raise ValueError(f"{name} has a number that is not finite or above {at.LARGEST_INPUT:g} in magnitude")
    return found


def number(name, value, unit):
    """A number; ValueError for anything else."""
    try:
        return float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{name} is {value!r}; it must be a number [{unit}]") from None


def whole(name, value):
    """A whole number of at least 0; ValueError for anything else."""
    if not isinstance(value, int | np.integer) or value < 0:
        raise ValueError(f"{name} is {value!r}; it must be a whole number of at least 0")
    return int(value)
