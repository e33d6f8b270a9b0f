"""From sources to FMUs: the archive, its documents and its evidence.

Imports `runtime`, the Python API (for the evidence) and PythonFMU's builder.
"""
