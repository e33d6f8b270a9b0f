"""Lines that run over sheaves: what their records say, and what their portions give."""

from itertools import pairwise

import numpy as np

from tetherfmu.energy import Energy
from tetherfmu.fmi.portions import portions_of
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.outputs import PLACES
from tetherfmu.runtime.quantities import Quantity
from tetherfmu.runtime.sheaves import SHEAVE_QUANTITIES

from .results import PortionOutputs, SheaveEnergy

LENGTH = Quantity("m", "a portion", minimum=0.0)


def numbers_in(line, name):
    """One number of each sheave of a line, a tuple; ValueError for another count, or if one is not allowed."""
    given, declared = getattr(line, name), SHEAVE_QUANTITIES[name]
    many = np.ndim(given) > 0
    found = tuple(given) if many else (given,) * len(line.through)
    if len(found) != len(line.through):
        raise ValueError(
            f"{line.name}.{name} has {len(found)} numbers; it must be one, or one for each of {len(line.through)}"
        )
    for each in found:
        if not declared.allows(each):
            raise ValueError(f"{line.name}.{name} is {each!r}; it must be {declared.range()}")
    return tuple(map(float, found))


def check_sheaves(line):
    """ValueError if what a line says of sheaves cannot be; what has no effect is refused."""
    if isinstance(line.through, str):
        raise ValueError(f'{line.name}.through is {line.through!r}; it must be a list of names of points, as ["block"]')
    object.__setattr__(line, "through", tuple(line.through))
    if not line.through:
        defaults = {"initial_portions": None, "sheave_mass": 0.0, "sheave_friction": 0.0, "sheave_efficiency": 1.0}
        for name, default in defaults.items():
            if getattr(line, name) is not default and getattr(line, name) != default:
                raise ValueError(
                    f"{line.name}.{name} is {getattr(line, name)!r} and has no effect: {line.name} runs through no point"
                )
        return
    if len(line.tethers) > 1:
        raise ValueError(f"the line {line.name} is of {len(line.tethers)} tethers in series; over sheaves it must be of one")
    stops = (line.start, *line.through, line.end)
    twice = next((a for a, b in pairwise(stops) if a == b), None)
    if twice is not None:
        raise ValueError(f"the line {line.name} goes from the point {twice} to itself; there must be another point between")
    numbers = {name: numbers_in(line, name) for name in SHEAVE_QUANTITIES}
    if any(a > 0.0 and b != 1.0 for a, b in zip(numbers["sheave_friction"], numbers["sheave_efficiency"], strict=True)):
        raise ValueError(f"{line.name}.sheave_friction and {line.name}.sheave_efficiency are both given; give one of them")
    if line.initial_portions is not None:
        check_portions(line)


def check_portions(line):
    """ValueError unless the portions that are given are those of the line."""
    given, whole, count = tuple(line.initial_portions), line.tethers[0].initial_length, len(line.through) + 1
    if len(given) != count or not all(LENGTH.allows(each) and each > 0.0 for each in given):
        raise ValueError(f"{line.name}.initial_portions is {list(given)!r}; it must be {count} lengths above 0")
    least = at.MIN_SEGMENT_LENGTH * line.tethers[0].segments
    if min(given) < least:
        raise ValueError(
            f"{line.name}.initial_portions is {list(given)!r}; each must be at least {least:g} m, "
            f"{at.MIN_SEGMENT_LENGTH:g} m for each of its {line.tethers[0].segments} segments"
        )
    if abs(sum(given) - whole) > 1e-9 * whole:
        raise ValueError(
            f"{line.name}.initial_portions add up to {sum(given):.9g} m; it must be initial_length, {whole!r} m"
        )


def sheave_numbers(portion):
    """What `packing.put_sheaves` takes of a `Portion`."""
    if not portion.is_portion:
        return None
    line, k = portion.line, portion.number
    given = line.initial_portions[k] if line.initial_portions is not None else 0.0
    own = [numbers_in(line, name)[k] for name in SHEAVE_QUANTITIES] if portion.is_through else [0.0, 0.0, 1.0]
    return [at.BEHIND_SHEAVE if k else 1.0, given, *own]


def sheaves_of(line):
    """Start values of the sheaves of a line, and of its portions, as a `fmi.system_variables.Line` has them."""
    given = line.initial_portions or (0.0,) * (len(line.through) + 1)
    return {"initial_portions": tuple(given), **{name: numbers_in(line, name) for name in SHEAVE_QUANTITIES}}


def check_with_sheaves(lines, winches):
    """ValueError if a system whose lines run over sheaves, or are held by winches by force, has what it cannot have yet."""
    name = next((line.name for line in lines if line.through), None)
    why = f"{name} runs over sheaves"
    if name is None:
        name = next((each.name for each in winches if each.control == "force"), None)
        why = f"the winch {name} holds lines by force"
    if name is None:
        return
    for line in lines:
        check_drum(line, why)
        if line.through and line.tethers[0].damping_law != at.STRAIN_RATE:
            raise ValueError(f"{line.name}.damping_law is stretch_rate; over sheaves it must be strain_rate")
        if line.through and line.tethers[0].breaking_force != 0.0:
            force = line.tethers[0].breaking_force
            raise ValueError(f"{line.name}.breaking_force is {force!r}, and {line.name} runs over sheaves; it must be 0")


def check_turned(line, why):
    """ValueError if a tether of a line is none that a drum turns beside sheaves, or with others; why : it is one."""
    for tether in line.tethers:
        if tether.damping_law != at.STRAIN_RATE:
            raise ValueError(f"{line.name}.damping_law is stretch_rate, and {why}; it must be strain_rate")


def check_drum(line, why):
    """ValueError if the drum of a line has what it cannot have yet in a system with sheaves; why : it has these."""
    if line.winch.winch_control != at.WINCH_BY_FORCE:
        return
    for name in ("shortest_length", "longest_length"):
        stop = getattr(line.winch, name)
        if line.through and stop:
            raise ValueError(f"{line.name}.{name} is {stop!r}, and {line.name} runs over sheaves; it must be 0")
    check_turned(line, f"its winch is controlled by force, and {why}")


# --- results


def along(arrays):
    """Node vectors (..., nodes, 3) of portions as those of the whole line, nodes at sheaves once."""
    first, *others = arrays
    return np.concatenate([first, *(each[..., 1:, :] for each in others)], axis=-2)


def own_outputs(portion, values):
    """Outputs of a portion (..., outputs) and those that only portions have (..., 5)."""
    found = values[portion.name]
    return found[..., : -at.PORTION_OUTPUTS], found[..., -at.PORTION_OUTPUTS :]


def whole_outputs(line, values):
    """Outputs of a line (..., outputs) from those of its portions by name: the end and the shape are those of all of it."""
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
    """`Energy` of a line from those of its portions, and `SheaveEnergy`, None of a line that runs over none.

    What a portion gives to its sheaves is no power of the winch, which has that of new material, too.  states : of the
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
