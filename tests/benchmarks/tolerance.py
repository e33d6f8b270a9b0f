"""What does the tolerance of the solver do to the forces, beside segments and communication steps? Printed as tables.

    python tests/benchmarks/tolerance.py --scenes 300

Random scenes of 10 s: kites on all flights of the study, loads on cranes, tethered drones, kites and loads on ships,
tethers that snap taut; and loads that bounce, apart. Error: root mean square of the difference of the forces at both ends
over that of the forces, after each communication step of 20 ms; of a tolerance against 1e-9, also where slack segments do
not push (`slack_stiffness_ratio` 0; this reference then against 1e-10), of the segments and of the communication step, at
1e-9, against twice as many segments and half the step. 300 scenes take some minutes of one core.
"""

from itertools import cycle, islice

import numpy as np
import pandas as pd
from as_script import options

from advice.random_scenes import random_scenes
from tetherfmu import MovingEnd, TetherDynamic, TetherDynamicFree, inputs_along, tether_of
from tetherfmu.records.problems import StepRefused
from tetherfmu.runtime.inputs import by_name
from tetherfmu.study.measuring.runs import UNWARNED, catch_warnings
from tetherfmu.study.measuring.tables import circumstances, markdown

STEP, DURATION = 0.02, 10.0  # [s]
TOLERANCES, REFERENCE, DEFAULT = (1e-3, 1e-4, 1e-5), 1e-9, 1e-4
TOLERANCES_OF_ROPE, FINER = (1e-4, 1e-6), 1e-10  # where slack segments do not push; for the reference itself
SEGMENTS = (5, 10, 20)
GRAVITY = 9.81


def kite(random):
    """A kite on a path: any kind of flight of the study."""
    scene = random_scenes(int(random.integers(1, 50)), int(random.integers(1 << 30)))[-1]
    first = by_name(scene.inputs(scene.every)[0])
    names = ("kite_position", "kite_velocity", "ground_position", "ground_velocity", "wind_velocity")
    start = {name: first[name] for name in names} | {"reel_out_speed": first["reel_out_speed"].item()}
    model = lambda **solver: TetherDynamic(scene.tether, scene.environment, initial_shape="quasi_steady", **solver)  # noqa: E731
    return model, start, lambda step, duration=DURATION: scene.inputs(step)[: round(duration / step)]


def hanging(random, tip):
    """A load of 100 kg to 5 t on a steel wire below a tip that moves along a path; held at first."""
    wire = tether_of("steel", random.uniform(0.010, 0.025), initial_length=random.uniform(10.0, 100.0))
    mass = random.uniform(0.02, 0.2) * wire.axial_stiffness * 0.003 / GRAVITY + 100.0
    stretch = mass * GRAVITY / wire.axial_stiffness
    position = np.subtract(tip(0.0), (0.0, 0.0, wire.initial_length * (1.0 + stretch)))
    model = lambda **solver: TetherDynamicFree(wire, kite_mass=mass, **solver)  # noqa: E731
    start = {"kite_position": position, "ground_position": tip(0.0)}
    return model, start, lambda step, duration=DURATION: inputs_along(round(duration / step), step, ground=MovingEnd(tip))


def crane(random):
    """The jib slews."""
    radius, rate, ramp = random.uniform(5.0, 40.0), random.uniform(0.02, 0.1), random.uniform(3.0, 10.0)

    def tip(t):
        angle = rate * (0.5 * t**2 / ramp if t < ramp else t - 0.5 * ramp)
        return radius * np.cos(angle), radius * np.sin(angle), 120.0

    return hanging(random, tip)


def heaving(random, height):
    """Path of a point on a ship in waves."""
    heave, surge, period = random.uniform(0.3, 2.5), random.uniform(0.0, 1.5), random.uniform(5.0, 12.0)
    rate = 2.0 * np.pi / period
    return lambda t: (surge * (1.0 - np.cos(rate * t)), 0.0, height + 0.5 * heave * (1.0 - np.cos(rate * t)))


