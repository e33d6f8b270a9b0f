"""How does a mass of 1 kg come to rest that hangs on a spring of 50 N/m and a damper of 0.5 N s/m?

m z'' = -m g - k (z + L) - c z', from z = -L at rest. A spring and a damper are a segment of a tether. So the same numbers go
into TetherDynamic: one segment, almost without a mass of its own, as stiff when slack as when taut.
"""

import numpy as np
from lessons import DURATION, GRAVITY, TIMES, Lesson, command_line, curve, follow, over_time, timed
from scipy.integrate import solve_ivp

from tetherfmu import TetherDynamic
from tetherfmu.console.colours import COLOUR, REFERENCE, SKY_BLUE

LENGTH, MASS, STIFFNESS, DAMPING = 10.0, 1.0, 50.0, 0.5  # m, kg, N/m, N s/m
SAG = MASS * GRAVITY / STIFFNESS  # of the mass at rest below the unstretched spring [m]
SPRING = {"segments": 1, "initial_length": LENGTH, "axial_stiffness": STIFFNESS * LENGTH, "axial_damping": DAMPING * LENGTH}
SPRING |= {"density": 1e-3, "diameter": 1e-6, "drag_coefficient": 0.0}  # almost no mass of its own
SPRING |= {"point_masses": {1: MASS}, "free_ends": (False, True), "initial_shape": "straight"}


def rates(time, state):
    """Rates of change of height [m] and speed [m/s] of the mass."""
    height, speed = state
    return speed, -GRAVITY - (STIFFNESS * (height + LENGTH) + DAMPING * speed) / MASS


def simulate():
    """Height of the mass [m], array (rows,)."""
    return solve_ivp(rates, (0.0, DURATION), (-LENGTH, 0.0), "DOP853", TIMES, rtol=1e-8, atol=1e-9).y[0]


def product():
    """The same from TetherDynamic."""
    tether = TetherDynamic(**SPRING, slack_stiffness_ratio=1.0, relative_tolerance=1e-6)
    tether.initialize((0.0, 0.0, -LENGTH))
    return follow(tether, DURATION)[:, 1, 2]


def formula(time):
    """Height [m]: z = -L - s + s exp(-d t) (cos(w t) + d/w sin(w t)), s = m g/k, d = c/(2 m), w^2 = k/m - d^2."""
    decay = DAMPING / (2.0 * MASS)
    rate = np.sqrt(STIFFNESS / MASS - decay**2)
    return -LENGTH - SAG + SAG * np.exp(-decay * time) * (np.cos(rate * time) + decay / rate * np.sin(rate * time))


def lesson():
    """Height over time, and how far the solvers are from the formula."""
    height, seconds = timed(simulate)
    exact = formula(TIMES)
    title = "1 kg on a spring: the oscillation halves every 2.8 s"
    figure, above, below = over_time(title, "height [m]", "minus formula [µm]")
    above.axhline(exact[-1], color=REFERENCE, linewidth=0.8)
    curve(above, TIMES, height, color=SKY_BLUE)
    curve(below, TIMES, 1e6 * (height - exact), "solve_ivp", color=SKY_BLUE)
    curve(below, TIMES, 1e6 * (product() - exact), "TetherDynamic", color=COLOUR["dynamic"])
    return Lesson(f"comes to rest {SAG:.3f} m below the unstretched spring", figure, DURATION, seconds)


main = command_line(lesson)
