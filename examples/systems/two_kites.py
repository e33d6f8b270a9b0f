"""How much of the drag of a tether is saved by two kites that share one? Their main tether hardly moves.

    python examples/systems/two_kites.py

Two kites circle opposite to each other about an axis, each on an arm of 60 m; the arms meet in a knot, a free point of 2 kg,
on a main tether of 150 m. `TetherSystem` solves the three lines and the knot in one system. For comparison each kite flies
the same circle on a separate tether to the ground: that sweeps through the air, and the kite has to pull it.

A straight tether of length L that turns about one end with the speed v at the other holds it back by rho C d v^2 L/8: the
drag of a piece grows with the square of its distance from that end, and its lever with the distance. On the shared tether L
is the arm.
"""

import sys

import numpy as np

from tetherfmu import Environment, Line, MovingEnd, Point, Tether, TetherDynamic, TetherSystem, inputs_along
from tetherfmu.console.colours import BLACK, BLUE, GREY, VERMILLION
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser
from tetherfmu.runtime.layout import GROUND_TENSION

MAIN, ARM, RADIUS = 150.0, 60.0, 40.0  # m
SPEED, ELEVATION, STEP, DURATION = 30.0, np.radians(35.0), 0.02, 20.0  # m/s, rad, s, s
STRETCH, KNOT_MASS, AIR = 3e-3, 2.0, Environment()  # -, kg
AXIS = np.array([np.cos(ELEVATION), 0.0, np.sin(ELEVATION)])
ACROSS, UPWARDS = np.array([0.0, 1.0, 0.0]), np.array([-np.sin(ELEVATION), 0.0, np.cos(ELEVATION)])
AWAY = MAIN + np.sqrt(ARM**2 - RADIUS**2)  # of the circle from the ground [m]
KITES = {"left": 0.0, "right": np.pi}  # their phases [rad]


def path(phase):
    """Position of a kite [m] as a function of time [s]."""
    return lambda t: (
        AWAY * AXIS + RADIUS * (np.cos(SPEED / RADIUS * t + phase) * ACROSS + np.sin(SPEED / RADIUS * t + phase) * UPWARDS)
    )


def tether(length, segments):
    """A tether that is stretched a little over a length [m]."""
    return Tether(segments=segments, initial_length=length * (1.0 - STRETCH))


def fly_together():
    """The system, and its flight (`SystemFlown`)."""
    ends = {name: MovingEnd(path(phase)) for name, phase in KITES.items()}
    points = [Point("ground", (0.0, 0.0, 0.0)), Point("knot", tuple(MAIN * AXIS), mass=KNOT_MASS)]
    points += [Point(name, *map(tuple, end.at(0.0))) for name, end in ends.items()]
    lines = [Line("main", "ground", "knot", tether(MAIN, 15))]
    lines += [Line(f"arm_{name}", "knot", name, tether(ARM, 6)) for name in KITES]
    system = TetherSystem(points, lines, AIR)
    system.initialize()
    times = STEP * np.arange(round(DURATION / STEP))
    motion = {name: np.array([end.at(t) for t in times]) for name, end in ends.items()}
    positions, velocities = ({name: each[:, k] for name, each in motion.items()} for k in (0, 1))
    return system, system.fly(len(times), STEP, positions=positions, velocities=velocities)


def fly_alone():
    """Flight of a kite on a tether of its own (`Flown`)."""
    end = MovingEnd(path(0.0))
    alone = TetherDynamic(tether(np.hypot(AWAY, RADIUS), 21), AIR)
    alone.initialize(*end.at(0.0))
    return alone.fly(inputs_along(round(DURATION / STEP), STEP, end), STEP)


def drag(force, velocity):
    """Mean force [N] with which a tether holds a kite back, from forces on the kite and its velocities, arrays (rows, 3)."""
    return -float(np.mean(np.sum(force * velocity, axis=1) / np.linalg.norm(velocity, axis=1)))


def formula(length):
    """What holds a kite back [N], of a straight tether of this length [m] that turns about its other end."""
    line = tether(length, 1)
    return AIR.air_density * line.drag_coefficient * line.diameter * SPEED**2 * length / 8.0


def draw(flown, alone, path):
    """Both flights in space over the last turn, and the tensions of the system, to a file."""
    import matplotlib.pyplot as plt

    figure = plt.figure(figsize=(10.0, 4.8))
    space = figure.add_axes((0.0, 0.05, 0.48, 0.85), projection="3d")
    turn = round(2.0 * np.pi * RADIUS / SPEED / STEP)
    # where the arms do not coincide
    rows = np.linspace(len(alone.positions) - turn, len(alone.positions), 5, endpoint=False)
    for row in rows.astype(int):
        space.plot(*alone.positions[row].T, color=GREY, linewidth=0.8)
        for name, colour in {"main": BLACK, "arm_left": BLUE, "arm_right": VERMILLION}.items():
            space.plot(*flown.positions[name][row].T, color=colour, linewidth=1.2)
    space.set(xlabel="x [m]", ylabel="y [m]", zlabel="z [m]", title="Two kites on one tether; grey: one alone")
    space.set_aspect("equal")
    space.view_init(elev=15.0, azim=-60.0)
    space.locator_params(axis="y", nbins=3)
    axes = figure.add_axes((0.6, 0.12, 0.38, 0.76))
    time = STEP * np.arange(1, len(alone.positions) + 1)
    for name, colour in {"main": BLACK, "arm_left": BLUE, "arm_right": VERMILLION}.items():
        axes.plot(time, 1e-3 * tension(flown, name), color=colour, label=name)
    axes.set(xlabel="time [s]", ylabel="tension at the start of the line [kN]", ylim=(0.0, None))
    axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(path, dpi=100)
    plt.close(figure)


def tension(flown, name):
    """Tension of a line at its start [N], array (rows,)."""
    return flown.outputs[name][:, GROUND_TENSION]


@command
def main(arguments=None):
    """Print how far the knot moves and what the tethers cost the kites, write the figure."""
    parser = Parser(description="fly two kites on one tether, and one alone")
    parser.add_out()
    file = parser.parse_args(arguments).out / "two_kites.png"
    (_, flown), alone = fly_together(), fly_alone()
    settled = slice(len(alone.positions) // 2, None)
    knot = flown.points["knot"].position[settled]
    print(f"the knot stays within {np.ptp(knot, axis=0).max():.2f} m, the kites circle at {RADIUS:g} m and {SPEED:g} m/s")
    left = flown.points["left"]
    shared, own = (drag(force[settled], left.velocity[settled]) for force in (left.force, alone.kite_force))
    print(f"held back by {shared:.1f} N on the shared tether (formula {formula(ARM):.1f} N)")
    print(f"held back by {own:.1f} N on one of its own (formula {formula(np.hypot(AWAY, RADIUS)):.1f} N)")
    file.parent.mkdir(parents=True, exist_ok=True)
    draw(flown, alone, file)
    print(file)


if __name__ == "__main__":
    sys.exit(main())
