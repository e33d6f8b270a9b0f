"""A kite has landed and its tether lies on the grass: what does the ground carry, and how hard is it to drag them away?

    python examples/ground/landing.py

60 m of tether on a flat ground (`ground_contact` = flat) with the friction coefficient mu. Twice a kite comes down in light
cross wind. The first one follows a path (`TetherDynamic`), then somebody takes it, unhooks the tether at the winch and walks
away with it. The second one is a mass that lands by itself (`TetherDynamicFree`), then the winch reels in kite and tether.

    at rest        carried by the ground = weight of the tether - what hangs at both ends (half a segment each)
    walking        pull at the kite      = mu weight of the tether without the half segment that is in the hand
    reeling in     pull at the winch     = mu (weight of the kite + of the tether without the half segment at the winch)
"""

import sys
from pathlib import Path

import numpy as np

from tetherfmu import Ground, MovingEnd, Tether, TetherDynamic, TetherDynamicFree, inputs_along
from tetherfmu.console.colours import BLACK, BLUE, GREY, ORANGE
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms
from shared.ropes import NO_PUSH

FRICTION, LENGTH, SEGMENTS, STEP, GRAVITY = 0.5, 60.0, 30, 0.02, 9.81  # -, m, -, s, m/s2
ABOVE, AT_LANDING, LANDED = (45.0, 0.0, 30.0), (57.0, 0.0, 0.0), 15.0  # kite [m], [m], after a time [s]
SETTLED, WALK, SPEED, SPEED_UP = 20.0, 20.0, 1.0, 4.0  # until [s], for [s], at [m/s], which is reached within [s]
MASS, SINKING, GRIP, REELING, REEL_TIME = 3.0, 1.6, 15.0, 0.5, 40.0  # kite [kg], [m/s], of its flight control [N s/m], ...
WIND = (0.0, 1.5, 0.0)  # [m/s]
GROUND = Ground(ground_contact="flat", ground_friction=FRICTION)
TETHER = Tether(initial_length=LENGTH, segments=SEGMENTS, **NO_PUSH)
WEIGHT = TETHER.mass_per_length * LENGTH * GRAVITY  # of the tether [N]


def ramp(u):
    """A smooth step from 0 to 1 for u from 0 to 1."""
    u = np.clip(u, 0.0, 1.0)
    return u**3 * (u * (6.0 * u - 15.0) + 10.0)


def descent(t):
    """Position of the kite that follows a path [m]."""
    return np.add(ABOVE, ramp(t / LANDED) * np.subtract(AT_LANDING, ABOVE))


def walk(t):
    """Position of the kite [m] in the hand of somebody who walks away, along x."""
    way = SPEED * (t - 0.5 * SPEED_UP if t > SPEED_UP else 0.5 * t**2 / SPEED_UP)
    return np.add(AT_LANDING, (way, 0.0, 0.0))


def land():
    """A kite on its path comes down and the tether lies down: the tether as it is then, and the flight, a `Flown`."""
    tether = TetherDynamic(TETHER, ground=GROUND)
    tether.initialize(ABOVE, wind_velocity=WIND)
    return tether, tether.fly(inputs_along(round(SETTLED / STEP), STEP, MovingEnd(descent), wind_velocity=WIND), STEP)


def carried(flown):
    """Weight that the ground carries at rest after a flight [N]: what both ends do not."""
    return WEIGHT + flown.kite_force[-1, 2] + flown.ground_force[-1, 2]


def drag(lying):
    """Walk away with the kite end of a tether that lies on the ground; the `Flown`."""
    tether = TetherDynamic(TETHER, ground=GROUND, free_ends=(True, False))
    tether.initialize(positions=lying.positions, velocities=lying.velocities, wind_velocity=WIND)
    return tether.fly(inputs_along(round(WALK / STEP), STEP, MovingEnd(walk), wind_velocity=WIND), STEP)


