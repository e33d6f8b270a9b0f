"""The classes of the Python API: tethers and systems of tethers, their arguments, and their results."""
