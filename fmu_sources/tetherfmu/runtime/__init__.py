"""All of this package that a finished FMU carries: declarations, flat arrays, one running tether, the FMI slave.

The builder copies this folder as it is. Standard library only; `base_slave` alone knows PythonFMU. Imports nothing else of
the package.
"""

__version__ = "0.1.0"