def land_freely():
    """A kite lands by itself and is reeled in; after each step: time [s], height [m], tension at the winch [N], length [m].

    Its control carries it and lets it sink along the way to `AT_LANDING`, until it touches the ground.
    """
    tether = TetherDynamicFree(TETHER, ground=GROUND, kite_mass=MASS)
    found, rows = tether.initialize(ABOVE, wind_velocity=WIND), []
    glide = SINKING / ABOVE[2] * np.subtract(AT_LANDING, ABOVE)
    for t in STEP * np.arange(round((SETTLED + REEL_TIME) / STEP)):
        control = (0.0, 0.0, MASS * GRAVITY) + GRIP * (glide * ramp(t / 3.0) - found.kite_velocity)
        load = control if found.kite_position[2] > 0.0 else np.zeros(3)
        found = tether.step(STEP, kite_load=load, reel_out_speed=-REELING * ramp((t - SETTLED) / SPEED_UP))
        rows.append((t + STEP, found.kite_position[2], found.ground_tension, found.tether_length))
    return np.transpose(rows)


def expected_of_walk():
    """Pull of the tether that slides behind somebody [N]."""
    return FRICTION * WEIGHT * (1.0 - 0.5 / SEGMENTS)


def expected_of_reeling(length):
    """Pull at the winch that drags kite and tether [N], with so much tether paid out [m]."""
    return FRICTION * (MASS * GRAVITY + WEIGHT * length / LENGTH * (1.0 - 0.5 / SEGMENTS))


def draw(landed, walked, reeled):
    """Side view of the landing, and both pulls over time beside their formulas; the figure."""
    from shared.flight_figures import draw_ground, plt

    figure, (side, pull, winch) = plt.subplots(3, 1, figsize=(9.0, 9.0), layout="constrained", height_ratios=(3, 2, 2))
    for t in np.arange(0.0, LANDED + 1.0, 3.0):
        row = min(round(t / STEP), len(landed.positions) - 1)
        x, _, z = landed.positions[row].T
        side.plot(x, z, color=BLUE, alpha=0.3 + 0.7 * t / LANDED, marker="o", markersize=2)
        below = -14 if z[-1] <= 0.0 else 2
        side.annotate(f"{t:.0f} s", (x[-1], z[-1]), (5, below), textcoords="offset points")
    draw_ground(side, GROUND.ground_height)
    side.set_ylim(bottom=-3.0)
    side.set(title="The tether lies down while the kite lands", xlabel="x [m]", ylabel="height [m]", aspect="equal")
    side.legend(loc="upper left")
    pull.plot(STEP * np.arange(1, len(walked.kite_force) + 1), np.linalg.norm(walked.kite_force, axis=1), color=BLUE)
    pull.axhline(expected_of_walk(), color=BLACK, linestyle="--", label="friction times weight of the tether")
    pull.set(title="Walking away with it", xlabel="time since the landing [s]", ylabel="pull at the kite [N]")
    time, _, tension, length = reeled
    winch.plot(time, tension, color=ORANGE)
    shown = time > SETTLED
    winch.plot(time[shown], expected_of_reeling(length[shown]), "--", color=BLACK, label="friction times both weights")
    winch.axvspan(0.0, SETTLED, color=GREY, alpha=0.15, label="in flight, then at rest")
    winch.set(title="Reeling in kite and tether", xlabel="time [s]", ylabel="tension at the winch [N]")
    for axes in (pull, winch):
        axes.legend(loc="lower right")
    for axes in (side, pull, winch):
        axes.grid(alpha=0.4)
    return figure


@command
def main(arguments=None):
    """Print weights and pulls beside their formulas, draw them."""
    parser = Parser(description="land a kite, and drag its tether over the ground")
    parser.add_out()
    file = parser.parse_args(arguments).out / "landing.png"
    lying, landed = land()
    walked, reeled = drag(lying), land_freely()
    on_ground, pull = carried(landed), np.linalg.norm(walked.kite_force[-1])
    hanging = WEIGHT / SEGMENTS
    print(f"the ground carries {on_ground:.3f} N of {WEIGHT:.3f} N, by the formula {WEIGHT - hanging:.3f} N")
    print(f"walking away takes {pull:.2f} N, by the formula {expected_of_walk():.2f} N")
    print(f"reeling in takes {reeled[2, -1]:.2f} N, by the formula {expected_of_reeling(reeled[3, -1]):.2f} N")
    figure = draw(landed, walked, reeled)
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, dpi=150)
    print(file)


if __name__ == "__main__":
    sys.exit(main())