def ship(random):
    """A load on the crane of a ship, or a kite that pulls it."""
    if random.random() < 0.5:
        return hanging(random, heaving(random, 120.0))
    deck, length, elevation = heaving(random, 20.0), random.uniform(100.0, 400.0), random.uniform(0.4, 1.1)
    mass, pull, diameter = random.uniform(10.0, 80.0), random.uniform(2e3, 3e4), random.uniform(0.006, 0.014)
    tether = tether_of("dyneema_sk75", diameter, initial_length=length)
    direction = np.array((np.cos(elevation), 0.0, np.sin(elevation)))
    position = deck(0.0) + length * (1.0 + pull / tether.axial_stiffness) * direction
    wind, load = (random.uniform(4.0, 14.0), 0.0, 0.0), pull * direction + (0.0, 0.0, mass * GRAVITY)
    start = {"kite_position": position, "ground_position": deck(0.0), "wind_velocity": wind}
    along = {"ground": MovingEnd(deck), "kite_load": load, "wind_velocity": wind}
    model = lambda **solver: TetherDynamicFree(tether, kite_mass=mass, **solver)  # noqa: E731
    return model, start, lambda step, duration=DURATION: inputs_along(round(duration / step), step, **along)


def driven(random, tether, path, ground, wind):
    """A tether whose ends both move along paths."""
    (position, velocity), (place, speed) = MovingEnd(path).at(0.0), MovingEnd(ground).at(0.0)
    start = {"kite_position": position, "kite_velocity": velocity, "ground_position": place, "ground_velocity": speed}
    along = {"kite": MovingEnd(path), "ground": MovingEnd(ground), "wind_velocity": wind}
    model = lambda **solver: TetherDynamic(tether, initial_shape="quasi_steady", **solver)  # noqa: E731
    start["wind_velocity"] = wind
    return model, start, lambda step, duration=DURATION: inputs_along(round(duration / step), step, **along)


def drone(random):
    """A drone that holds its height above a vehicle, with some slack, and sways."""
    height, speed, sway = random.uniform(20.0, 120.0), random.uniform(0.0, 15.0), random.uniform(0.0, 3.0)
    rate, slack = random.uniform(0.3, 1.5), random.uniform(0.01, 0.1)
    tether = tether_of("dyneema_sk75", random.uniform(0.002, 0.006), initial_length=height * (1.0 + slack))
    way = lambda t: speed * (t - 3.0 * (1.0 - np.exp(-t / 3.0)))  # noqa: E731
    path = lambda t: (way(t), sway * np.sin(rate * t), height)  # noqa: E731
    return driven(random, tether, path, lambda t: (way(t), 0.0, 0.0), (random.uniform(-12.0, 12.0), 2.0, 0.0))


def snap(random):
    """A kite that flies in until the tether is slack, and out until it is taut."""
    length, rate = random.uniform(30.0, 300.0), random.uniform(0.5, 3.0)
    inward, outward = random.uniform(0.002, 0.02), random.uniform(0.0005, 0.003)
    direction = np.array((np.cos(0.6), 0.0, np.sin(0.6)))
    mean, amplitude = 1.0 + 0.5 * (outward - inward), 0.5 * (outward + inward)
    path = lambda t: length * (mean - amplitude * np.cos(rate * t)) * direction  # noqa: E731
    tether = tether_of("dyneema_sk75", random.uniform(0.003, 0.010), initial_length=length)
    return driven(random, tether, path, lambda t: (0.0, 0.0, 0.0), (random.uniform(0.0, 12.0), 0.0, 0.0))


def bounce(random):
    """A load that is let go where its tether is slack by up to 3 %, and bounces."""
    length, mass = random.uniform(10.0, 60.0), random.uniform(5.0, 100.0)
    tether = tether_of("dyneema_sk75", random.uniform(0.003, 0.010), initial_length=length)
    position = np.array((0.02 * length, 0.0, 100.0 - length * random.uniform(0.97, 1.0)))
    start = {"kite_position": position, "ground_position": (0.0, 0.0, 100.0)}
    model = lambda **solver: TetherDynamicFree(tether, kite_mass=mass, **solver)  # noqa: E731
    held = {"ground": (0.0, 0.0, 100.0)}
    return model, start, lambda step, duration=DURATION: inputs_along(round(duration / step), step, **held)


