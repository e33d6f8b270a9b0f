"""Points, lines, winches and systems of them, described once; and from their names to numbers in the arrays of the kernels.

FMI, Python, files and the tables of native FMUs read it. Every FMU carries it: the standard library only.
"""
