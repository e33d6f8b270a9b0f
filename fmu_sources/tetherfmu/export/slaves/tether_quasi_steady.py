"""PythonFMU slave: the quasi-steady segmented tether."""

from tetherfmu.fmi.slave import TetherSlave


class TetherQuasiSteady(TetherSlave):
    """Lumped segments in instantaneous equilibrium, turning with the kite."""

    variant = "quasi_steady"
    description = (
        "Quasi-steady segmented tether: in instantaneous equilibrium under weight, drag, elasticity and the inertia of "
        "turning with the kite; no waves. "
        "In: position and velocity of the kite (and of the ground end), wind, reel-out speed. "
        "Out: force of the tether on kite and ground."
    )
