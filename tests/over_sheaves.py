"""Scenes of ropes over sheaves, for adaptive and for fixed steps, and closed forms of what moves in them."""

import numpy as np

from solvers import ADAPTIVE
from tetherfmu import Environment, Line, Point, Tether, TetherSystem, Winch

G, DENSITY, DIAMETER = 9.81, 1.0, 0.01  # [m/s2], of the rope [kg/m], [m]
HEAVY = {"diameter": DIAMETER, "mass_per_length": DENSITY, "axial_stiffness": 1e7, "axial_damping": 1e4}
LIGHT = {"diameter": DIAMETER, "mass_per_length": 0.2, "axial_stiffness": 1e5, "axial_damping": 100.0}
STIFF = {"diameter": 0.012, "mass_per_length": 0.57, "axial_stiffness": 1e7, "axial_damping": 1e5}
WIRE = {"diameter": 0.01, "mass_per_length": 0.4, "axial_stiffness": 1e7, "axial_damping": 1e5}
SOFT = {"diameter": DIAMETER, "mass_per_length": 0.3, "axial_stiffness": 2e4, "axial_damping": 200.0}


def rope(length, segments=6, drag=0.0, **of_rope):
    """Rope of a length [m]."""
    return Tether(segments=segments, initial_length=length, drag_coefficient=drag, **of_rope)


class Atwood:
    """Two masses [kg] on a heavy rope, 10 m on either side of a sheave, the second one on 4 m of chain [kg/m] or on none.

    Closed form of its motion at a time [s], where `right` hangs on `tail` m of rope on the second side, which may be lost:
    (m1 + right + mu (side + tail) + J/r2) a = (right - m1 + mu (tail - side)) g, so the payout is a hyperbolic cosine.
    """

    side, of_chain = 10.0, 4.0

    def __init__(self, sheave_mass=0.0, m1=20.0, m2=30.0, of_rope=HEAVY, chain=0.0):
        self.sheave_mass, self.m1, self.m2, self.of_rope, self.chain = sheave_mass, m1, m2, of_rope, chain
        self.density, self.beyond = of_rope["mass_per_length"], self.of_chain if chain else 0.0
        self.right, self.tail = m2 + chain * self.beyond, self.side - self.beyond

    def system(self, solver=ADAPTIVE, **more):
        """The system, stretched by its weights, started.  more : about its rope."""
        of_rope, above = {**self.of_rope, **more}, self.side - self.beyond
        first = (self.m1 + 0.5 * self.density * self.side) * self.side  # stretch times EA/g
        second = (self.m2 + self.chain * self.beyond + 0.5 * self.density * above) * above
        second += (self.m2 + 0.5 * self.chain * self.beyond) * self.beyond
        low_a, low_b = (-self.side - each * G / of_rope["axial_stiffness"] for each in (first, second))
        points = [Point("a", (0.0, 0.0, low_a), mass=self.m1), Point("s", (0.0, 0.0, 0.0))]
        points.append(Point("b", (0.0, 0.0, low_b), mass=self.m2))
        tethers = [rope(2.0 * self.side - self.beyond, 6 if self.chain else 10, **of_rope)]
        if self.chain:
            tethers.append(rope(self.beyond, 3, **{**of_rope, "mass_per_length": self.chain}))
        sheave = {"through": ["s"], "initial_portions": [self.side] * 2, "sheave_mass": self.sheave_mass}
        system = TetherSystem(points, [Line("rope", "a", "b", tuple(tethers), **sheave)], solver=solver)
        system.initialize()
        return system

    def gains(self):
        """Rate of the hyperbolic functions [1/s] and acceleration at the start [m/s2]."""
        whole = self.m1 + self.right + self.density * (self.side + self.tail) + self.sheave_mass
        first = (self.right - self.m1 + self.density * (self.tail - self.side)) * G / whole
        return np.sqrt(2.0 * self.density * G / whole), first

    def payout(self, time):
        """Rope that has passed [m]."""
        rate, first = self.gains()
        return first / rate**2 * (np.cosh(rate * time) - 1.0)

    def speed(self, time):
        """Its rate [m/s]."""
        rate, first = self.gains()
        return first / rate * np.sinh(rate * time)

    def tensions(self, time):
        """Tensions on both sides of the sheave, and at the second mass [N]."""
        (rate, first), payout = self.gains(), self.payout(time)
        gained = first * np.cosh(rate * time)
        behind = (self.m1 + self.density * (self.side - payout)) * (G + gained)
        ahead = (self.right + self.density * (self.tail + payout)) * (G - gained)
        return behind, ahead, self.m2 * (G - gained)


