"""A tether on a flat ground in MoorDyn and in `TetherDynamic`: three scenes side by side, and what a drop costs.

    pip install "moordyn>=2.7"
    python tests/benchmarks/moordyn_ground.py [--write | --cost | --law] [--step 2e-5] [--repeats 5]

Prints the differences from MoorDyn with steps (dtM [s]) inside, as CSV; `--write` also writes tests/reference/moordyn_*.csv.
`--cost` times the drop instead. `--law` compares the stored series with the chain of tests/grounds.py with MoorDyn's law; it
needs no MoorDyn.

60 m of tether (4 mm of Dyneema), 20 segments, friction 0.5, no drag; slack segments have damping but no stiffness, as in
MoorDyn, whose air is that of `in_moordyn.py`. Scenes:

    fall   straight between two ends 6 m above the ground, which approach by 5 m each in 2 s: it falls and comes to rest
    lift   lying straight; one end is lifted by 20 m in 4 s and then moves away in 4 s, the other stays
    drag   lying straight, one end free; the other is dragged along at 0.5 m/s, from rest in 1 s

Laws of MoorDyn 2 (source/Line.cpp), node with the depth d below the bottom, its diameter times length A, speeds v_z, v_t:

    N = A (kBot d - cBot v_z)           where d > 0, also where it is negative: the bottom pulls
    F = mu FricDamp v_t, if that is at most mu |N|, else mu |N|      (StatDynFricScale 1)

kBot and cBot are chosen so that it lies 2 mm deep and is critically damped there, FricDamp so that an inner node slides with
all its friction from 0.2 mm/s on. So at rest nothing differs. In motion the damper does, which acts in full at d = 0 already
and pulls at what leaves, and with it the friction of nodes that bounce; below 0.2 mm/s friction, too. How much that matters
is seen from MoorDyn itself, with cBot or FricDamp half as large. Tensions are those of the segments at the ends a and b.
"""

import sys
from functools import partial
from itertools import pairwise
from time import process_time

import numpy as np
from as_script import REFERENCE, options, print_csv
from in_moordyn import AIR, EVERY, FINE, NO_SPRING, MoorDyn, print_errors, raced, ramp, sizes, write
from scipy.integrate import solve_ivp

from grounds import Chain, G
from tetherfmu import Ground, Solver, Tether, TetherDynamic
from tetherfmu.study.measuring.tables import circumstances

DEPTH = 100.0  # of MoorDyn's water [m]
FRICTION, SINK, CREEP = 0.5, 0.002, 2e-4  # -, m, m/s
TETHER = Tether(initial_length=60.0, slack_stiffness_ratio=NO_SPRING, drag_coefficient=0.0)
FOLLOWED = (5, 10, 15)  # nodes
COLUMNS = ("time", "tension_a", "tension_b", "lying", *(f"{axis}{node}" for node in FOLLOWED for axis in "xz"))
MEASURES = ("tension N", "largest N", "lying m", "largest m", "nodes m", "largest m", "tension at the end N")
HEAD = ("scene", "from MoorDyn differs", *MEASURES)


def falling(time):
    way = 5.0 * ramp(time / 2.0)
    return np.array([(way, 0.0, 6.0), (60.03 - way, 0.0, 6.0)])


def lifted(time):
    up, out = ramp(time / 4.0), ramp(time / 4.0 - 1.0)
    return np.array([(0.0, 0.0, 0.0), (60.0 - 12.0 * up**1.5 + 6.5 * out, 0.0, 20.0 * up)])


def dragged(time):
    """The speed grows in 1 s as a parabola 3 s^2 - 2 s^3 of the time."""
    part = np.clip(time, 0.0, 1.0)
    return np.array([(0.0, 0.0, 0.0), (60.0 + 0.5 * (part**3 - 0.5 * part**4 + max(0.0, time - 1.0)), 0.0, 0.0)])


SCENES = {"fall": (falling, 8.0), "lift": (lifted, 9.5), "drag": (dragged, 6.0)}


def row(time, x, tensions):
    """A row of a file: positions of the nodes (n + 1, 3) [m], the ground at 0, and tensions of the segments [N]."""
    low = -x[:, 2]
    deeper, higher = np.maximum(low[:-1], low[1:]), np.minimum(low[:-1], low[1:])
    under = np.where(higher >= 0.0, 1.0, np.where(deeper <= 0.0, 0.0, deeper / np.maximum(deeper - higher, 1e-300)))
    followed = [x[node, axis] for node in FOLLOWED for axis in (0, 2)]
    return [time, tensions[0], tensions[-1], under.sum() * TETHER.initial_length / TETHER.segments, *followed]


