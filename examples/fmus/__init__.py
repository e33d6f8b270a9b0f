"""Kites, a winch, a flight controller and a prescribed flight as FMUs, to couple with a tether FMU.

`tetherfmu build --examples` builds them. `model_slave` is what they share; `air` and `aerodynamics` are physics without FMI.
Standard library only, as in the folder `runtime` that they ship; docs/use/example_fmus.md has tables and sources.
"""
