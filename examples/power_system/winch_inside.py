"""What does a pumping kite give if its winch is inside the tether, in steps of 20 to 200 ms? Beside the winch as an FMU.

    python examples/power_system/winch_inside.py

In steps of 100 ms `pumping_cycle.py` diverges with both of its masters, because the load on the kite is delayed. Here
tether and kite repeat each step until they agree. Only the winch is still delayed: as an FMU it gets
the tension at the end of a step and gives its speed to the next one. With `winch_control` = force the drum, its inertia
and its friction are solved together with the tether, and only the motor is outside (`WinchMotor`).
"""

import sys
from itertools import product
from pathlib import Path

import numpy as np

from tetherfmu.console.colours import BLUE, GREEN, VERMILLION
from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser
from tetherfmu.console.progress import now

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms
from power_system import pumping_cycle
from power_system.agreement import together
from power_system.kite_power_system import FMUS, INSIDE, INSIDE_START, START

HELD = {"input_continuation": 2}  # start value: the inputs of the tether stay as they are within a step
DRUM_ENDS = {"tether.longest_length": 0.0, "tether.shortest_length": 0.0}  # no stops: the controller has the same names
STEPS, COLOURS = (0.02, 0.1, 0.2), (GREEN, BLUE, VERMILLION)  # communication steps [s]


def fly(step, inside, start=START):
    """A whole cycle after the first reeling in: time [s], tension [N], reel-out speed [m/s], tether steps for each."""
    start, rows, bounds = (INSIDE_START if inside else {}) | start | HELD | DRUM_ENDS, [], []
    with pumping_cycle.system(start, "gauss_seidel", INSIDE if inside else FMUS) as (parts, signals, at, stop_if_pressed):
        load, kite = (slice(at[f"{name}[1]"], at[f"{name}[3]"] + 1) for name in ("kite_load", "kite_position"))
        guess = np.array(signals[load])
        while len(bounds) < 2:
            time, depower = len(rows) * step, signals[at["depower"]]
            guess, count = together(parts[:2], signals, load, guess, time, step)
            pumping_cycle.gauss_seidel(parts[2:], signals, time, step)
            rows.append((time + step, signals[at["ground_tension"]], signals[at["winch_speed"]], count))
            bounds += [len(rows)] if depower == 1.0 > signals[at["depower"]] else []
            stop_if_pressed()
            if signals[kite][2] < 0.0 or time > pumping_cycle.LONGEST_CYCLE:
                raise RuntimeError(f"no cycle has ended after {time:.1f} s")
    return np.transpose(rows[bounds[0] - 1 : bounds[1]])


def explicit(master, step):
    """What `pumping_cycle.py` gives in the same steps [s], in words."""
    try:
        return pumping_cycle.summary(pumping_cycle.fly(1, step, master)).partition(": ")[2].partition("\n")[0]
    except RuntimeError as error:
        return str(error).partition(":")[0]


@command
def main(arguments=None):
    """Print the mean power and the peak force of a cycle of each kind, draw the reel-out speeds."""
    parser = Parser(description="fly a pumping kite with its winch inside the tether, and as an FMU")
    parser.add_out()
    file = parser.parse_args(arguments).out / "winch_inside.png"
    from power_system.pumping_figures import plt

    for master, step in product(pumping_cycle.MASTERS, STEPS[:2]):
        print(f"pumping_cycle.py, {master}, {1e3 * step:g} ms: {explicit(master, step)}")
    figure, panels = plt.subplots(2, 1, figsize=(9.0, 6.0), sharex=True, sharey=True, layout="constrained")
    for inside, name in enumerate(("winch as an FMU", "winch inside the tether")):
        panels[inside].set(title=name, ylabel="reel-out speed [m/s]", xlabel="time of a cycle [s]" if inside else "")
        panels[inside].grid(alpha=0.4)
        for step, colour in zip(STEPS, COLOURS, strict=True):
            now(f"flying with {1e3 * step:g} ms")
            time, tension, speed, counts = fly(step, inside)
            power = np.trapezoid(tension * speed, time) / (time[-1] - time[0])
            found = f"{name}, {1e3 * step:g} ms: mean power {power:.0f} W, peak force {tension.max():.0f} N"
            print(f"{found}, {counts.mean():.1f} tether steps for each")
            panels[inside].plot(time - time[0], speed, color=colour, linewidth=1.0, label=f"{1e3 * step:g} ms")
    panels[0].legend()
    file.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(file, dpi=150)
    print(file)


if __name__ == "__main__":
    sys.exit(main())
