"""Check of a finished FMU on this machine: `python -m tetherfmu.check FILE.fmu`.

Needs FMPy; of this package it imports the name of the platform only, so that it runs where no FMU is built.
"""