def corner(load, friction=0.0, efficiency=1.0, solver=ADAPTIVE):
    """A rope around a right angle without gravity, drawn at with 100 N at its start and with a load [N] at its end."""
    points = [
        Point("a", (-5.0 * (1.0 + 100.0 / 1e5), 0.0, 0.0), mass=10.0),
        Point("s", (0.0, 0.0, 0.0)),
        Point("b", (0.0, 0.0, -5.0 * (1.0 + load / 1e5)), mass=10.0),
    ]
    sheave = {"sheave_friction": friction, "sheave_efficiency": efficiency, "initial_portions": [5.0, 5.0]}
    lines = [Line("rope", "a", "b", rope(10.0, **LIGHT), through=["s"], **sheave)]
    system = TetherSystem(points, lines, Environment(gravity=0.0), solver)
    system.initialize(loads={"a": (-100.0, 0.0, 0.0), "b": (0.0, 0.0, -load)})
    return system


def slips_at(solver=ADAPTIVE):
    """Load [N] at which the rope of a `corner` with friction 0.3 first runs, while it grows by 0.1 N each 50 ms."""
    ratio = np.exp(0.3 * np.pi / 2.0)
    system = corner(100.0 * (ratio - 0.02), friction=0.3, solver=solver)
    for k in range(60):
        load = 100.0 * (ratio - 0.02 + 0.001 * k)
        if system.step(0.05, loads={"b": (0.0, 0.0, -load)}).portions["rope"].payout[0] != 0.0:
            return load
    return None


def flown_held(through, solver=ADAPTIVE, segments=6, others=()):
    """Nodes and forces of a mass between two points, in wind, with a winch; on one line over a sheave, or on two.

    segments : of the rope on each side.  others : tethers in series beyond it.
    """
    points = [Point("a", (-7.0, 0.0, 0.0)), Point("s", mass=40.0), Point("b", (7.0, 0.0, 0.3))]
    of_rope, beyond = {**LIGHT, "axial_damping": 300.0, "drag": 1.0}, sum(each.initial_length for each in others)
    if through:
        sheave = {"through": ["s"], "initial_portions": [10.0, 10.0], "sheave_friction": 5.0}
        lines = [Line("one", "a", "b", (rope(20.0 - beyond, segments, **of_rope), *others), **sheave)]
    else:
        lines = [Line("one", "a", "s", rope(10.0, segments, **of_rope))]
        lines.append(Line("two", "s", "b", (rope(10.0 - beyond, segments, **of_rope), *others)))
    system = TetherSystem(points, lines, solver=solver)
    system.initialize((8.0, 1.0, 0.0))
    found = []
    for k in range(50):
        load, speed = (10.0 * np.sin(0.1 * k), 5.0, 0.0), 0.3 * np.sin(0.05 * k)
        moved = {"positions": {"b": (7.0 + 0.002 * k, 0.0, 0.3)}, "velocities": {"b": (0.1, 0.0, 0.0)}}
        outputs = system.step(0.02, **moved, loads={"s": load}, reel_out_speeds={"one": speed})
        nodes = list(system.positions.values())
        nodes = nodes[0] if through else np.vstack([nodes[0], nodes[1][1:]])
        found.append(np.concatenate([nodes.ravel(), *(outputs.points[name].force for name in "asb")]))
    return np.array(found)


def hanging_pulley(solver=ADAPTIVE):
    """A pulley of 50 kg that hangs in equilibrium in a rope of almost no weight: the system, and its first outputs."""
    of_rope = {"diameter": 0.005, "mass_per_length": 1e-4, "axial_stiffness": 1e6, "axial_damping": 1e3}
    points = [Point("a", (0.0, 0.0, 0.0)), Point("pulley", mass=50.0), Point("b", (8.0, 0.0, 1.0))]
    line = Line("rope", "a", "b", rope(12.0, 4, **of_rope), through=["pulley"])
    system = TetherSystem(points, [line], solver=solver)
    return system, system.initialize()


