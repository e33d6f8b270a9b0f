"""The FMI shell of a finished FMU: its slave, its variables, its model description.

The builder copies this folder as it is, beside `runtime`. Standard library only; `base_slave` alone knows PythonFMU.
"""
