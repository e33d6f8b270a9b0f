"""Small vibrations of a taut chain without gravity, drag and damping.

n segments of rest length l0 between held ends, node mass m = mu l0, stiffness k = EA/l0, tension T, length l:

    axial mode j        omega = 2 sqrt(k/m) sin(j pi/(2 n))        continuum: j pi/L sqrt(EA/mu)
    transverse mode j   omega = 2 sqrt(T/(m l)) sin(j pi/(2 n))    continuum: j pi/(n l) sqrt(T l/(mu l0))

so lumped over continuum is sin(b)/b = 1 - b^2/6 + ..., b = j pi/(2 n). The mode is displaced by a and released: after 5
1/4 periods it must pass through 0 with the phase error arcsin(-q/a).
"""

import numpy as np
import pytest

from mechanics import line_density
from tetherfmu import Environment, Solver, Tether, TetherDynamic

PERIODS = 5.25
LENGTH = 100.0
VOID = Environment(gravity=0.0, air_density=0.0)
AXES = {"axial": (1.0, 0.0, 0.0), "transverse": (0.0, 0.0, 1.0)}


def measured_frequency(kind, n, mode, expected, strain, amplitude):
    """omega [rad/s] from the phase after PERIODS periods of the expected omega."""
    tether = Tether(segments=n, initial_length=LENGTH, axial_damping=0.0)
    model = TetherDynamic(tether, VOID, Solver(relative_tolerance=1e-8))
    kite = (LENGTH * (1.0 + strain), 0.0, 0.0)
    model.initialize(kite_position=kite)
    start = model.positions
    form = np.sin(mode * np.pi * np.arange(n + 1) / n)
    model.initialize(positions=start + amplitude * np.outer(form, AXES[kind]), velocities=np.zeros((n + 1, 3)))
    period = 2.0 * np.pi / expected
    count = round(300 * PERIODS)  # 300 steps per period: the phase error of the method is below 1e-7
    for _ in range(count):
        model.step(PERIODS * period / count, kite_position=kite)
    q = 2.0 / n * form @ ((model.positions - start) @ np.array(AXES[kind]))
    assert abs(q) < 0.2 * amplitude
    return (2.0 * np.pi * PERIODS + np.arcsin(-q / amplitude)) / (PERIODS * period)


@pytest.mark.parametrize(("kind", "strain", "amplitude"), [("axial", 0.01, 1e-2), ("transverse", 0.05, 1e-3)])
@pytest.mark.parametrize(("n", "mode"), [(2, 1), (10, 1), (10, 3), (20, 2)])
def test_frequency_of_the_chain_and_of_the_string(kind, strain, amplitude, n, mode):
    mu = line_density(Tether())
    rest = LENGTH / n
    length = rest * (1.0 + strain)
    lateral = 614600.0 * strain / length
    spring = 614600.0 / rest if kind == "axial" else lateral
    lumped = 2.0 * np.sqrt(spring / (mu * rest)) * np.sin(mode * np.pi / (2 * n))
    speed = np.sqrt((614600.0 if kind == "axial" else lateral * rest) / mu)  # per unstretched length
    continuum = mode * np.pi / LENGTH * speed
    measured = measured_frequency(kind, n, mode, lumped, strain, amplitude)
    # method 1e-7 (above); amplitude: (pi a/L)^2/(4 strain) = 5e-9 sideways, none along the tether
    assert measured == pytest.approx(lumped, rel=2e-7)
    b = mode * np.pi / (2 * n)
    assert measured / continuum == pytest.approx(1.0 - b**2 / 6.0, abs=b**4 / 100.0)  # next term b^4/120
