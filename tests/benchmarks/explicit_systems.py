"""Systems of tethers against an explicit method with steps of 40 microseconds, which needs no Jacobian and no ladder.

    python tests/benchmarks/explicit_systems.py [--write] [--check]

Prints, as CSV, how far `TetherSystem` with its default tolerance and communication steps of 20 ms is from it; `--write`
also writes its series to tests/reference/explicit_*.csv. Equations: tests/networks.py; method: classical Runge-Kutta.
`--check`: with steps twice as long, too. Tethers are 4 mm of Dyneema. Scenes:

    slack_y   a knot of 2 kg between the ground and two kites, partly slack; the kites start from rest and fly circles
    bridle    a kite at 25 m/s around the station, three lines of 4 m from its wing to a knot of 0.3 kg
"""

import sys

import numpy as np
from as_script import REFERENCE, options, print_csv

from networks import Network
from tetherfmu import Environment, Line, Point, Tether, TetherSystem
from tetherfmu.study.measuring.tables import circumstances

SHORT, STEP, EVERY = 4e-5, 0.02, 0.1  # step of the explicit method, communication step, time between rows [s]
WIND = np.array((8.0, 1.0, 0.0))
DURATION = {"slack_y": 10.0, "bridle": 5.0}
HEAD = ("scene", "from the explicit method differs", "knot m", "largest m", "forces N", "largest N", "largest force N")
WING = {"nose": (150.0, 1.0, 100.0), "left": (149.445, -0.5, 100.832), "right": (150.555, -0.5, 99.168)}
# radius [m], way ahead on it [m], height [m]: a triangle across the main line, which has the direction (150, 0, 100)


def turning(centre, radius, rate, ahead=0.0, from_rest=False):
    """Motion on a horizontal circle [m], [rad/s]; ahead : angle at the start [rad].

    from_rest : it speeds up in some seconds, by the angle rate t^3/(t^2 + 1).
    """

    def motion(time):
        square = time * time
        turned, speed = (time * square, square * (square + 3.0)) if from_rest else (time, 1.0)
        below = square + 1.0 if from_rest else 1.0
        angle, speed = ahead + rate * turned / below, rate * speed / below**2
        c, s = np.cos(angle), np.sin(angle)
        return np.add(centre, (radius * c, radius * s, 0.0)), speed * radius * np.array((-s, c, 0.0))

    return motion


def still(place):
    """Motion of a point that is held."""
    return lambda time: (np.array(place), np.zeros(3))


def network(name):
    """`Network` of a scene."""
    if name == "slack_y":
        motions = {
            "winch": still((0.0, 0.0, 0.0)),
            "left": turning((-29.0, 0.0, 131.0), 6.0, 1.2, from_rest=True),
            "right": turning((20.0, 0.0, 131.0), 6.0, -1.2, from_rest=True),
        }
        arm = Tether(segments=3, initial_length=40.3)
        lines = [Line("main", "winch", "knot", Tether(segments=5, initial_length=99.9))]
        lines += [Line("a", "knot", "left", arm), Line("b", "right", "knot", arm)]
        knot = Point("knot", (1.55066, 0.70459903, 99.047934), mass=2.0)
    else:
        motions = {"winch": still((0.0, 0.0, 0.0))}
        for each, (radius, ahead, height) in WING.items():
            motions[each] = turning((0.0, 0.0, height), radius, 25.0 / 150.0, ahead / 150.0)
        short = Tether(segments=1, initial_length=4.0).with_diameter(0.002)
        lines = [Line("main", "winch", "knot", Tether(segments=8, initial_length=175.7))]
        lines += [Line(f"to_{each}", "knot", each, short) for each in WING]
        knot = Point("knot", (146.77776, -0.059029312, 97.847439), mass=0.3)
    points = [Point(each, *motion(0.0)) for each, motion in motions.items()]
    return Network([*points, knot], lines, Environment(), WIND, motions)


def row(network, time, x, v):
    """Row of a file: time [s], place of the knot [m], forces of the lines on the driven points [N]."""
    force = network.forces(time, x, v)
    knot = network.names.index("knot")
    return [time, *x[knot], *(each for k in network.driven for each in force[k])]


def explicit(network, system, duration, step=SHORT):
    """Rows every `EVERY` seconds, from the present state of a system."""
    x, v = (network.gathered(each) for each in (system.positions, system.velocities))
    y = np.concatenate([each[network.free].ravel() for each in (x, v)])
    rows, every = [row(network, 0.0, x, v)], round(EVERY / step)
    for k in range(round(duration / step)):
        time, half = k * step, (k + 0.5) * step
        a = network.rates(time, y)
        b = network.rates(half, y + 0.5 * step * a)
        c = network.rates(half, y + 0.5 * step * b)
        d = network.rates(time + step, y + step * c)
        y = y + step / 6.0 * (a + 2.0 * b + 2.0 * c + d)
        if (k + 1) % every == 0:
            rows.append(row(network, time + step, *network.unpacked(time + step, y)))
    return np.array(rows)


def started(network):
    """`TetherSystem` of a network with the default tolerance, at its start."""
    system = TetherSystem(network.points, network.lines, network.environment)
    system.initialize(network.wind)
    return system


def ours(network, duration, step=STEP):
    """Rows every `EVERY` seconds of the system with communication steps [s]."""
    system, times = started(network), step * np.arange(round(duration / step))
    motions = network.motions
    rows = [row(network, 0.0, *(network.gathered(each) for each in (system.positions, system.velocities)))]
    flight = system.fly(
        len(times),
        step,
        positions={name: np.array([motion(time)[0] for time in times]) for name, motion in motions.items()},
        velocities={name: np.array([motion(time)[1] for time in times]) for name, motion in motions.items()},
        every=round(EVERY / step),
    )
    driven = [network.names[k] for k in network.driven]
    forces = np.concatenate([flight.points[name].force for name in driven], axis=1)
    after = EVERY * np.arange(1, len(forces) + 1)
    return np.vstack([rows, np.column_stack([after, flight.points["knot"].position, forces])])


def errors(found, right):
    """Root mean square and largest error of the knot [m], of the forces [N], and the largest force [N]."""
    gap = found - right
    parts = [(np.sqrt(np.mean(part**2)), np.abs(part).max()) for part in (gap[:, 1:4], gap[:, 4:])]
    return (*parts[0], *parts[1], np.abs(right[:, 4:]).max())


def main():
    """Print the table."""
    given = options(__doc__, write=False, check=False)
    print(circumstances(), file=sys.stderr)
    print_csv(*HEAD)
    for name, duration in DURATION.items():
        case = network(name)
        right = explicit(case, started(case), duration)
        ways = {f"TetherSystem, steps of {1e3 * step:g} ms": ours(case, duration, step) for step in (STEP, 0.005, 0.001)}
        if given.check:
            ways["itself, steps of 80 us"] = explicit(case, started(case), duration, 2.0 * SHORT)
        for what, found in ways.items():
            print_csv(name, what, *(f"{each:.2g}" for each in errors(found, right)))
        if given.write:
            names = ["time", "x", "y", "z", *(f"{axis}_{case.names[k]}" for k in case.driven for axis in "xyz")]
            path = REFERENCE / f"explicit_{name}.csv"
            np.savetxt(path, right, fmt="%.8g", delimiter=",", header=",".join(names), comments="")


if __name__ == "__main__":
    main()
