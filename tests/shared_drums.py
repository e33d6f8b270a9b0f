"""A file of a system with two winches that hold two lines by force, beside a line over a sheave with a drum of its own."""

OWN_DRUM = """winch_control = "force"
winch_mass = 3
winch_friction = 40
"""
TEXT = f"""
name = "Drums"

[points]
top = {{position = [0, 0, 0]}}
load = {{position = [0, 0, -19], mass = 30}}
far = {{position = [-8, 0, -10]}}
block = {{position = [6, 0, -16], mass = 10}}
end = {{position = [9, 0, -2]}}

[lines.a]
from = "top"
to = "load"
initial_length = 19
diameter = "5 mm"
segments = 4

[lines.b]
from = "top"
to = "far"
initial_length = 12.82
diameter = "5 mm"
segments = 4

[lines.c]
from = "load"
to = "end"
through = ["block"]
initial_length = 22.6
diameter = "5 mm"
segments = 3
sheave_friction = 0.05
{OWN_DRUM}
[winches.steering]
lines = {{a = 1, b = -1}}
control = "force"
winch_mass = "5 kg"
winch_friction = 40
winch_damping = 500
winch_force = 200

[winches.power]
lines = {{a = 1, b = 0.5}}
control = "force"
winch_mass = 8
winch_damping = 500
winch_force = "0.3 kN"
"""
SHARED = TEXT.replace("Drums", "Shared").replace(OWN_DRUM, "")  # the last line without