def ours(name, step=0.02, tolerance=1e-8, **more):
    """Rows of a scene flown by `TetherDynamic`, every `EVERY` seconds, and the model at the end."""
    path, duration = SCENES[name]
    ground = Ground("flat", ground_friction=FRICTION, ground_sink=SINK)
    solver = Solver(initial_shape=1 if name == "fall" else 3, relative_tolerance=tolerance, **more)
    model = TetherDynamic(TETHER, AIR, solver, ground=ground, free_ends=(name == "drag", False))
    a, b = path(0.0)
    model.initialize(b, ground_position=a)
    rows, every = [row(0.0, model.positions, model.segment_tensions)], round(EVERY / step)
    for k in range(round(duration / step)):
        (a, b), (u, v) = path(k * step), (path(k * step + 1e-4) - path(k * step - 1e-4)) / 2e-4
        model.step(step, b, v, a, u)
        if (k + 1) % every == 0:
            rows.append(row((k + 1) * step, model.positions, model.segment_tensions))
    return np.array(rows), model


def row_of(time, lines):
    """A row of a file from nodes and their velocities."""
    ((x, v),) = lines
    r, rest = np.diff(x, axis=0), TETHER.initial_length / TETHER.segments
    length = np.linalg.norm(r, axis=1)
    rate = np.sum(r * np.diff(v, axis=0), axis=1) / length / rest
    return row(time, x, TETHER.axial_stiffness * np.maximum(length / rest - 1.0, 0.0) + TETHER.axial_damping * rate)


def theirs(name, step, scheme="RK4", every=FINE, creep=CREEP, damper=1.0):
    """Rows of a scene flown by MoorDyn in steps `step` [s] of `scheme`, and the processor time of the steps [s].

    every : communication step [s].  creep : speed [m/s] from which on an inner node has all its friction.
    """
    path, duration = SCENES[name]
    weight, first = TETHER.mass_per_length * AIR.gravity, int(name == "drag")  # end a is free there
    ground = {
        "kBot": weight / SINK / TETHER.diameter,
        "cBot": damper * 2.0 * weight / np.sqrt(AIR.gravity * SINK) / TETHER.diameter,
        "FrictionCoefficient": FRICTION,
        "FricDamp": weight * TETHER.initial_length / TETHER.segments / creep,
        "StatDynFricScale": 1,
        "threshIC": 1e-6,
    }
    points = [(kind, 0.0, place) for kind, place in zip(("Free" if first else "Coupled", "Coupled"), path(0.0), strict=True)]
    lines = [(1, 2, TETHER.initial_length, TETHER.segments)]
    system = MoorDyn(TETHER, points, lines, lambda time: path(time)[first:], DEPTH, step, scheme, **ground)
    return system.fly(row_of, duration, every)


def differences(name, what, found, right):
    """Line of the table: root mean square and largest difference of tensions, lying length and nodes."""
    gap = found - right
    print_errors(name, what, errors=[*sizes(gap[:, 1:3], gap[:, 3], gap[:, 4:]), np.abs(gap[-1, 1:3]).max()])


def compare(step, keep):
    """Table of differences from MoorDyn with the largest step that is converged; `keep` writes its series."""
    print_csv(*HEAD)
    for name in SCENES:
        right, _ = theirs(name, step)
        if keep:
            write(name, COLUMNS, right)
        differences(name, "TetherDynamic", ours(name, FINE)[0], right)
        differences(name, "TetherDynamic, steps of 20 ms, default tolerance", ours(name, 0.02, 0.0)[0], right)
        differences(name, "MoorDyn, dtM twice as long", theirs(name, 2.0 * step)[0], right)
        differences(name, "MoorDyn, cBot half as large", theirs(name, 2.0 * step, damper=0.5)[0], right)
        differences(name, "MoorDyn, FricDamp half as large", theirs(name, 2.0 * step, creep=2.0 * CREEP)[0], right)


