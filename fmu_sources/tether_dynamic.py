"""PythonFMU slave: the dynamic segmented tether, both ends driven."""

from tetherfmu.fmi import TetherSlave, hold_globals


class TetherDynamic(TetherSlave):
    """Lumped masses, non-linear spring-damper segments, drag, reel-out; both ends driven."""

    variant = "dynamic"
    description = (
        "Dynamic segmented tether between two driven ends: lumped masses, spring-damper segments, drag, reel-out. "
        "In: position and velocity of the kite (and of the ground end), wind, reel-out speed. "
        "Out: force of the tether on kite and ground."
    )

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        hold_globals(globals())
