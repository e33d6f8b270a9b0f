"""How does a tether swing while it is reeled out, and how much of its energy is lost to a solver with fixed steps?

Dyneema, 50 m, 5 segments, pi/10 off the vertical, 2 m/s are reeled out, no air. From here on TetherDynamic replaces the
function `rates`, the shared masses and `solve_ivp` of lesson 05. It also has what reeling changes: length, stiffness and
mass of each segment. Its solver, Rodas4P, chooses its steps; with `fixed_step`, for real time, and
`fixed_step_method` backward_euler it takes backward Euler steps, which damp.
"""

import numpy as np
from lessons import DURATION, STEP, TIMES, Lesson, Movie, beside_motion, command_line, curve, timed

from tetherfmu import TetherDynamic
from tetherfmu.console.colours import BLACK, COLOUR, REFERENCE, SKY_BLUE

LENGTH, ANGLE, REEL_OUT, EXACT = 50.0, np.pi / 10.0, 2.0, 1e-9  # m, rad, m/s, tolerance
END = LENGTH * np.array([-np.sin(ANGLE), 0.0, -np.cos(ANGLE)])
DYNEEMA = {"segments": 5, "initial_length": LENGTH, "initial_shape": "straight", "free_ends": (False, True)}
DYNEEMA |= {"slack_stiffness_ratio": 0.01 / 1.01}  # as in Tethers.jl: s/(1 + s) of the taut stiffness, s = 0.01
EULER = {"fixed_step_method": "backward_euler"}
SOLVERS = {  # options, colour, shift of the name
    "fixed 20 ms": ({"fixed_step": 0.02, **EULER}, BLACK, 0),
    "fixed 5 ms": ({"fixed_step": 0.005, **EULER}, SKY_BLUE, 0),
    "fixed 1 ms": ({"fixed_step": 0.001, **EULER}, REFERENCE, 5),
    "Rodas4P, 1e-4": ({"relative_tolerance": 1e-4}, COLOUR["dynamic"], -7),
}


def simulate(relative_tolerance=1e-4, **options):
    """Node positions [m] and velocities [m/s], array (rows, 2, 6, 3)."""
    tether = TetherDynamic(**DYNEEMA, drag_coefficient=0.0, relative_tolerance=relative_tolerance, **options)
    tether.initialize(END, reel_out_speed=REEL_OUT)
    motion = [(tether.positions, tether.velocities)]
    for _ in range(round(DURATION / STEP)):
        tether.step(STEP, reel_out_speed=REEL_OUT)
        motion.append((tether.positions, tether.velocities))
    return np.array(motion)


def kinetic_energy(motion):
    """Of the nodes, per mass of a segment [m2/s2], array (rows,); the last node has half the mass."""
    return (motion[:, 1] ** 2).sum(axis=-1) @ (0.0, 0.5, 0.5, 0.5, 0.5, 0.25)


def lesson():
    """Shapes, and the kinetic energy that each solver has lost, against the motion at a tolerance of 1e-9."""
    exact, (motion, seconds) = simulate(EXACT), timed(simulate)
    figure, right = beside_motion(motion[:, 0], 100, "Reeled out at 2 m/s")
    shown = slice(100, None, 5)  # the first motion has hardly any energy
    for name, (options, colour, shift) in SOLVERS.items():
        lost = 100.0 * (1.0 - kinetic_energy(simulate(**options)) / np.maximum(kinetic_energy(exact), 1e-9))
        curve(right, TIMES[shown], lost[shown], name, shift=shift, color=colour)
    right.set(xlabel="time [s]", ylabel="kinetic energy lost [%]", title="Energy that the solver loses")
    answer = f"the free end falls at {motion[-1, 1, -1, 2]:.1f} m/s at the end"
    return Lesson(answer, figure, DURATION, seconds, Movie(motion[:, 0], "Reeling out"))


main = command_line(lesson)
