"""The FMI shell of a finished FMU: its slave, its variables, its model description.

The builder copies this folder unchanged, beside `runtime`. Standard library only; only `base_slave` uses PythonFMU.
"""
