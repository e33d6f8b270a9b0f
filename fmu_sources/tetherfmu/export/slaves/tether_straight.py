"""PythonFMU slave: the straight elastic line."""

from tetherfmu.fmi.slave import TetherSlave


class TetherStraight(TetherSlave):
    """Straight elastic line; weight and drag shared between its ends."""

    variant = "straight"
    description = (
        "Straight elastic line with weight and drag shared between its ends: tension of a taut tether at almost no cost. "
        "In: position and velocity of the kite (and of the ground end), wind, reel-out speed. "
        "Out: force of the tether on kite and ground."
    )
