"""PythonFMU slave: a system of tethers."""

from tetherfmu.fmi.system_slave import SystemSlave


class TetherSystem(SystemSlave):
    """Tethers between points, driven or free, solved as one system."""

    description = (
        "System of dynamic segmented tethers between points, solved in one step. "
        "In: position and velocity of driven points, load on free points, reel-out speed of the lines, wind. "
        "Out: force of the lines on driven points, position and velocity of free points, tensions and shapes of the lines."
    )
