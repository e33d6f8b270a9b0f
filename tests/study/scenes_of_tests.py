"""Short scenes for the tests of the study, and CSV files of flights."""

import numpy as np

SCENE = """\
duration = "2 s"
[flight]
kind = "circle"
rate = "0.5 rad/s"
[tether]
initial_length = "505 m"
[wind]
velocity = [8.0, 0.0, 0.0]
[wanted]
allowed_error = "3 %"
communication_step = "20 ms"
"""
SERIES = SCENE.replace('kind = "circle"\nrate = "0.5 rad/s"', 'kind = "series"\nfile = "flight.csv"')


def written(folder, text=SCENE, name="short"):
    """Path of a scene file."""
    path = folder / f"{name}.toml"
    path.write_text(text, encoding="utf-8")
    return path


def write_series(path, time, columns):
    """Write a CSV file of columns by the names of inputs, vectors (rows, 3) or numbers; returns its path."""
    named = {"time": time}
    for name, values in columns.items():
        named |= {f"{name}[{i + 1}]": values[:, i] for i in range(3)} if values.ndim > 1 else {name: values}
    np.savetxt(path, np.column_stack([*named.values()]), delimiter=",", header=",".join(named), comments="")
    return path


def swaying(time):
    """Positions [m] and velocities [m/s] of a kite 500 m away that sways across the wind, arrays (times, 3)."""
    azimuth, rate = 0.1 * (1.0 - np.cos(0.3 * time)), 0.03 * np.sin(0.3 * time)
    x, y = 400.0 * np.cos(azimuth), 400.0 * np.sin(azimuth)
    return np.column_stack([x, y, 300.0 + 0.0 * time]), np.column_stack([-rate * y, rate * x, 0.0 * time])
