"""A measured drop of a kite, whose tether falls to the ground: table and figure of docs/measurements/validation.md.

    python tests/benchmarks/measured_drop.py PATH

PATH: the processed log of the flight of 9 October 2025 (CSV; made of repository awegroup/Flightdata09102025, licence
CC BY-NC 4.0, so it is not part of the project). Columns: time, kite_position and kite_velocity (x east, y north, z up; of
the control unit, where the tether ends), tether_length, wind_velocity at 100 m, measured_ground_tension. SI units, the
ground station at the origin.

Each tether is driven by these, the winch by the length. Nothing is fitted but an offset of 9.4 m, which is in that length.
The tension, as its mean over 1 s, is compared from 1.2 to 7.2 s, while the tether is in the air. Later the log says nothing
about the ground: it reads exactly 0 from 10 s on, and its reading, made of a load cell and an angle, is 13 N for a slack
tether at rest and cannot tell 0 from 50 N. At the end the kite end reaches the ground, so the lowest inner node is taken.
"""

import argparse
import warnings
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.interpolate import CubicHermiteSpline

from tetherfmu import PlausibilityWarning, StepRefused, TetherDynamic, TetherQuasiSteady
from tetherfmu.console.colours import BLUE, COLOUR, REFERENCE
from tetherfmu.study.measuring.tables import markdown

FIGURE = Path(__file__).parents[2] / "docs" / "figures" / "measured_drop.png"
STEP = 0.02  # s
GROUND = -4.0  # height of the ground below the station [m]
AREA = (13.5 / 4.0) ** 2  # of the tether, over that of the default one
TETHER = {
    "diameter": 0.0135,
    "density": 724.0,
    "drag_coefficient": 1.1,
    "axial_stiffness": 614600.0 * AREA,
    "axial_damping": 473.0 * AREA,
}
AIR = {"wind_profile": "power_law", "wind_reference_height": 100.0, "wind_exponent": 0.023}
RUNS = {
    "dynamic, 40 segments": {},
    "the same, friction 0": {"ground_friction": 0.0},
    "the same without ground": {"ground_contact": "none"},
    "dynamic, 20 segments": {"segments": 20},
    "dynamic, 40 segments, fixed step 5 ms": {"fixed_step": 0.005},
    "quasi-steady, 40 segments": {"model": TetherQuasiSteady},
}
BARE, FULL = "the same without ground", "dynamic, 40 segments"
COMPARED, LYING = (1.2, 7.2), 11.0  # s


class Log:
    """The log at any time."""

    def __init__(self, path):
        self.table = pd.read_csv(path)
        kite, speed, wind = (
            self.table[[f"{name}[{k}]" for k in (1, 2, 3)]].to_numpy()
            for name in ("kite_position", "kite_velocity", "wind_velocity")
        )
        self.time = self.table.time.to_numpy()
        self.kite, self.wind = CubicHermiteSpline(self.time, kite, speed), wind

    def inputs(self, time):
        """Inputs at a time [s] by name."""
        wind = [np.interp(time, self.time, column) for column in self.wind.T]
        length = np.interp(time, self.time, self.table.tether_length)
        return {
            "kite_position": self.kite(time),
            "kite_velocity": self.kite(time, 1),
            "wind_velocity": wind,
            "winch_length": length,
        }

    def tension(self, times):
        """Measured tension at the ground station [N] at some times [s]."""
        return np.interp(times, self.time, self.table.measured_ground_tension)


def fly(log, model=TetherDynamic, segments=40, ground_contact="flat", ground_friction=0.5, **options):
    """Time [s], tension at the station [N], lowest inner node [m] and length on the ground [m] of a run; steps refused."""
    place = {"ground_contact": ground_contact, "ground_height": GROUND, "ground_friction": ground_friction}
    start = log.inputs(0.0)
    length = float(start["winch_length"])
    more = {"winch_control": "length", "segments": segments, "initial_length": length}
    tether = model(**TETHER, **AIR, **place, **more, **options)
    tether.initialize(**start)
    rows, refused = [], 0
    for k in range(round(log.time[-1] / STEP)):
        try:
            out = tether.step(STEP, **log.inputs(k * STEP))
        except StepRefused:
            refused += 1
            continue
        rows.append(((k + 1) * STEP, out.ground_tension, tether.positions[1:-1, 2].min(), out.grounded_length))
    return pd.DataFrame(rows, columns=["time", "tension", "lowest", "grounded"]), refused


def smoothed(series):
    """Mean over 1 s, centred."""
    return series.rolling(round(1.0 / STEP), center=True, min_periods=1).mean()


def row(name, log, series, refused):
    """A row of the table."""
    compared = series.time.between(*COMPARED)
    difference = smoothed(series.tension)[compared] - log.tension(series.time[compared])
    return {
        "tether": name,
        "tension, rms of the difference N": np.sqrt(np.mean(difference**2)),
        "mean tension after 11 s N": series.tension[series.time > LYING].mean(),
        "on the ground at the end m": series.grounded.iloc[-1],
        "lowest inner node m": f"{series.lowest.min():.2f}",
        "steps refused": refused,
    }


def draw(log, flights, path):
    """Tension above, height of the lowest inner node below, with and without ground."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 5.6), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    measured = log.table.measured_ground_tension
    upper.plot(log.time, measured, color=REFERENCE, linewidth=2.5, label="measured")
    styles = {FULL: ("with ground", COLOUR["dynamic"], "-"), BARE: ("without ground", BLUE, "--")}
    for name, (label, colour, line) in styles.items():
        series = flights[name]
        upper.plot(series.time, smoothed(series.tension), line, color=colour, label=f"TetherDynamic {label}, mean over 1 s")
        lower.plot(series.time, series.lowest, line, color=colour)
    lower.axhline(GROUND, color=REFERENCE, linewidth=0.8)
    lower.annotate("ground", (0.5, GROUND), (0, -4), textcoords="offset points", va="top", color=REFERENCE)
    upper.axvspan(*COMPARED, color="0.92", zorder=0)
    upper.annotate("compared", (COMPARED[0], 395.0), (4, 0), textcoords="offset points", va="top", color="0.35")
    upper.annotate("the log reads exactly 0", (10.3, 12.0), color=REFERENCE, va="bottom")
    upper.set(ylabel="tension at the ground [N]", ylim=(-10.0, 400.0), xlim=(0.0, log.time[-1]))
    lower.set(ylabel="height of the lowest inner node [m]", xlabel="time [s]")
    upper.legend(loc="upper right", frameon=False)
    for axes in (upper, lower):
        axes.grid(alpha=0.3)
    figure.savefig(path, dpi=90, metadata={"Software": None})


def main():
    """Print the table and draw the figure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("path", type=Path, help="the processed log")
    parser.add_argument("--figure", type=Path, default=FIGURE)
    given = parser.parse_args()
    log, rows, flights = Log(given.path), [], {}
    for name, options in RUNS.items():
        with warnings.catch_warnings(action="ignore", category=PlausibilityWarning):
            series, refused = fly(log, **options)
        flights[name] = series
        rows.append(row(name, log, series, refused))
    print(markdown(pd.DataFrame(rows)))
    mean = log.tension(flights[FULL].time[flights[FULL].time.between(*COMPARED)]).mean()
    print(f"\nMeasured mean from {COMPARED[0]} to {COMPARED[1]} s: {mean:.0f} N.")
    draw(log, flights, given.figure)


if __name__ == "__main__":
    main()
