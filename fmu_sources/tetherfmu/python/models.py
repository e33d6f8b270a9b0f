"""The Python API: the tethers, without FMI."""

from __future__ import annotations

from typing import Unpack

from numpy.typing import ArrayLike

from tetherfmu.runtime.parameters import FreeKite

from .given_inputs import Inputs
from .results import Outputs
from .tether_base import TetherModel


class TetherDynamic(TetherModel):
    """Lumped masses joined by non-linear spring-damper segments, with drag and reel-out; both ends driven or free.

    It has the parameters of `TetherModel` and one more.

    Parameters
    ----------
    free_ends : (bool, bool)
        Whether the ground end and the kite end move freely after the start, instead of following the inputs.

    Examples
    --------
    A tether of 505 m between the ground and a kite 500 m away, in wind:

    >>> tether = TetherDynamic(initial_length=505.0, segments=30)
    >>> start = tether.initialize(kite_position=(300.0, 0.0, 400.0), wind_velocity=(8.0, 0.0, 0.0))
    >>> for _ in range(50):
    ...     outputs = tether.step(0.02)
    >>> tether
    <TetherDynamic: 30 segments, 505 m unstretched, running>
    >>> outputs.kite_force.shape, outputs.shape.shape
    ((3,), (31, 3))
    """

    variant = "dynamic"

    def __init__(self, *arguments, free_ends: tuple[bool, bool] = (False, False), **options):
        self._free_ends = free_ends
        super().__init__(*arguments, **options)


class TetherDynamicFree(TetherModel):
    """The dynamic tether with a free kite end, a point mass: its input is a load, its output the motion.

    `kite_position` and `kite_velocity` of `initialize` are where the motion starts; afterwards they are outputs.
    It has the parameters of `TetherModel` and two more.

    Parameters
    ----------
    kite_mass : float
        Point mass at the kite end [kg], at least 0, beside half of the last segment. Gravity acts on it.
    kite_start : str or int
        "given": at `kite_position` with `kite_velocity` of `initialize`. "equilibrium": at rest where the tether, the weight
        of the kite and the `kite_load` of `initialize` are in equilibrium; the search begins at `kite_position`.

    Examples
    --------
    A load of 500 kg that hangs at a crane in wind:

    >>> crane = TetherDynamicFree(initial_length=40.0, segments=8, kite_mass=500.0, kite_start="equilibrium")
    >>> start = crane.initialize((0.0, 0.0, 10.0), ground_position=(0.0, 0.0, 50.0), wind_velocity=(15.0, 0.0, 0.0))
    >>> start.kite_position.round(3).tolist(), (start.kite_force - (0.0, 0.0, 500.0 * 9.81)).round(6).tolist()
    ([0.087, 0.0, 9.681], [0.0, 0.0, 0.0])

    A kite of 10 kg on a tether of 505 m, 500 m away at the start, and a load that carries it outwards:

    >>> tether = TetherDynamicFree(initial_length=505.0, kite_mass=10.0)
    >>> start = tether.initialize(kite_position=(300.0, 0.0, 400.0), wind_velocity=(8.0, 0.0, 0.0))
    >>> for _ in range(50):
    ...     outputs = tether.step(0.02, kite_load=(150.0, 0.0, 330.0))
    >>> outputs.kite_position.round(1).tolist(), outputs.kite_velocity.round(1).tolist()
    ([302.2, 0.0, 399.8], [3.8, 0.0, -1.0])
    """

    variant = "dynamic_free"
    _free_ends = (False, True)

    def __init__(
        self, *arguments, kite_mass: float = FreeKite.kite_mass, kite_start: str | int = FreeKite.kite_start, **options
    ):
        self._kite = FreeKite(kite_mass, kite_start)
        super().__init__(*arguments, **options)

    def step(self, step: float, kite_load: ArrayLike | None = None, **inputs: Unpack[Inputs]) -> Outputs:
        """Advance by a communication step with the inputs at its start; an omitted input keeps its value.

        Result and errors are the same as for `TetherModel.step`.

        Parameters
        ----------
        step : float
            Communication step [s].
        kite_load : (3,) array
            External force on the kite [N]: aerodynamics, control; excludes its weight.
        **inputs
            Other `Inputs`, `ground_position` and `ground_velocity`.
        """
        return self._step(step, None, {"kite_load": kite_load, **inputs})


class TetherQuasiSteady(TetherModel):
    """The chain of the dynamic tether in instantaneous equilibrium, turning with the kite; parameters as `TetherModel`.

    Examples
    --------
    >>> tether = TetherQuasiSteady(segments=10)
    >>> start = tether.initialize(kite_position=(300.0, 0.0, 400.0), slack=0.01)
    >>> outputs = tether.step(0.02, tether_length=510.0)
    >>> outputs.tether_length
    510.0
    """

    variant = "quasi_steady"


class TetherCatenary(TetherModel):
    """Elastic catenary under weight plus mean drag, in closed form; parameters as `TetherModel`.

    Examples
    --------
    >>> TetherCatenary().initialize(kite_position=(300.0, 0.0, 400.0)).sag > 20.0
    True
    """

    variant = "catenary"


class TetherStraight(TetherModel):
    """Straight elastic line with weight and drag shared between its ends; parameters as `TetherModel`.

    Examples
    --------
    >>> TetherStraight(initial_length=495.0).initialize(kite_position=(300.0, 0.0, 400.0)).kite_tension > 6000.0
    True
    """

    variant = "straight"