def hoisted(falls, solver=ADAPTIVE):
    """A block of 2 t on 2 or 4 falls of 20 m that a winch hauls in for 3 s: first and last outputs, speeds."""
    points = [Point("winch", (0.0, 0.0, 30.0)), Point("anchor", (1.0, 0.0, 30.0)), Point("block", mass=2000.0)]
    through = ["block"]
    if falls == 4:
        points.append(Point("crown", (0.5, 0.0, 30.0)))
        through = ["block", "crown", "block"]
    line = Line("hoist", "winch", "anchor", rope(20.0 * falls, **STIFF), through=through)
    system = TetherSystem(points, [line], solver=solver)
    start = system.initialize()
    for k in range(150):
        outputs = system.step(0.02, reel_out_speeds={"hoist": -0.5 * min(1.0, 0.02 * k)})
    return start, outputs


def block_system(solver=ADAPTIVE):
    """Two masses, of which the heavier one draws the rope over a sheave until the portion of the other one is at its end."""
    points = [Point("a", (0.0, 0.0, -1.0), mass=20.0), Point("s", (0.0, 0.0, 0.0)), Point("b", (0.0, 0.0, -4.0), mass=60.0)]
    tether = rope(5.0, 5, **LIGHT, slack_damping_ratio=0.1)
    line = Line("rope", "a", "b", tether, through=["s"], initial_portions=[1.0, 4.0])
    system = TetherSystem(points, [line], solver=solver)
    system.initialize()
    return system


def moving(velocity, solver=ADAPTIVE):
    """Tensions and lengths of a rope over a hanging pulley with friction, seen from a frame of this velocity [m/s]."""
    velocity = np.array(velocity)
    ends = {"a": np.array((-6.0, 0.0, 0.0)), "b": np.array((7.0, 0.0, 1.0))}
    points = [Point(name, place, velocity) for name, place in ends.items()]
    points.append(Point("pulley", velocity=velocity, mass=40.0))
    line = Line("rope", "a", "b", rope(20.0, 5, **LIGHT), through=["pulley"], sheave_mass=0.5, sheave_friction=0.01)
    system = TetherSystem(points, [line], solver=solver)
    system.initialize()
    found = []
    for k in range(50):
        places = {name: place + 0.02 * k * velocity for name, place in ends.items()}
        own = system.step(0.02, places, reel_out_speeds={"rope": 0.5 * np.sin(0.1 * k)}).portions["rope"]
        found.append(np.concatenate([own.tension_from, own.tension_to, own.length, own.speed]))
    return np.array(found)


def driven(sheave_mass, solver, winch=None, others=()):
    """A rope over a driven sheave, whose one end hangs, started.  others : tethers in series at its end."""
    points = [Point("a", (-6.0, 0.0, 0.0)), Point("s", (0.0, 0.0, 4.0)), Point("b", (2.0, 0.0, -6.0), mass=10.0)]
    wire = rope(20.0 - sum(each.initial_length for each in others), 5, drag=1.0, **SOFT)
    sheave = {"initial_portions": [7.5, 12.5], "sheave_mass": sheave_mass, "winch": winch or Winch()}
    system = TetherSystem(points, [Line("rope", "a", "b", (wire, *others), through=["s"], **sheave)], solver=solver)
    system.initialize(winch_forces={"rope": 90.0} if winch else None)
    return system


def reeved(solver=ADAPTIVE):
    """Nodes, payouts and tensions after 1 s of a load on two falls, which is pushed and hauled in, without jumps.

    The rope runs from its winch over a heavy sheave, which is driven, and over that of the load.
    """
    points = [Point("winch", (-8.0, 0.0, 0.0)), Point("head", (0.0, 0.0, 6.0)), Point("load", mass=60.0)]
    points.append(Point("anchor", (3.0, 0.0, 6.0)))
    of_rope = {**SOFT, "axial_damping": 400.0, "drag": 1.0}
    line = Line("rope", "winch", "anchor", rope(28.0, 4, **of_rope), through=["head", "load"], sheave_mass=[8.0, 1.0])
    system = TetherSystem(points, [line], solver=solver)
    system.initialize((8.0, 1.0, 0.0))
    for time in 0.02 * np.arange(50):
        more = time**3 / (1.0 + time * time)  # begins without velocity and acceleration
        loads, speeds = {"load": (30.0 * more, 40.0 * more, 0.0)}, {"rope": -0.8 * more}
        outputs = system.step(0.02, reel_out_speeds=speeds, loads=loads)
    found = outputs.portions["rope"]
    return np.concatenate([*map(np.ravel, system.positions.values()), found.payout]), np.concatenate(
        [found.tension_from, found.tension_to]
    )