class ByItsLaw(Chain):
    """The independent chain on MoorDyn's ground, with driven ends."""

    def __init__(self, name):
        path, _ = SCENES[name]
        start = TetherDynamic(TETHER, AIR, initial_shape=1 if name == "fall" else 3, relative_tolerance=1e-8)
        a, b = path(0.0)
        start.initialize(b, ground_position=a)
        rope = {"stiffness": TETHER.axial_stiffness, "material": TETHER.axial_damping, "slack": 0.0}
        free, place = (name == "drag", False), {"friction": FRICTION, "sink": SINK}
        super().__init__(start.positions, 0.0 * start.positions, TETHER.initial_length, free, **rope, **place)
        self.path = path

    def ground(self, x, v):
        depth, hardness = -x[:, 2], G / self.sink
        pressed = self.mass * (hardness * depth - 2.0 * np.sqrt(hardness) * v[:, 2])
        speed = np.hypot(v[:, 0], v[:, 1])
        slow = self.mass.max() * G * speed / CREEP
        grip = self.friction * np.minimum(np.abs(pressed), slow) / np.maximum(speed, 1e-30)
        force = np.column_stack((-grip * v[:, 0], -grip * v[:, 1], pressed))
        return np.where(depth[:, None] > 0.0, force, 0.0)

    def driven(self, time, state):
        """Positions and velocities of the nodes from a state, the driven ends where they are led."""
        x, v = state.reshape(2, -1, 3).copy()
        places, speeds = self.path(time), (self.path(time + 1e-5) - self.path(time - 1e-5)) / 2e-5
        for end in (-1,) if self.free[0] else (0, -1):
            x[end], v[end] = places[end], speeds[end]
        return x, v

    def rates(self, time, state):
        x, v = self.driven(time, state)
        rates = super().rates(time, np.concatenate((x.ravel(), v.ravel()))).reshape(2, -1, 3)
        for end in (-1,) if self.free[0] else (0, -1):
            rates[0, end] = v[end]
        return rates.ravel()

    def row(self, time, state):
        """Row of a file."""
        x, v = self.driven(time, state)
        return row_of(time, [(x, v)])


def by_its_law(name):
    """Rows of a scene of the chain with MoorDyn's law."""
    chain, times = ByItsLaw(name), EVERY * np.arange(round(SCENES[name][1] / EVERY) + 1)
    near = np.kron(np.eye(chain.n + 1, k=-1) + np.eye(chain.n + 1) + np.eye(chain.n + 1, k=1), np.ones((3, 3)))
    pattern = np.block([[0.0 * near, np.eye(len(near))], [near, near]])
    state = np.concatenate((chain.x.ravel(), chain.v.ravel()))
    rows = [chain.row(0.0, state)]
    for now, then in pairwise(times):
        options = {"rtol": 1e-6, "atol": 1e-8, "max_step": 2e-3, "jac_sparsity": pattern}
        state = solve_ivp(chain.rates, (now, then), state, "BDF", **options).y[:, -1]
        rows.append(chain.row(then, state))
    return np.array(rows)


def explain():
    """Table of differences of the stored series from the chain with MoorDyn's law."""
    print_csv(*HEAD)
    for name in SCENES:
        right = np.genfromtxt(REFERENCE / f"moordyn_{name}.csv", delimiter=",", skip_header=1)
        differences(name, "the chain with its law", by_its_law(name), right)


def timed(name, step, tolerance):
    """As `theirs`, of `TetherDynamic`, with its start."""
    start = process_time()
    rows, _ = ours(name, step, tolerance)
    return rows, process_time() - start


def cost(repeats):
    """Table of errors and times of the drop, steps of 20 ms; each against its own solution with small steps.

    The time of `TetherDynamic` has its start in it, that of MoorDyn not.
    """
    step, name = 0.02, "fall"
    ways = {f"TetherDynamic, tolerance {each:g}": partial(timed, name, step, each) for each in (1e-2, 1e-3, 1e-4, 1e-5)}
    ways |= {
        f"MoorDyn {scheme}, dtM {1e6 * each:.3g} us": partial(theirs, name, each, scheme, step)
        for scheme, each in (("RK2", 8e-5), ("RK2", 0.02 / 300), ("RK2", 4e-5), ("RK4", 1e-4), ("RK4", 5e-5))
    }
    right = {True: ours(name, step)[0], False: theirs(name, 1e-5, every=step)[0]}
    rows, times = raced(ways, repeats)
    default = times["TetherDynamic, tolerance 0.0001"]
    print_csv("solver", "error of tensions N", "of nodes mm", "ms per simulated second", "ratio")
    for way, time in times.items():
        gap = rows[way] - right[way.startswith("Tether")]
        tension, _, nodes, _ = sizes(gap[:, 1:3], gap[:, 4:])
        per_second = 1e3 * time / SCENES[name][1]
        print_csv(way, f"{tension:.2g}", f"{1e3 * nodes:.2g}", f"{per_second:.3g}", f"{time / default:.3g}")


def main():
    """Print the tables."""
    given = options(__doc__, write=False, cost=False, law=False, step=2e-5, repeats=5)
    print(circumstances(), file=sys.stderr)
    if given.law:
        explain()
    elif given.cost:
        cost(given.repeats)
    else:
        compare(given.step, given.write)


if __name__ == "__main__":
    main()
