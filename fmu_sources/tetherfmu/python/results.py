"""Results of the tethers of the Python API: outputs, whole flights, refusals."""

from typing import NamedTuple

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.naming import meant_or_all
from tetherfmu.runtime.outputs import BY_NAME, OUTPUT_TABLE, PLACES, SCALAR, Outputs

SCALARS = tuple(each.name for each in OUTPUT_TABLE if each.shape == SCALAR)
_COUNTS = tuple((name, PLACES[name]) for name in SCALARS if BY_NAME[name].kind == "Integer")
_FLAGS = tuple((name, PLACES[name]) for name in SCALARS if BY_NAME[name].kind == "Boolean")
_NUMBERS = tuple((name, PLACES[name]) for name in SCALARS if BY_NAME[name].kind == "Real")
_VECTORS = tuple(name for name in PLACES if name not in SCALARS)


def outputs_of(values):
    """`Outputs` from an array in the order of `layout.py`."""
    scalars = values[: at.SHAPE].tolist()
    found = {name: scalars[place] for name, place in _NUMBERS}
    for name, place in _COUNTS:
        found[name] = int(scalars[place])
    for name, place in _FLAGS:
        found[name] = scalars[place] != 0.0
    for name in _VECTORS:
        found[name] = _vectors(values, name)
    return Outputs(**found)


def _vectors(values, name):
    """A vector, or the points of the shape, from an array of outputs; from many rows of them one of each row."""
    place = PLACES[name]
    if name != "shape":
        return values[..., place : place + 3]
    return values[..., place:].reshape(*values.shape[:-1], (values.shape[-1] - place) // 3, 3)


class Refusal(NamedTuple):
    """A refused step of a flight.

    Attributes
    ----------
    step : int
        Row of the inputs, from 0.
    reason : str
        Message of the `StepRefused`.
    status : int
        Status of the `StepRefused`.

    >>> Refusal(3, "the step is 0.0 s; it must be above 0 s", 1).step
    3
    """

    step: int
    reason: str
    status: int


class Flown(NamedTuple):
    """Result of a flight of many communication steps: one row for each kept step.

    Attributes
    ----------
    outputs : (rows, outputs_size) array or None
        All outputs; `of` returns one by its name, forces and shapes are properties. None if flown with ``outputs=False``.
    peak : (rows,) array or None
        Largest ``norm(kite_force)`` since the row before [N]. None like `outputs`.
    positions : (rows, segments + 1, 3) array
        Of the nodes [m].
    seconds : float
        Wall time of all steps [s].
    refusals : tuple of `Refusal`
        Steps that could not be done, see `on_refusal` of `TetherModel.fly`.
    time : (rows,) array
        Since the start of the flight [s]: the sum of all communication steps up to the row, left out or not.

    Examples
    --------
    >>> from tetherfmu import TetherQuasiSteady, inputs_along
    >>> tether = TetherQuasiSteady(segments=6)
    >>> start = tether.initialize()
    >>> flown = tether.fly(inputs_along(100, 0.02, reel_out_speed=0.5), 0.02, every=10)
    >>> flown.kite_force.shape, flown.shape.shape, flown.positions.shape
    ((10, 3), (10, 7, 3), (10, 7, 3))
    >>> flown.time.round(3).tolist()[:3]
    [0.2, 0.4, 0.6]
    >>> bool(flown.of("max_tension").max() >= flown.of("kite_tension").max())
    True
    """

    outputs: np.ndarray | None
    peak: np.ndarray | None
    positions: np.ndarray
    seconds: float = 0.0
    refusals: tuple = ()
    time: np.ndarray | None = None

    def __repr__(self):
        """How much there is, instead of all its numbers."""
        rows, nodes, _ = self.positions.shape
        kept = "node positions only" if self.outputs is None else "all outputs"
        parts = [f"{rows} rows", f"{nodes} nodes", kept]
        if self.refusals:
            first = self.refusals[0]
            parts += [f"{len(self.refusals)} refused, the first is step {first.step + 1}: {first.reason}"]
        return f"<Flown: {', '.join(parts)}>"

    def _observed(self):
        """The outputs; ValueError without."""
        if self.outputs is None:
            raise ValueError("this flight has node positions only: fly with outputs=True for forces and shapes")
        return self.outputs

    def of(self, name: str) -> np.ndarray:
        """A scalar output by its name in `Outputs`, such as "max_tension", array (rows,); ValueError for other names."""
        if name not in SCALARS:
            raise ValueError(f"there is no scalar output {name!r}{meant_or_all(name, SCALARS)}")
        return self._observed()[:, PLACES[name]]

    @property
    def kite_force(self) -> np.ndarray:
        """Force on the kite [N], array (rows, 3)."""
        return _vectors(self._observed(), "kite_force")

    @property
    def ground_force(self) -> np.ndarray:
        """Force on the ground station [N], array (rows, 3)."""
        return _vectors(self._observed(), "ground_force")

    @property
    def shape(self) -> np.ndarray:
        """Points of the tether [m], array (rows, points, 3)."""
        return _vectors(self._observed(), "shape")


def flown_of(rows, seconds, refusals, time):
    """`Flown` of the rows of one line at these times [s], see `compiled_flight.fly`."""
    peak = None if rows.peaks is None else rows.peaks[:, 0]
    return Flown(rows.outputs, peak, rows.motion[0][:, 0].copy(), seconds, refusals, time)
