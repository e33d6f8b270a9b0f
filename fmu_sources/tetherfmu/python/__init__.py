"""The classes of the Python API: tethers and systems of them, what they are given, and what they give."""
