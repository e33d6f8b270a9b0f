"""How does a policy steer a kite on a circle? A policy by hand flies the environment for Gymnasium for a minute.

It prints how well the circle is flown and how fast the environment steps, and draws the circle.

    pip install "tetherfmu[learning]"
    python examples/learning/steered_circle.py
"""

import sys
from pathlib import Path
from time import perf_counter

import numpy as np

from tetherfmu.console.colours import BLUE, GREY, VERMILLION
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms

MINUTE = 3000  # steps of 20 ms


def fly(steps=MINUTE, seed=0):
    """An episode by the policy by hand: positions [m], (rows, 3), observations, (rows, 6), and the sum of the rewards."""
    from learning.kite_on_circle import KiteOnCircle, steer

    kite, rewards = KiteOnCircle(), 0.0
    observation, _ = kite.reset(seed=seed)
    positions, observations = [list(kite.position)], [observation]
    for _ in range(steps):
        observation, reward, ends, _, _ = kite.step(steer(observation))
        positions.append(list(kite.position))
        observations.append(observation)
        rewards += reward
        if ends:
            break
    return np.array(positions), np.array(observations), rewards


def speed(steps=10 * MINUTE):
    """Steps in a second of the clock, the policy by hand counted, and the time of a reset over that of a step."""
    from learning.kite_on_circle import KiteOnCircle, steer

    kite = KiteOnCircle()
    observation, _ = kite.reset(seed=0)
    times = [perf_counter()]
    for _ in range(steps):
        observation, *_ = kite.step(steer(observation))
    times.append(perf_counter())
    for _ in range(steps):
        kite.reset()
    times.append(perf_counter())
    stepping, resetting = np.diff(times)
    return steps / stepping, resetting / stepping


def draw(positions, observations):
    """Figure of the flown circle as the ground station sees it, and of the tension."""
    import matplotlib.pyplot as plt

    from learning.kite_on_circle import LEFT, RADIUS, STEP, UP

    figure, (left, right) = plt.subplots(1, 2, figsize=(10, 4.2), layout="constrained")
    directions = positions / np.linalg.norm(positions, axis=1, keepdims=True)
    angle = np.linspace(0.0, 2.0 * np.pi, 200)
    across, up = np.sin(RADIUS) * np.cos(angle), np.sin(RADIUS) * np.sin(angle)
    left.plot(-across, up, color=GREY, linestyle="--", label="wanted")
    left.plot(-directions @ LEFT, directions @ UP, color=BLUE, label="flown")
    left.plot(-directions[0] @ LEFT, directions[0] @ UP, "o", color=VERMILLION, label="start")
    left.set(xlabel="to the right [-]", ylabel="upwards [-]", aspect="equal", title="seen from the ground station")
    left.legend(loc="center")
    right.plot(STEP * np.arange(len(observations)), observations[:, 5], color=BLUE)
    right.set(xlabel="time [s]", ylabel="tension at the kite [kN]", title="tension")
    right.grid(alpha=0.3)
    return figure


@command
def main(arguments=None, prog=None):
    """Fly a minute, print how well and how fast, and draw it."""
    parser = Parser(prog=prog, description="steer a kite on a circle in an environment for Gymnasium")
    parser.add_out()
    given = parser.parse_args(arguments)
    positions, observations, rewards = fly()
    off, count = np.rad2deg(np.abs(observations[MINUTE // 6 :, 0])), len(observations) - 1
    print(f"{count} steps of 20 ms, mean reward {rewards / count:.3f}, {off.max():.1f} deg off after 10 s or later")
    print(f"tension {observations[:, 5].min():.2f} to {observations[:, 5].max():.2f} kN")
    each_second, reset = speed()
    print(f"{each_second:.0f} steps a second with the policy; a reset takes the time of {reset:.1f} steps")
    given.out.mkdir(parents=True, exist_ok=True)
    draw(positions, observations).savefig(given.out / "kite_on_circle.png", dpi=120)


if __name__ == "__main__":
    sys.exit(main())
