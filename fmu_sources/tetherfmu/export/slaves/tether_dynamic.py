"""PythonFMU slave: the dynamic segmented tether, both ends driven."""

from tetherfmu.fmi.slave import TetherSlave


class TetherDynamic(TetherSlave):
    """Lumped masses, non-linear spring-damper segments, drag, reel-out; both ends driven."""

    variant = "dynamic"
    description = (
        "Dynamic segmented tether between two driven ends: lumped masses, spring-damper segments, drag, reel-out. "
        "In: position and velocity of the kite (and of the ground end), wind, reel-out speed. "
        "Out: force of the tether on kite and ground."
    )
