"""The evidence set of a lean FMU, or of one with other start values: the flight of the full one with the variables it has.

It is omitted if the scene would be another one, or if a run would exceed the tolerance of the full FMU.
"""

from tetherfmu.runtime.inputs import KITE_AT_START, WIND_AT, components
from tetherfmu.runtime.parameters import Tether
from tetherfmu.runtime.quantities import quantities
from tetherfmu.wiring.variables import INPUT, PARAMETER, names_of, variables

from . import evidence

STARTS_OF_KITE = components("initial_kite_position", 3) + components("initial_kite_velocity", 3)


def of_tether(model, table, left_out=(), wind_points=0):
    """Evidence sets of a tether, list of `EvidenceSet`: those of the full FMU, or one or none.

    model : class of the Python API.  table : of the variables of the full FMU with its start values.  left_out : names of
    omitted variables.  wind_points : of the FMU.
    """
    starts = {each.name: each.start for each in table if each.causality in (INPUT, PARAMETER)}
    tether = Tether(**{name: starts.pop(name) for name, _ in quantities(Tether)})
    full = variables(model.variant, 0, wind_points=wind_points)
    usual = {each.name: each.start for each in full}
    changed = {name: value for name, value in starts.items() if value != usual[name]}
    if not changed and not left_out:
        return evidence.of_tether(model, tether, wind_points)
    own, fixed = starts.keys() - names_of(full, INPUT), frozenset(left_out)
    if changed.keys() & {*STARTS_OF_KITE, "winch_control"}:
        return []  # the scene is another one
    kite = tuple(starts.get(name, start) for name, start in zip(components("kite_position", 3), KITE_AT_START, strict=True))
    others = {name: value for name, value in changed.items() if name in own}
    try:
        made = evidence.flight(model, tether, wind_points, kite, **others)
        held = {name: value for name, value in starts.items() if name in fixed and name not in own}
        moved = {name.partition("[")[0] for name in changed} | made.scene[0].keys()
        held = {name: value for name, value in _vectors(held).items() if name in moved}
        shown = {key: tuple(each for each in getattr(made, key) if each not in fixed) for key in ("inputs", "outputs")}
        made = made._replace(scene=[{**row, **held} for row in made.scene], **shown)
        return [made] if made.outputs and is_kept(made) else []
    except ValueError:
        return []


def _vectors(values):
    """Dict of numbers and vectors by name, from one of the numbers of all elements."""
    found = {}
    for name, value in values.items():
        vector, is_element, _ = name.partition("[")
        found[vector] = (*found.get(vector, ()), value) if is_element else value
    return found


def is_kept(made):
    """Whether a run with the tolerance of an `EvidenceSet` stays within the permitted deviation; ValueError if it fails."""
    exact, run = evidence.reference(made), evidence.reference(made, made.tolerance)
    vectors = [name.partition("[")[0] for name in made.outputs]
    largest = {}
    for row in exact:
        for name, value in zip(vectors, row, strict=True):
            largest[name] = max(largest.get(name, 0.0), abs(value))
    pairs = (zip(vectors, row, other, strict=True) for row, other in zip(exact, run, strict=True))
    return all(abs(a - b) <= made.allowed * largest[name] for row in pairs for name, a, b in row)


def of_system(made, table, left_out):
    """The `EvidenceSet` of a system that omits some variables; ValueError if it requires `wind_at`.

    made : of the full one.  table : of all its variables.  left_out : names.
    """
    held = _vectors({each.name: each.start for each in table if each.causality == INPUT and each.name in left_out})
    if any(name.endswith(f".{WIND_AT.name}") for name in held):
        raise ValueError("the wind at points is constant")

    def row_of(given):
        own = {
            key: {name: held.get(f"{name}.{what}", value) for name, value in given[key].items()}
            for key, what in evidence.KINDS.items()
            if key in given
        }
        return {**given, **own, "wind_velocity": held.get("wind_velocity", given["wind_velocity"])}

    shown = {key: tuple(each for each in getattr(made, key) if each not in left_out) for key in ("inputs", "outputs")}
    return made._replace(scene=[row_of(each) for each in made.scene], **shown)
