"""In which ways can a mass on tethers be flown in communication steps? Helper of the examples.

A `Scene` is flown with the tethers of the Python API, one model for each leg. Where the kite end is
driven, the mass is moved here, by the forces that the tethers give; where it is free, the first leg carries the mass and
gets the forces of the other legs, and the load, as its `kite_load`. In each communication step from t to t + h:

parallel                   mass and tethers go at once: the mass holds the forces of t over the step
parallel, linear           the same; the forces on the mass go on linearly from their last two values
sequential                 the tethers go first: the mass holds their forces of t + h
sequential, linear         the tethers go first: the forces on the mass go linearly from those of t to those of t + h
two iterations             the same; then the tethers go back to t and once more to t + h, with their end led to where the
                           mass has come, and so does the mass
free end, held             the first leg moves the mass; load and other forces are held at those of t
free end, linear           the same; they go on linearly from their last two values
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from tetherfmu import TetherDynamic, TetherDynamicFree
from tetherfmu.runtime.parameters import Environment, Tether

UP = np.array([0.0, 0.0, 1.0])


class Leg(NamedTuple):
    """A tether from a fixed anchor [m] to the mass, which reels out at a constant speed [m/s]."""

    tether: Tether
    anchor: tuple = (0.0, 0.0, 0.0)
    reel_out_speed: float = 0.0


class Scene(NamedTuple):
    """A point mass on its legs, at rest at the start."""

    legs: tuple  # of Leg
    mass: float  # [kg], beside the half segments that end at it
    position: np.ndarray  # (3,) [m], at the start
    load: Callable  # position, velocity of the mass -> force [N] on it, beside weight and tethers
    wind: np.ndarray  # (3,) [m/s]
    duration: float  # [s]
    environment: Environment = Environment()  # uniform wind and air


class Flown(NamedTuple):
    """What a way gave: a row for each communication point, the first at the start."""

    forces: np.ndarray  # (rows, legs, 3), of each leg on the mass [N]
    positions: np.ndarray  # (rows, 3), of the mass [m]


class Mass:
    """A point mass that is moved by the forces of tethers; they bring half a segment each, whose weight they contain."""

    def __init__(self, scene):
        self.position, self.velocity = np.asarray(scene.position, dtype=float), np.zeros(3)
        self.scene, self.weight = scene, -scene.mass * scene.environment.gravity * UP

    def inertia(self, outputs):
        """Mass that the forces of the tethers move [kg]: with half a segment of each."""
        return self.scene.mass + sum(each.kite_end_mass for each in outputs)

    def after(self, h, first, last, mass):
        """Position [m] and velocity [m/s] after a step in which the force of the tethers goes from `first` to `last` [N].

        One step of the classical Runge-Kutta method; mass : `inertia` [kg].
        """

        def slope(part, x, v):
            force = self.scene.load(x, v) + (1.0 - part) * first + part * last
            return v, (force + self.weight) / mass

        x, v = self.position, self.velocity
        v1, a1 = slope(0.0, x, v)
        v2, a2 = slope(0.5, x + 0.5 * h * v1, v + 0.5 * h * a1)
        v3, a3 = slope(0.5, x + 0.5 * h * v2, v + 0.5 * h * a2)
        v4, a4 = slope(1.0, x + h * v3, v + h * a3)
        return x + h / 6.0 * (v1 + 2.0 * (v2 + v3) + v4), v + h / 6.0 * (a1 + 2.0 * (a2 + a3) + a4)


def inputs_towards(position, velocity, last_velocity, last_step, h):
    """Kite position and velocity to give to a tether so that its end gets to this position [m] and velocity [m/s].

    A tether moves its end to p + v h + a h^2/2 and v + a h, a = (v - v_last)/h_last (docs/models/theory.md, "Driven ends"):
    solved for p and v.  last_velocity, last_step : v_last [m/s] and h_last [s], 0 before the first step.  ValueError for a
    step that is shorter than the last one, in which the tether makes a difference good in part, or more than four times as
    long.
    """
    if last_step and not 0.999999 * last_step <= h <= 4.0 * last_step:
        raise ValueError(f"h is {h} s; it must be at least the last step ({last_step} s), and at most four times it")
    ratio = h / last_step if last_step else 0.0
    v = (velocity + ratio * last_velocity) / (1.0 + ratio)
    return position - h * v - 0.5 * h * ratio * (v - last_velocity), v


def started(scene, **solver):
    """Tethers with driven ends, and their outputs, at the start of a scene."""
    tethers = [TetherDynamic(leg.tether, scene.environment, **solver) for leg in scene.legs]
    return tethers, [
        tether.initialize(scene.position, ground_position=leg.anchor, wind_velocity=scene.wind)
        for tether, leg in zip(tethers, scene.legs, strict=True)
    ]


def total(outputs):
    """Sum of the forces of tethers on the mass [N]."""
    return np.sum([each.kite_force for each in outputs], axis=0)


def memory_at_start(outputs):
    """What `step_driven` remembers, before the first step."""
    return [np.zeros(3), 0.0, total(outputs)]


def advanced(scene, tethers, h, motion):
    """Outputs of tethers with driven ends after a step [s], the mass at a position and velocity at its start."""
    return [
        tether.step(h, *motion, reel_out_speed=leg.reel_out_speed) for tether, leg in zip(tethers, scene.legs, strict=True)
    ]


FORCES = {  # on the mass at the start and at the end of a step, by those of the tethers a step earlier, before, after it
    "parallel": lambda _, before, after: (before, before),
    "parallel, linear": lambda earlier, before, after: (before, before + (before - earlier)),
    "sequential": lambda _, before, after: (after, after),
    "sequential, linear": lambda _, before, after: (before, after),
    "two iterations": lambda _, before, after: (before, after),
}
DRIVEN = tuple(FORCES)
FREE = {"free end, held": "held", "free end, linear": "linear"}
WAYS = (*DRIVEN, *FREE)


def step_driven(way, scene, tethers, mass, outputs, memory, h):
    """One communication step [s] with driven ends; outputs at its end. `mass` and `memory` are modified.

    memory : velocity [m/s] and step [s] that the tethers got last, force [N] at the start of that step.
    """
    given, states = (mass.position, mass.velocity), [tether.get_state() for tether in tethers]
    later, inertia = advanced(scene, tethers, h, given), mass.inertia(outputs)
    before, after = total(outputs), total(later)
    motion = mass.after(h, *FORCES[way](memory[2], before, after), inertia)
    if way == "two iterations":
        for tether, state in zip(tethers, states, strict=True):
            tether.set_state(state)
        given = inputs_towards(*motion, *memory[:2], h)
        later = advanced(scene, tethers, h, given)
        motion = mass.after(h, before, total(later), inertia)
    mass.position, mass.velocity = motion
    memory[:] = given[1], h, before
    return later


def fly_driven(way, scene, h, **solver):
    """`Flown` of a scene with driven ends in communication steps h [s]."""
    (tethers, outputs), mass = started(scene, **solver), Mass(scene)
    memory = memory_at_start(outputs)
    forces, positions = [[each.kite_force for each in outputs]], [mass.position]
    for _ in range(round(scene.duration / h)):
        outputs = step_driven(way, scene, tethers, mass, outputs, memory, h)
        forces.append([each.kite_force for each in outputs])
        positions.append(mass.position)
    return Flown(np.array(forces), np.array(positions))


def fly_free(continuation, scene, h, **solver):
    """`Flown` of a scene whose first leg moves the mass, in communication steps h [s].

    The half segments of the other legs move with the mass; their weight is in the forces already.
    """
    first, *others = scene.legs
    rest = scene._replace(legs=tuple(others))
    tethers, outputs = started(rest, **solver)
    carried = sum(each.kite_end_mass for each in outputs)
    free = TetherDynamicFree(
        first.tether, scene.environment, kite_mass=scene.mass + carried, input_continuation=continuation, **solver
    )
    mine = free.initialize(scene.position, ground_position=first.anchor, wind_velocity=scene.wind)
    forces, positions = [[each.kite_force for each in (mine, *outputs)]], [scene.position]
    for _ in range(round(scene.duration / h)):
        motion = mine.kite_position, mine.kite_velocity
        load = scene.load(*motion) + total(outputs) + carried * scene.environment.gravity * UP
        mine = free.step(h, load, reel_out_speed=first.reel_out_speed)
        outputs = advanced(rest, tethers, h, motion)
        forces.append([each.kite_force for each in (mine, *outputs)])
        positions.append(mine.kite_position)
    return Flown(np.array(forces), np.array(positions))


def fly(way, scene, h, **solver):
    """`Flown` of a scene by one of the `WAYS` in communication steps h [s]; ValueError if a tether refuses a step."""
    if way in FREE:
        return fly_free(FREE[way], scene, h, **solver)
    return fly_driven(way, scene, h, **solver)


def force_error(flown, exact, h, times):
    """Root mean square of the error of the forces on the mass at times [s], relative to that of the exact forces [-]."""
    found = flown.forces[np.rint(times / h).astype(int)]
    return float(np.sqrt(np.mean((found - exact) ** 2) / np.mean(exact**2)))
