"""A Y of three lines as the file of a system: from a winch to a knot, from there to two points that are driven."""

FILE = """
name = "{name}"

[points]
winch = {{position = [0, 0, 0]}}
knot = {{position = [0, 0, 99.5], mass = 2.0}}
left = {{position = [-23, 0, 131]}}
right = {{position = [26, 0, 131]}}

[lines.main]
from = "winch"
to = "knot"
initial_length = 100.0
segments = 5
{main}

[lines.a]
from = "left"
to = "knot"
initial_length = 39.0
segments = 3
{a}

[lines.b]
from = "knot"
to = "right"
initial_length = 41.0
segments = 3
"""


def y_of_lines(name, main="", a=""):
    """Text of the file.  main, a : what the lines from the winch and to the left have more."""
    return FILE.format(name=name, main=main, a=a)
