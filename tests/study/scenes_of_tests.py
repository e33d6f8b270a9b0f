"""Short scenes for the tests of the study."""

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


def written(folder, text=SCENE, name="short"):
    """Path of a scene file."""
    path = folder / f"{name}.toml"
    path.write_text(text, encoding="utf-8")
    return path
