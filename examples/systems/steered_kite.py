"""How far does a kite roll when one winch pays out one of its tapes and reels in the other?

    python examples/systems/steered_kite.py

In `steered_kite.toml` two tapes go from a pod to the tips of a wing. The winch `steering` changes their lengths by p and -p,
and afterwards `depower` pays out both by d. The lift is vertical, half of it at each tip; a load along the wing keeps it
taut. The wing is then in equilibrium where its middle is above the pod, and pod and tips are a triangle with the sides
L + d + p, L + d - p and the span b. With the distance m of the pod from the middle of the wing the roll is

    sin(roll) = 2 (L + d) p/(m b),   m^2 = (L + d)^2 + p^2 - b^2/4
"""

import sys
from pathlib import Path

import numpy as np

from tetherfmu import TetherSystem
from tetherfmu.console.colours import BLACK, BLUE, VERMILLION
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser

FILE = Path(__file__).with_name("steered_kite.toml")
FREE = ("pod", "left", "right")  # points that start where they are in equilibrium
TAPE, SPAN = 10.2, 8.0  # lengths of the file [m]
LIFT, ALONG = 3000.0, 900.0  # of the wing, and of the load along it at each tip [N]
STEERED, PAID_OUT = 0.6, 1.0  # the most that a tape gets longer, and that both do in the end [m]
DURATION, STEP = 60.0, 0.02  # [s]


def smooth(time, begin, end):
    """A smooth rise from 0 to 1 between two times [s]."""
    s = np.clip((np.asarray(time) - begin) / (end - begin), 0.0, 1.0)
    return s**3 * (10.0 - 15.0 * s + 6.0 * s * s)


def payouts(time):
    """Lengths [m] that `steering` and `depower` have paid out at times [s]."""
    steering = STEERED * (smooth(time, 0.0, 12.0) - 2.0 * smooth(time, 16.0, 36.0))
    return steering, PAID_OUT * smooth(time, 42.0, 54.0)


def roll_of(steering, depower):
    """Roll [rad] of the wing in equilibrium with these payouts [m]."""
    length = TAPE + depower
    middle = np.sqrt(length**2 + steering**2 - 0.25 * SPAN**2)
    return np.arcsin(2.0 * length * steering / (middle * SPAN))


def fly():
    """Times [s] after each step, rolls of the wing then [rad], payouts of both winches [m] and tensions of the tapes [N]."""
    system = TetherSystem.from_file(FILE)
    outputs = system.initialize(loads=loads_on((-1.0, 0.0, 0.0), (1.0, 0.0, 0.0)), positions=dict.fromkeys(FREE))
    times, rows = STEP * np.arange(round(DURATION / STEP)), []
    for time in times:
        steering, depower = payouts(time)
        left, right = (outputs.points[name].position for name in ("left", "right"))
        outputs = system.step(STEP, loads=loads_on(left, right), winch_lengths={"steering": steering, "depower": depower})
        x, _, z = outputs.points["right"].position - outputs.points["left"].position
        rows.append(
            (
                -np.arctan2(z, x),
                *(outputs.winches[name].payout for name in ("steering", "depower")),
                *(outputs.lines[name].ground_tension for name in ("tape_left", "tape_right")),
            )
        )
    roll, steering, depower, *tensions = np.transpose(rows)
    return times + STEP, roll, np.array([steering, depower]), np.array(tensions)


def loads_on(left, right):
    """Loads [N] on the tips at these positions [m]."""
    along = np.subtract(right, left)
    along *= ALONG / np.linalg.norm(along)
    lift = np.array([0.0, 0.0, 0.5 * LIFT])
    return {"left": lift - along, "right": lift + along}


def draw(time, roll, paid_out, tensions, path):
    """Payouts, roll with that of the formula, and tensions over time, to a file."""
    import matplotlib.pyplot as plt

    figure, (lengths, angles, pulls) = plt.subplots(3, 1, figsize=(8.0, 7.0), sharex=True, layout="constrained")
    for name, own, colour in zip(("steering", "depower"), paid_out, (BLUE, BLACK), strict=True):
        lengths.plot(time, own, color=colour, label=name)
    lengths.set(ylabel="payout [m]")
    angles.plot(time, np.degrees(roll), color=BLACK, label="flight")
    angles.plot(time, np.degrees(roll_of(*payouts(time))), "--", color=VERMILLION, label="triangle")
    angles.set(ylabel="roll [deg]")
    for name, own, colour in zip(("left tape", "right tape"), tensions, (BLUE, VERMILLION), strict=True):
        pulls.plot(time, own, color=colour, label=name)
    pulls.set(xlabel="time [s]", ylabel="tension [N]")
    for axes in (lengths, angles, pulls):
        axes.grid(alpha=0.3)
        axes.legend()
    figure.savefig(path, dpi=100)
    plt.close(figure)


@command
def main(arguments=None):
    """Print rolls by the flight and by the triangle, write the figure."""
    parser = Parser(description="steer a kite by two tapes on one winch")
    parser.add_out()
    file = parser.parse_args(arguments).out / "steered_kite.png"
    time, roll, paid_out, tensions = fly()
    for at in (14.0, 40.0, 58.0):
        row = round(at / STEP)
        wanted = np.degrees(roll_of(*payouts(time[row])))
        print(f"after {at:.0f} s: roll {np.degrees(roll[row]):.2f} deg, by the triangle {wanted:.2f} deg")
    file.parent.mkdir(parents=True, exist_ok=True)
    draw(time, roll, paid_out, tensions, file)
    print(file)


if __name__ == "__main__":
    sys.exit(main())
