"""Results of a system: motion of its points and outputs of its lines, at an instant or along a flight."""

from typing import NamedTuple

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.outputs import Outputs

from .energy import Energy


class PointOutputs(NamedTuple):
    """A point at an instant.

    Attributes
    ----------
    position, velocity : (3,) array
        [m], [m/s].
    force : (3,) array
        Force of all its lines on the point [N], with the weight of their halves of segments there.
    """

    position: np.ndarray
    velocity: np.ndarray
    force: np.ndarray


class PortionOutputs(NamedTuple):
    """The portions and the sheaves of a line, at an instant; along a flight with a row for each kept step.

    In the order of the outputs of the FMU.

    Attributes
    ----------
    length : (portions,) array
        Unstretched lengths [m].
    tension_from, tension_to : (portions,) array
        Tensions at the start and at the end of each portion [N].
    payout : (sheaves,) array
        Rope that has run over each sheave from the portion before it since the start [m].
    speed : (sheaves,) array
        The rate of it [m/s].
    """

    length: np.ndarray
    tension_from: np.ndarray
    tension_to: np.ndarray
    payout: np.ndarray
    speed: np.ndarray


class WinchOutputs(NamedTuple):
    """A winch that holds several lines, at an instant.

    Attributes
    ----------
    winch_speed : float
        Reel-out speed of a line with the ratio 1 [m/s].
    payout : float
        Length of such a line that it has paid out since the start [m].
    """

    winch_speed: float
    payout: float


class SystemOutputs(NamedTuple):
    """A system at an instant.

    Attributes
    ----------
    points : dict of str to PointOutputs
        By the names of the points.
    lines : dict of str to Outputs
        By the names of the lines; the start of a line is the ground end of its `Outputs`, its end the kite end.
    solver_iteration_limit : int
        The most iterations of all lines together that the last communication step could take with its fixed steps (before
        the first: one fixed step); 0 with adaptive steps.
    winches : dict of str to WinchOutputs
        By the names of the winches that hold several lines.
    portions : dict of str to PortionOutputs
        Of the lines that run over sheaves, by their names.
    """

    points: dict[str, PointOutputs]
    lines: dict[str, Outputs]
    solver_iteration_limit: int
    winches: dict[str, WinchOutputs]
    portions: dict[str, PortionOutputs]


class SheaveEnergy(NamedTuple):
    """Energies and losses of the sheaves of a line at an instant.

    Attributes
    ----------
    kinetic : (sheaves,) array
        Kinetic energy [J].
    friction_loss : (sheaves,) array
        Heat of the friction [W].
    """

    kinetic: np.ndarray
    friction_loss: np.ndarray


class WinchEnergy(NamedTuple):
    """Energy and powers of the drum of a winch that holds several lines by force, at an instant.

    Attributes
    ----------
    kinetic : float
        Kinetic energy [J].
    rope_power : float
        Power from the tensions of its lines [W].
    motor_power : float
        Power from the motor, - winch_force . winch_speed [W].
    friction_loss : float
        Heat of its friction [W], at least 0.
    """

    kinetic: float
    rope_power: float
    motor_power: float
    friction_loss: float

    @property
    def power(self) -> float:
        """Sum of the powers minus the loss [W]: the rate at which `kinetic` has to change."""
        return self.rope_power + self.motor_power - self.friction_loss


class SystemEnergy(NamedTuple):
    """Energies and powers of a system at an instant.

    Attributes
    ----------
    lines : dict of str to `tetherfmu.python.energy.Energy`
        By the names of the lines. The mass of a free point is in the first line there; the power of an end is that of the
        point's driver, 0 at a free point.
    loads : dict of str to float
        Powers of the loads on free points [W].
    sheaves : dict of str to SheaveEnergy
        Of the lines that run over sheaves, by their names. In `lines`, their `winch_power` has their `material_power`, too.
    winches : dict of str to WinchEnergy
        Of the winches that hold several lines by force, by their names; no part of `total` and `power`, as drums of lines.
    """

    lines: dict[str, Energy]
    loads: dict[str, float]
    sheaves: dict[str, SheaveEnergy]
    winches: dict[str, WinchEnergy]

    @property
    def total(self) -> float:
        """Kinetic + elastic + potential energy of all lines, points and sheaves [J]."""
        return sum(each.total for each in self.lines.values()) + sum(sum(each.kinetic) for each in self.sheaves.values())

    @property
    def power(self) -> float:
        """Sum of all powers minus the losses [W]: the rate at which `total` has to change."""
        gains = sum(each.power for each in self.lines.values()) + sum(self.loads.values())
        return gains - sum(sum(each.friction_loss) for each in self.sheaves.values())


class SystemFlown(NamedTuple):
    """Result of a flight of a system: one row for each kept step.

    Attributes
    ----------
    points : dict of str to PointOutputs
        Of each point, with a row for each kept step: arrays (rows, 3).
    outputs : dict of str to (rows, outputs_size) array
        Outputs of each line, in the columns of `layout.py`.
    positions : dict of str to (rows, segments + 1, 3) array
        Nodes of each line [m].
    seconds : float
        Wall time of all steps [s].
    refusals : tuple of `tetherfmu.python.results.Refusal`
        Steps that could not be done, see `on_refusal` of `TetherSystem.fly`.
    time : (rows,) array
        As in `tetherfmu.Flown`.
    winches : dict of str to WinchOutputs
        Of each winch that holds several lines, with arrays (rows,).
    portions : dict of str to PortionOutputs
        Of the lines that run over sheaves, by their names.
    """

    points: dict[str, PointOutputs]
    outputs: dict[str, np.ndarray]
    positions: dict[str, np.ndarray]
    seconds: float
    refusals: tuple
    time: np.ndarray
    winches: dict[str, WinchOutputs]
    portions: dict[str, PortionOutputs]

    def __repr__(self):
        """How much there is, instead of all its numbers."""
        rows = len(next(iter(self.positions.values())))
        return f"<SystemFlown: {rows} rows, {len(self.points)} points, {len(self.outputs)} lines>"


def end_of(outputs):
    """Motion at the end of a line, or of its released point, (..., 2, 3), from its outputs (..., outputs_size)."""
    return outputs[..., at.OUTPUT_KITE_POSITION : at.OUTPUT_KITE_POSITION + 6].reshape(*outputs.shape[:-1], 2, 3)


def points_of(points, lines, motions, values):
    """`PointOutputs` by name, from the motion of each line and the outputs of lines by name (..., outputs_size).

    points, lines : of the system.  motions : arrays (..., 2, segments + 1, 3).
    """
    forces, motion = dict.fromkeys((point.name for point in points), 0.0), {}
    for k, line in enumerate(lines):
        for node, place, name in ((0, at.GROUND_FORCE, line.start), (-1, at.KITE_FORCE, line.end)):
            forces[name] = forces[name] + values[line.name][..., place : place + 3]
            motion[name] = motions[k][..., node, :] if node == 0 else end_of(values[line.name])
    return {
        name: PointOutputs(motion[name][..., 0, :].copy(), motion[name][..., 1, :].copy(), force)
        for name, force in forces.items()
    }
