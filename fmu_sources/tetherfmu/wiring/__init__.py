"""From names to numbers: the variables of tethers and systems, and where they stand in the flat arrays of the kernels.

FMI, Python, files and the tables of native FMUs read it. Every FMU carries it: the standard library only.
"""
