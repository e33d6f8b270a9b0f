"""The Python API: the four tethers, without FMI."""

from .tether_model import TetherModel


class TetherDynamic(TetherModel):
    """Lumped masses joined by non-linear spring-damper segments, with drag and reel-out; both ends driven or free.

    Parameters
    ----------
    free_ends : (bool, bool)
        Whether the ground end and the kite end move freely after the start, instead of following the inputs.

    The other parameters are those of `TetherModel`.

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
        super().__init__(*arguments, **options, _free_ends=free_ends)


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
