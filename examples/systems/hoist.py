"""How far does a load tilt, and where does it hang, when its two winches run at different speeds?

    python examples/systems/hoist.py

`hoist.toml` is a gantry with two winches that hold a beam of 8 m with 200 kg at each end. The left rope is paid out by 3 m
while the right one is hauled in by 1 m, in 30 s, smoothly. The beam tilts, and moves sideways.

Gantry, ropes and beam are four bars with one angle left, and the load hangs where its weight is lowest. The ropes of the
flight stretch and weigh something, and the load swings a little.
"""

import sys
from pathlib import Path

import numpy as np
from scipy.optimize import minimize_scalar

from tetherfmu import TetherSystem
from tetherfmu.console.colours import BLACK, BLUE, VERMILLION
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser
from tetherfmu.runtime.layout import GROUND_TENSION

FILE = Path(__file__).with_name("hoist.toml")
LEFT, RIGHT, BEAM, LENGTH = np.array([-6.0, 30.0]), np.array([6.0, 30.0]), 8.0, 20.0  # of the file: winches (x, z) [m]
PAID_OUT, HAULED_IN, RAMP, DURATION, STEP = 3.0, 1.0, 30.0, 50.0, 0.02  # m, m, s, s, s
SETTLED = 10.0  # the end of the flight, more than a swing [s]


def lengths(time):
    """Unstretched lengths [m] of the left and the right rope at times [s]."""
    s = np.clip(np.asarray(time) / RAMP, 0.0, 1.0)
    part = s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
    return LENGTH + PAID_OUT * part, LENGTH - HAULED_IN * part


def speeds(time):
    """Reel-out speeds [m/s] of the left and the right winch at times [s]: the rates of `lengths`."""
    s = np.clip(np.asarray(time) / RAMP, 0.0, 1.0)
    rate = 30.0 * (s * (1.0 - s)) ** 2 / RAMP
    return PAID_OUT * rate, -HAULED_IN * rate


def load_on_bars(angle, left, right):
    """Ends of the beam (x, z) [m], (2, 2), with the left rope at an angle [rad] from the vertical.

    left, right : lengths of the ropes [m].
    """
    lower = LEFT + left * np.array([np.sin(angle), -np.cos(angle)])
    away = RIGHT - lower
    distance = np.hypot(*away)
    along = (BEAM**2 + distance**2 - right**2) / (2.0 * distance)  # of the other end from `lower`, towards the winch
    aside = np.sqrt(BEAM**2 - along**2)
    return np.array([lower, lower + along * away / distance + aside * np.array([away[1], -away[0]]) / distance])


def hanging(left, right):
    """Ends of the beam (x, z) [m], (2, 2), where it hangs on ropes of these lengths [m]: the lowest of all angles."""
    found = minimize_scalar(
        lambda angle: load_on_bars(angle, left, right)[:, 1].sum(),
        bounds=(-0.3, 0.5),
        method="bounded",
        options={"xatol": 1e-10},
    )
    return load_on_bars(found.x, left, right)


def tilt_of(ends):
    """Angle of the beam above the horizontal [rad] from its ends (..., 2, 2) [m]."""
    along = ends[..., 1, :] - ends[..., 0, :]
    return np.arctan2(along[..., 1], along[..., 0])


def fly():
    """Times [s] after each step, ends of the beam then (steps, 2, 2) [m], and tensions at the winches (steps, 2) [N]."""
    system = TetherSystem.from_file(FILE)
    left, right = speeds(STEP * np.arange(round(DURATION / STEP)))
    system.initialize()
    flown = system.fly(len(left), STEP, reel_out_speeds={"rope_left": left, "rope_right": right})
    ends = np.stack([flown.points[name].position[:, ::2] for name in ("left", "right")], axis=1)
    tensions = np.stack([flown.outputs[name][:, GROUND_TENSION] for name in ("rope_left", "rope_right")], axis=1)
    return STEP * np.arange(1, len(left) + 1), ends, tensions


def draw(time, ends, tensions, path):
    """The beam every 5 s, and its tilt with that of four bars, to a file."""
    import matplotlib.pyplot as plt

    figure, (space, angles) = plt.subplots(1, 2, figsize=(10.0, 4.6), layout="constrained")
    for row in range(0, len(time), round(5.0 / STEP)):
        space.plot(*np.array([LEFT, *ends[row], RIGHT]).T, color=BLUE, linewidth=0.9)
        space.plot(*ends[row].T, color=BLACK, linewidth=2.0)
    space.set(xlabel="x [m]", ylabel="z [m]", title="Every 5 s")
    space.set_aspect("equal")
    rows = np.arange(0, len(time), round(1.0 / STEP))
    bars = np.array([hanging(*each) for each in np.transpose(lengths(time[rows]))])
    angles.plot(time, np.degrees(tilt_of(ends)), color=BLACK, label="flight")
    angles.plot(time[rows], np.degrees(tilt_of(bars)), "--", color=VERMILLION, label="four bars")
    angles.set(xlabel="time [s]", ylabel="tilt of the beam [deg]")
    angles.grid(alpha=0.3)
    angles.legend()
    figure.savefig(path, dpi=100)
    plt.close(figure)


@command
def main(arguments=None):
    """Print where the load ends, by the flight and by four bars, write the figure."""
    parser = Parser(description="tilt a load with two winches that run at different speeds")
    parser.add_out()
    file = parser.parse_args(arguments).out / "hoist.png"
    time, ends, tensions = fly()
    at_end = time > DURATION - SETTLED
    bars = hanging(*lengths(DURATION))
    mean = ends[at_end].mean(axis=0)
    for name, found in (("flight", mean), ("four bars", bars)):
        print(f"{name}: tilt {np.degrees(tilt_of(found)):.2f} deg, middle at x = {found[:, 0].mean():.3f} m")
    left, right = tensions[at_end].mean(axis=0)
    print(f"the left rope carries {left:.0f} N, the right one {right:.0f} N")
    file.parent.mkdir(parents=True, exist_ok=True)
    draw(time, ends, tensions, file)
    print(file)


if __name__ == "__main__":
    sys.exit(main())
