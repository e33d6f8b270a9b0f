"""What a tether of the Python API gives: outputs, whole flights, and refusals."""

from typing import NamedTuple

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.status import code


class Outputs(NamedTuple):
    """Outputs of a tether at an instant, SI units; docs/use/interface.md has their full meaning.

    Attributes
    ----------
    ground_force, kite_force : (3,) arrays
        Of the tether on the ground station and on the kite [N].
    ground_tension, kite_tension, max_tension : float
        Of the first and the last segment, and the largest of all [N].
    tether_length : float
        Unstretched [m].
    ground_elevation, ground_azimuth : float
        Direction in which the tether leaves the ground [rad]; azimuth anti-clockwise from the x axis, seen from above.
    slack_segments : int
        Segments that are shorter than unstretched.
    kite_end_mass : float
        Of the tether, lumped at the kite end [kg].
    kite_stiffness, kite_damping : float
        Along the tether, as the kite feels them [N/m, N s/m].
    wave_time : float
        Of a transverse wave over the tether [s].
    sag : float
        Largest distance of the tether from its chord [m].
    solver_steps, solver_rejections, solver_iterations : int
        Work since the start: internal steps, those that were taken back, Newton iterations.
    shape : (points, 3) array
        Points at equal unstretched length, ground first [m].
    kite_position, kite_velocity : (3,) arrays
        Of the kite end [m, m/s]: where a free one has moved to, or a driven one is led.

    Examples
    --------
    >>> from tetherfmu import TetherStraight
    >>> TetherStraight(initial_length=510.0, segments=4).initialize().shape.shape
    (5, 3)
    """

    ground_force: np.ndarray
    kite_force: np.ndarray
    ground_tension: float
    kite_tension: float
    max_tension: float
    tether_length: float
    ground_elevation: float
    ground_azimuth: float
    slack_segments: int
    kite_end_mass: float
    kite_stiffness: float
    kite_damping: float
    wave_time: float
    sag: float
    solver_steps: int
    solver_rejections: int
    solver_iterations: int
    shape: np.ndarray
    kite_position: np.ndarray
    kite_velocity: np.ndarray


def outputs_of(values, kite_end):
    """`Outputs` from an array in the order of `layout.py`, and from position and velocity of the kite end, (2, 3)."""
    return Outputs(
        values[at.GROUND_FORCE : at.KITE_FORCE],
        values[at.KITE_FORCE : at.GROUND_TENSION],
        *values[at.GROUND_TENSION : at.SLACK_SEGMENTS].tolist(),
        int(values[at.SLACK_SEGMENTS]),
        *values[at.SLACK_SEGMENTS + 1 : at.SOLVER_STEPS].tolist(),
        *map(int, values[at.SOLVER_STEPS : at.SHAPE].tolist()),
        values[at.SHAPE :].reshape(-1, 3),
        *kite_end,
    )


class Flown(NamedTuple):
    """What a flight of many communication steps gave: one row for each step that was kept.

    Attributes
    ----------
    outputs : (rows, outputs_size) array or None
        All outputs; `of` gives one by its name, forces and shapes are properties. None if flown with ``outputs=False``.
    peak : (rows,) array or None
        Largest ``norm(kite_force)`` since the row before [N]. None like `outputs`.
    positions : (rows, segments + 1, 3) array
        Of the nodes [m].
    seconds : float
        Wall time of all steps [s].

    Examples
    --------
    >>> from tetherfmu import TetherQuasiSteady, inputs_along
    >>> tether = TetherQuasiSteady(segments=6)
    >>> start = tether.initialize()
    >>> flown = tether.fly(inputs_along(100, 0.02, reel_out_speed=0.5), 0.02, every=10)
    >>> flown.kite_force.shape, flown.shape.shape, flown.positions.shape
    ((10, 3), (10, 7, 3), (10, 7, 3))
    >>> bool(flown.of("max_tension").max() >= flown.of("kite_tension").max())
    True
    """

    outputs: np.ndarray | None
    peak: np.ndarray | None
    positions: np.ndarray
    seconds: float = 0.0

    def __repr__(self):
        """How much there is, instead of all its numbers."""
        rows, nodes, _ = self.positions.shape
        kept = "node positions only" if self.outputs is None else "all outputs"
        return f"<Flown: {rows} rows, {nodes} nodes, {kept}>"

    def _observed(self):
        """The outputs; ValueError without."""
        if self.outputs is None:
            raise ValueError("this flight has node positions only: fly with outputs=True for forces and shapes")
        return self.outputs

    def of(self, name: str) -> np.ndarray:
        """A scalar output by its name in `Outputs`, such as "max_tension", array (rows,); ValueError for other names."""
        if name not in SCALARS:
            raise ValueError(f"name is {name!r}; it must be one of {', '.join(SCALARS)}")
        return self._observed()[:, getattr(at, name.upper())]

    @property
    def kite_force(self) -> np.ndarray:
        """Force on the kite [N], array (rows, 3)."""
        return self._observed()[:, at.KITE_FORCE : at.KITE_FORCE + 3]

    @property
    def ground_force(self) -> np.ndarray:
        """Force on the ground station [N], array (rows, 3)."""
        return self._observed()[:, at.GROUND_FORCE : at.GROUND_FORCE + 3]

    @property
    def shape(self) -> np.ndarray:
        """Points of the tether [m], array (rows, points, 3)."""
        outputs = self._observed()
        return outputs[:, at.SHAPE :].reshape(len(outputs), (outputs.shape[1] - at.SHAPE) // 3, 3)


SCALARS = tuple(name for name, kind in Outputs.__annotations__.items() if kind is not np.ndarray)


class PlausibilityWarning(UserWarning):
    """Something that no tether and no kite does, one warning since `initialize`; the numbers stay what they are.

    A stretch beyond 5 %, an end that is accelerated beyond 1000 g or faster than sound, velocities that contradict
    positions; docs/models/theory.md, "Plausibility".

    Examples
    --------
    >>> import warnings
    >>> from tetherfmu import TetherStraight
    >>> with warnings.catch_warnings(record=True) as given:
    ...     start = TetherStraight(initial_length=100.0).initialize(kite_position=(300.0, 0.0, 400.0))
    >>> given[0].category.__name__
    'PlausibilityWarning'
    """


class StepRefused(ValueError):
    """A step or an initialization that cannot be done; the tether keeps its previous state.

    Attributes
    ----------
    status : int or None
        Code of `tetherfmu.runtime.status`, such as `NO_EQUILIBRIUM`; None if no kernel was asked.

    Examples
    --------
    >>> from tetherfmu import TetherStraight
    >>> try:
    ...     TetherStraight().step(0.02)
    ... except StepRefused as refusal:
    ...     print(refusal)
    this TetherStraight is not initialized: call initialize first
    """

    def __init__(self, message: str, status: int | None = None):
        super().__init__(message)
        self.status = None if status is None else code(status)
