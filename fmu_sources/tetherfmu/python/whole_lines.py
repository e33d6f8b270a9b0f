"""Outputs and energies of whole lines, from the portions over sheaves."""

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.outputs import PLACES
from tetherfmu.wiring.lines import numbers_in
from tetherfmu.wiring.portions import portions_of

from .energy import Energy
from .system_results import PortionOutputs, SheaveEnergy


def along(arrays):
    """Node vectors (..., nodes, 3) of portions joined to the whole line, without duplicate nodes at sheaves."""
    first, *others = arrays
    return np.concatenate([first, *(each[..., 1:, :] for each in others)], axis=-2)


def own_outputs(portion, values):
    """Outputs of a portion (..., outputs) and those that only portions have (..., 5)."""
    found = values[portion.name]
    return found[..., : -at.PORTION_OUTPUTS], found[..., -at.PORTION_OUTPUTS :]


def whole_outputs(line, values):
    """Outputs of a line (..., outputs) from its portions by name: end and shape are those of the whole line."""
    portions = portions_of(line)
    if not line.through:
        return values[line.name]
    parts = [own_outputs(portion, values)[0] for portion in portions]
    whole = parts[0][..., : at.SHAPE].copy()
    for name, size in (
        ("kite_force", 3),
        ("kite_tension", 1),
        ("kite_end_mass", 1),
        ("kite_position", 3),
        ("kite_velocity", 3),
    ):
        place = PLACES[name]
        whole[..., place : place + size] = parts[-1][..., place : place + size]
    shapes = [each[..., at.SHAPE :] for each in parts]
    return np.concatenate([whole, shapes[0], *(each[..., 3:] for each in shapes[1:])], axis=-1)


def portions_in(line, values):
    """`PortionOutputs` of a line over sheaves from the outputs of its portions by name."""
    own = np.stack([own_outputs(portion, values)[1] for portion in portions_of(line)], axis=-1)
    length, tension_from, tension_to, payout, speed = np.moveaxis(own, -2, 0)
    return PortionOutputs(length, tension_from, tension_to, payout[..., :-1], speed[..., :-1])


def energy_of(line, energies, states):
    """`Energy` of a line from its portions, and `SheaveEnergy`, None without sheaves.

    Power from a portion to its sheaves is not winch power, which also includes that of new material.  states : of the
    portions.
    """
    if not line.through:
        return energies[0], None
    found = {name: sum(getattr(each, name) for each in energies) for name in vars(energies[0])}
    kinetic, losses = [], []
    for k, portion in enumerate(portions_of(line)[:-1]):
        speed, mass = states[k][at.SHEAVE_SPEED], numbers_in(line, "sheave_mass")[portion.number]
        given = speed * (with_strain(line, states[k + 1][at.TENSION_FROM]) - with_strain(line, states[k][at.TENSION_TO]))
        found["winch_power"] += given
        kinetic.append(0.5 * mass * speed**2)
        losses.append(given - mass * speed * states[k][at.SHEAVE_ACCELERATION])
    found["winch_power"] += found["material_power"]
    found["material_power"] = 0.0
    return Energy(**found), SheaveEnergy(np.array(kinetic), np.array(losses))


def with_strain(line, tension):
    """T + T^2/(2 EA) [N] of a tension [N], T alone below 0."""
    return tension + 0.5 * max(tension, 0.0) ** 2 / line.tethers[0].axial_stiffness
