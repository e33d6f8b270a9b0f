"""PythonFMU slave: the dynamic segmented tether with a free kite end."""

from tetherfmu.fmi.slave import TetherSlave


class TetherDynamicFree(TetherSlave):
    """As the dynamic tether, but the kite end is a point mass that a force moves."""

    variant = "dynamic_free"
    description = (
        "Dynamic segmented tether with a free kite end, a point mass that moves under the tether, its weight and a load: "
        "lumped masses, spring-damper segments, drag, reel-out. "
        "In: load on the kite, position and velocity of the ground end, wind, reel-out speed. "
        "Out: position and velocity of the kite, force of the tether on kite and ground."
    )
