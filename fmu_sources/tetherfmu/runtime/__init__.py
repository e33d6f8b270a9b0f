"""Part of every FMU, below its FMI shell (`fmi`): declarations, flat arrays, one running tether.

The builder copies this folder unchanged. Standard library only. Imports nothing else of the package.
"""

__version__ = "1.0.0"
