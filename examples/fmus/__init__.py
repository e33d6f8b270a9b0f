"""Kites, a winch, a flight controller, a prescribed flight and turbulent wind as FMUs, to couple with a tether FMU.

`tetherfmu build --examples` builds them. `model_slave` is what they share; `air` and `aerodynamics` are physics without FMI.
Standard library only, as in the folder `runtime` that they ship; docs/use/example_fmus.md has tables and sources. Turbulent
wind alone needs numpy: the folder `wind` of the package, which it ships, reads its files and is its physics; `file_slave` is
a model with a file.
"""
