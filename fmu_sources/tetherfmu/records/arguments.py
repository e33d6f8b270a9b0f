"""Checks of the arguments of the Python API."""

from array import array
from collections.abc import Iterable, Sequence

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import BY_NAME, PLACES
from tetherfmu.runtime.naming import check_names
from tetherfmu.runtime.parameters import Tether, changed
from tetherfmu.runtime.quantities import can_be_given, doubts_of
from tetherfmu.wiring.fmu import IDLE_BREAKING
from tetherfmu.wiring.variables import RECORDS


def tethers_of(model, given):
    """A tuple of tethers from one or a sequence of them; TypeError with the remedy for anything else."""
    found = (given,) if isinstance(given, Tether) else tuple(given) if isinstance(given, Sequence) else ()
    if not found or not all(isinstance(each, Tether) for each in found):
        raise TypeError(
            f"tether is {given!r}; it must be a Tether or a sequence of them, as in "
            f"{model}(Tether(initial_length=505.0)), or in short {model}(initial_length=505.0)"
        )
    return found


def records_of(name, given, kind):
    """A tuple of records of this kind from a sequence of them; TypeError for anything else."""
    found = tuple(given) if isinstance(given, Iterable) else (given,)
    if not isinstance(given, Iterable) or not all(isinstance(each, kind) for each in found):
        raise TypeError(f"{name} is {given!r}; it must be a sequence of {kind.__name__}")
    return found


def check_release(value, label="release"):
    """ValueError unless a release, a number or an array, is true or false; a step refuses values that are not finite."""
    for each in np.ravel(np.asarray(value, dtype=float)):
        if each not in (0.0, 1.0) and np.isfinite(each):
            raise ValueError(f"{label} is {each:g}; it must be true or false")


def check_wind(environment, wind_points):
    """ValueError if a wind profile is given without effect, because the wind is specified at points."""
    if wind_points and environment.wind_profile != at.UNIFORM:
        profile = environment.wind_profile
        raise ValueError(f"wind_profile is {profile} and has no effect with wind_points; it must be 1 (uniform)")


def with_quantities(model, given, tethers, *records):
    """Tethers and records with replaced quantities (a dict); TypeError if one does not exist."""
    owners = {name: kind for kind in RECORDS for name, _ in can_be_given(kind)}
    check_names(model, given, owners, "argument")
    parts = {kind: {name: value for name, value in given.items() if owners[name] is kind} for kind in set(owners.values())}
    if parts[Tether] and len(tethers) > 1:
        raise TypeError(f"{', '.join(parts[Tether])}: give it to each of the {len(tethers)} tethers in series")
    return tuple(changed(each, parts[Tether]) for each in tethers), *(changed(each, parts[type(each)]) for each in records)


def doubts(*records):
    """Sentences on quantities of records with probably wrong units, without duplicates."""
    return dict.fromkeys(said for record in records for said in doubts_of(record))


def idle_breaking(variant, tethers):
    """Sentences on breaking forces without effect, one or none."""
    forces = [each.breaking_force for each in tethers if each.breaking_force and "breaking_force" in variant.ignored]
    return [IDLE_BREAKING.format(value=force) for force in forces[:1]]


def checked_masses(point_masses, segments):
    """A dict of point masses, node to mass [kg]; ValueError if a node or a mass does not exist."""
    masses = dict(point_masses or {})
    for node, mass in masses.items():
        if node not in range(segments + 1) or not (mass >= 0.0 and np.isfinite(mass)):
            raise ValueError(
                f"point_masses has {mass!r} kg at node {node!r}; it must be at least 0 kg at a node from 0 to {segments}"
            )
    return masses


def numbers_in_shape(name, given, shape):
    """Array of this shape; ValueError for another one, or numbers that no input may have."""
    found = np.asarray(given, dtype=float)
    if found.shape != shape:
        raise ValueError(f"{name} has the shape {found.shape}; it must be {shape}")
    if not np.all(np.abs(found) <= at.LARGEST_INPUT):  # NaN is not
        raise ValueError(f"{name} has a number that is not finite or above {at.LARGEST_INPUT:g} in magnitude")
    return found


def motion_of_nodes(positions, velocities, segments):
    """Positions [m] and velocities [m/s] of all nodes, array (2, segments + 1, 3), at rest if None; None without positions.

    ValueError as of `numbers_in_shape`.
    """
    if positions is None:
        if velocities is not None:
            raise ValueError("velocities of nodes are given without their positions")
        return None
    shape = segments + 1, 3
    velocities = np.zeros(shape) if velocities is None else numbers_in_shape("velocities", velocities, shape)
    return np.stack((numbers_in_shape("positions", positions, shape), velocities))


def length_with(slack, chord, least):
    """Unstretched length [m] of a tether with this slack [-] over its chord [m], (3,); ValueError below `least` [m]."""
    slack = number("slack", slack, "-")
    length = (1.0 + slack) * np.linalg.norm(chord)
    if not least <= length < np.inf:
        raise ValueError(f"slack is {slack!r}: the tether would be {length:g} m long; it must be at least {least:g} m")
    return length


def numbers_at(given):
    """Numbers of given inputs: triples (first place, end place, array); ValueError names a wrong one.

    given : dict of input names to values, or None.
    """
    found = []
    for name, value in given.items():
        if value is not None:
            place, size = PLACES[name], BY_NAME[name].size
            try:
                numbers = array("d", (value,) if size == 1 else value)
            except (TypeError, ValueError):
                numbers = ()
            if len(numbers) != size:
                wanted = "a number" if size == 1 else "three numbers"
                raise ValueError(f"{name} is {value!r}; it must be {wanted}")
            found.append((place, place + size, numbers))
    return found


def number(name, value, unit):
    """A number; ValueError for anything else."""
    try:
        return float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{name} is {value!r}; it must be a number [{unit}]") from None


def tether_length(value, has_waves, by_speed):
    """Unstretched length [m] at the end of a step; ValueError for a tether or a winch without this argument.

    by_speed : whether `winch_control` is speed.
    """
    if has_waves:
        raise ValueError("tether_length is an input of the tethers without waves; the dynamic tether reels: reel_out_speed")
    if not by_speed:
        raise ValueError("tether_length is given beside winch_control = force or length; it needs speed")
    return number("tether_length", value, "m")


def steps(name, value, count):
    """Communication steps [s] of all rows, array (count,); ValueError for another shape."""
    found = np.asarray(value, dtype=float)
    if found.shape != (count,):
        raise ValueError(f"{name} has the shape {found.shape}; it must be a number or {(count,)}")
    return found


def wind_points(value):
    """Number of wind points: 0 or at least 2; ValueError for anything else."""
    if whole("wind_points", value) not in (0, *range(2, at.MAX_WIND_POINTS + 1)):
        raise ValueError(f"wind_points is {value!r}; it must be 0, or from 2 to {at.MAX_WIND_POINTS}")
    return int(value)


def whole(name, value):
    """A whole number of at least 0; ValueError for anything else."""
    if not isinstance(value, int | np.integer) or value < 0:
        raise ValueError(f"{name} is {value!r}; it must be a whole number of at least 0")
    return int(value)