KINDS = {"kite": kite, "crane": crane, "drone": drone, "ship": ship, "snap": snap}


def forces(scene, segments, tolerance, step=STEP, **of_rope):
    """Forces at both ends [N] every `STEP`, array (rows, 6), and internal steps for each communication step."""
    model, start, inputs = scene
    with catch_warnings(**UNWARNED):
        tether = model(segments=segments, relative_tolerance=tolerance, **of_rope)
        tether.initialize(**start)
        rows = inputs(step)
        flown = tether.fly(rows, step, every=round(STEP / step), peaks=False)
    steps = sum(tether.counters[name] for name in ("steps", "rejections"))
    return np.hstack([flown.ground_force, flown.kite_force]), steps / len(rows)


def difference(found, right):
    """Root mean square difference over the root mean square of what is right."""
    return np.sqrt(np.mean((found - right) ** 2) / np.mean(right**2))


def measured(kind, number, seed):
    """Errors of one scene by name; None if it is refused."""
    random = np.random.default_rng((seed, number))
    scene, n = (KINDS | {"bounce": bounce})[kind](random), int(random.choice(SEGMENTS))
    try:
        right, _ = forces(scene, n, REFERENCE)
        found = {"scene": number, "kind": kind, "segments": n}
        for tolerance in TOLERANCES:
            each, steps = forces(scene, n, tolerance)
            found[f"tolerance {tolerance:g}"] = difference(each, right)
            if tolerance == DEFAULT:
                found["one step in each"] = steps == 1.0
        slack = forces(scene, n, REFERENCE, slack_stiffness_ratio=0.0)[0]
        for tolerance in TOLERANCES_OF_ROPE:
            each, _ = forces(scene, n, tolerance, slack_stiffness_ratio=0.0)
            found[f"tolerance {tolerance:g}, ratio 0"] = difference(each, slack)
        finer = forces(scene, n, FINER, slack_stiffness_ratio=0.0)[0]
        found[f"tolerance {REFERENCE:g}, ratio 0"] = difference(slack, finer)
        found["segments, n for 2 n"] = difference(right, forces(scene, 2 * n, REFERENCE)[0])
        found["step, 20 ms for 10 ms"] = difference(right, forces(scene, n, REFERENCE, 0.5 * STEP)[0])
    except StepRefused:
        return None
    return found


def summary(found):
    """Quantiles of the errors."""
    columns = [name for name in found if name.startswith(("tolerance", "segments,", "step,"))]
    rows = []
    for name in columns:
        error = 100.0 * found[name]
        quantiles = {f"{part} %": error.quantile(0.01 * part) for part in (50, 90, 95)}
        rows.append(
            {"error of": name, **quantiles, "largest": error.max(), "scenes below 1 % error": 100.0 * (error < 1.0).mean()}
        )
    return pd.DataFrame(rows)


def table(names, count, seed):
    """Errors of so many scenes of these kinds in turn, a row for each that is not refused."""
    kinds = islice(cycle(names), count)
    return pd.DataFrame([each for number, kind in enumerate(kinds) if (each := measured(kind, number, seed))])


def main():
    """Fly the scenes and print the tables."""
    given = options(__doc__, scenes=300, seed=1)
    print(circumstances())
    for names, count in ((KINDS, given.scenes), (("bounce",), given.scenes // 6)):
        found = table(names, count, given.seed)
        print(f"\n{', '.join(names)}: {len(found)} of {count} scenes, the others refused; errors [%]\n")
        print(f"{markdown(summary(found))}\n")
        once = 100.0 * found["one step in each"].mean()
        print(f"The solver takes one step in each of 20 ms in {once:.0f} % of the scenes.")
        kinds = found.drop(columns=["scene", "segments", "one step in each"]).groupby("kind", sort=False).quantile(0.9)
        print(f"\n90 % of the scenes of a kind have a smaller error [%] than\n\n{markdown((100.0 * kinds).reset_index())}")


if __name__ == "__main__":
    main()
