"""Energy of a chain and the powers that change it: a diagnostic, not part of a step.

    d/dt (kinetic + elastic + potential) = power at the ends + winch + material + wind - losses (damping, drag, ground)

docs/models/theory.md, "Energy" defines every term, and `kernels/step/power_balance.py` computes it. The
residual of this equation is a numerical error, which `EnergyAudit` integrates along a run.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from inspect import cleandoc
from typing import Any

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import by_name
from tetherfmu.runtime.instance import address
from tetherfmu.runtime.naming import check_names

# inputs on which powers depend, in addition to the motion of the ends
WITH_POWER = ("reel_out_speed", "wind_velocity", "kite_load", "winch_force")


def _of(unit):
    """Function that declares a field of `Energy` with this unit by its meaning."""
    return lambda meaning: field(metadata={"about": f"{meaning} [{unit}]"})


_energy, _power = _of("J"), _of("W")


@dataclass(frozen=True)
class Energy:
    """Energies [J] of a tether and the powers [W] that change them, in the order of `kernels.step.power_balance`.

    Drum energies and powers (`drum`, `drum_power`, `motor_power`, `friction_loss`) are not part of `total` and `power`; they
    are 0 without force control.

    Examples
    --------
    >>> from tetherfmu import TetherDynamic
    >>> tether = TetherDynamic()
    >>> start = tether.initialize()
    >>> 1.0 < tether.energy().elastic < 2.0
    True
    """

    kinetic: float = _energy("of the nodes that move freely; the half particle at a driven end belongs to its driver")
    elastic: float = _energy("of the springs")
    potential: float = _energy(
        "weight times height over z = 0, with both half particles; and the energy stored in the ground under free nodes"
    )
    ground_power: float = _power("power from the holder of the end into the tether, - end force . end velocity")
    kite_power: float = _power("the same at the kite; at a free kite end: load . velocity")
    winch_power: float = _power("work against the tension where the tether gets shorter or longer, - sum T (l/l0) dl0/dt")
    material_power: float = _power(
        "kinetic, elastic and potential energy that new material brings; negative while reeling in"
    )
    wind_power: float = _power("drag force . wind velocity")
    damping_loss: float = _power("heat in the dampers; at least 0 with the strain-rate law")
    drag_loss: float = _power("heat in the air, drag force . (wind - tether velocity); at least 0")
    drum: float = _energy("kinetic energy of a drum that is controlled by force")
    drum_power: float = _power("power from the rope tension (`ground_tension`) into the drum, tension . speed")
    motor_power: float = _power("power from the motor into the drum, - winch_force . speed")
    friction_loss: float = _power("heat of the friction of the drum; at least 0")
    contact_loss: float = _power(
        "heat in the ground where nodes sink into it or leave it; its elastic energy is part of `potential`"
    )
    sliding_loss: float = _power("heat of the friction on the ground; at least 0")
    broken: float = _energy(
        "lost with the spring of the segment that broke, and where rope runs off a sheave, less that of the half particle "
        "which a driven end leaves to the tether when it lets go; 0 before"
    )

    @property
    def total(self) -> float:
        """Kinetic + elastic + potential energy [J]."""
        return self.kinetic + self.elastic + self.potential

    @property
    def power(self) -> float:
        """Sum of the powers minus the losses [W]: the rate at which `total` has to change."""
        gains = self.ground_power + self.kite_power + self.winch_power + self.material_power + self.wind_power
        return gains - self.damping_loss - self.drag_loss - self.contact_loss - self.sliding_loss


_DECLARED = [f"{each.name} : float\n    {each.metadata['about']}" for each in fields(Energy)]
Energy.__doc__ = "\n".join([cleandoc(Energy.__doc__), "", "Attributes", "----------", *_DECLARED])
POWERS = tuple(field.name for field in fields(Energy) if field.name.endswith(("_power", "_loss")))


def account(instance, line=0, **given):
    """For a line of a started `Instance`, with nodes: `Energy`, segment tensions [N], node velocities [m/s].

    given : other values of inputs in `WITH_POWER` than in the last step, by name; None is omitted.
    """
    check_names("the energy", given, WITH_POWER)
    inputs, state = np.array(instance.values[: instance.outputs_at]), instance.state_of(line)
    first = instance.inputs_at(line)
    columns = by_name(inputs[first : first + at.INPUTS])
    known = {"reel_out_speed": state[at.REELING], "wind_velocity": state[at.WIND : at.WIND + 3]}
    for name, value in {**known, **{name: value for name, value in given.items() if value is not None}}.items():
        columns[name][:] = value
    segments = instance.counts[line]
    more = int(state[at.LET_GO])  # the additional segment without load
    places = np.cumsum((len(fields(Energy)), segments, more))
    found = np.zeros(places[1] + 1 + 3 * (segments + 2))
    plan, parameters, state_at, work = map(address, (instance.plan, instance.parameters, instance.state, instance.work))
    instance.kernels.energy(plan, parameters, inputs.ctypes.data, line, state_at, found.ctypes.data, work)
    energies, tensions, _, velocities = np.split(found, places)
    return Energy(*energies.tolist()), tensions, velocities[: 3 * (segments + 1)].reshape(-1, 3)


class EnergyAudit:
    """Step a tether and integrate its powers, to find energy errors.

    The trapezoidal rule over the communication steps: its error falls with the square of the step, so take steps that are
    short against the shortest vibration of interest. The run itself is the same as without the audit.

    Parameters
    ----------
    model : TetherModel
        Initialized, with nodes; or an object with the same `step` and `energy`. Do not step it elsewhere during the
        audit.

    Attributes
    ----------
    work : dict
        Integral of each power and loss since the start [J], by its name in `Energy`.
    start, now : Energy
        At the start of the audit, and at present.

    Examples
    --------
    >>> from tetherfmu import TetherDynamic
    >>> tether = TetherDynamic()
    >>> start = tether.initialize()
    >>> audit = EnergyAudit(tether)
    >>> outputs = audit.step(0.02, wind_velocity=(1.0, 0.0, 0.0))
    >>> abs(audit.residual) < 1e-4
    True
    """

    def __init__(self, model: Any):
        self._model = model
        self.start = self.now = model.energy()
        self.work = dict.fromkeys(POWERS, 0.0)

    def step(self, step: float, **inputs) -> Any:
        """Advance the model by `step` [s]; inputs and result are the same as for its `step`."""
        before = self._model.energy(**{name: value for name, value in inputs.items() if name in WITH_POWER})
        outputs = self._model.step(step, **inputs)
        self.now = self._model.energy()
        for name in POWERS:
            self.work[name] += 0.5 * step * (getattr(before, name) + getattr(self.now, name))
        return outputs

    @property
    def residual(self) -> float:
        """Energy error [J]: change of the total energy since the start minus the work of all powers.

        It accounts for the energy lost with a broken segment.
        """
        work = Energy(**{field.name: self.work.get(field.name, 0.0) for field in fields(Energy)})
        return self.now.total + self.now.broken - self.start.total - self.start.broken - work.power

    @property
    def drum_residual(self) -> float:
        """Residual of the drum of a force-controlled winch [J]."""
        gains = self.work["drum_power"] + self.work["motor_power"] - self.work["friction_loss"]
        return self.now.drum - self.start.drum - gains
