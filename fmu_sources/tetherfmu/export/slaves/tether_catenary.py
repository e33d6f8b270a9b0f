"""PythonFMU slave: the elastic catenary."""

from tetherfmu.fmi.slave import TetherSlave


class TetherCatenary(TetherSlave):
    """Elastic catenary under weight plus mean drag."""

    variant = "catenary"
    description = (
        "Elastic catenary under weight plus mean drag, in closed form: sag and end forces at rest or in slow flight. "
        "In: position and velocity of the kite (and of the ground end), wind, reel-out speed. "
        "Out: force of the tether on kite and ground."
    )
