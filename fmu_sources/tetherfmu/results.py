"""What a tether of the Python API gives: outputs, whole flights, and refusals."""

from typing import NamedTuple

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import code


class Outputs(NamedTuple):
    """Outputs of a tether at an instant (docs/interface.md), SI units."""

    ground_force: np.ndarray  # (3,), of the tether on the ground station [N]
    kite_force: np.ndarray  # (3,), of the tether on the kite [N]
    ground_tension: float  # of the first segment [N]
    kite_tension: float  # of the last segment [N]
    max_tension: float  # largest of all segments [N]
    tether_length: float  # unstretched [m]
    ground_elevation: float  # at which the tether leaves the ground [rad]
    ground_azimuth: float  # anti-clockwise from the x axis, seen from above [rad]
    slack_segments: int  # shorter than unstretched
    kite_end_mass: float  # of the tether, lumped at the kite end [kg]
    kite_stiffness: float  # along the tether, as the kite feels it [N/m]
    kite_damping: float  # along the tether, as the kite feels it [N s/m]
    wave_time: float  # of a transverse wave over the tether [s]
    sag: float  # largest distance of the tether from its chord [m]
    solver_steps: int  # internal steps since the start
    solver_rejections: int  # internal steps taken back since the start
    solver_iterations: int  # Newton iterations since the start
    shape: np.ndarray  # (points, 3), at equal unstretched length, ground first [m]


class Flown(NamedTuple):
    """What a flight of many communication steps gave: one row for each step that was kept."""

    outputs: np.ndarray  # (rows, outputs_size), as `layout.py` has them
    peak: np.ndarray  # (rows,), largest |kite_force| since the row before [N]
    positions: np.ndarray  # (rows, segments + 1, 3), of the nodes [m]
    seconds: float = 0.0  # wall time of all steps [s]

    @property
    def kite_force(self) -> np.ndarray:
        """Force on the kite [N], array (rows, 3)."""
        return self.outputs[:, at.KITE_FORCE : at.KITE_FORCE + 3]

    @property
    def ground_force(self) -> np.ndarray:
        """Force on the ground station [N], array (rows, 3)."""
        return self.outputs[:, at.GROUND_FORCE : at.GROUND_FORCE + 3]

    @property
    def shape(self) -> np.ndarray:
        """Points of the tether [m], array (rows, points, 3)."""
        points = (self.outputs.shape[1] - at.SHAPE) // 3
        return self.outputs[:, at.SHAPE :].reshape(len(self.outputs), points, 3)


class StepRefused(ValueError):
    """A step or an initialization that cannot be done; the tether keeps the state of before.

    Attributes
    ----------
    status : int or None
        Code of `tetherfmu.runtime.status`, such as `NO_EQUILIBRIUM`; None if no kernel was asked.
    """

    def __init__(self, message: str, status: int | None = None):
        super().__init__(message)
        self.status = None if status is None else code(status)
