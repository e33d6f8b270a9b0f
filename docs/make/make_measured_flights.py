"""Write docs/measurements/measured_flights.md, its tables and figures.

    python docs/make/make_measured_flights.py [--flight-2023 LOG] [--flight-2025 LOG]

The cycles of 2019 are in examples/flights. The logs of 12 May 2023 and 9 October 2025 are published under CC BY-NC 4.0, so
they are not part of the project: awegroup/Flightdata12052023 and awegroup/Flightdata09102025 have them. What was made of a
flight whose log is not given stays as it is in docs/data/measured_*.csv.
"""

import argparse
import sys
import warnings
from pathlib import Path

import numpy as np
import pandas as pd
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from matplotlib.figure import Figure

from pictures import save
from tetherfmu import PlausibilityWarning
from tetherfmu.console.colours import BLUE, COLOUR, REFERENCE
from tetherfmu.console.options import file
from tetherfmu.study.measuring.tables import circumstances, markdown
from tetherfmu.study.replay import comparison, driven_tethers, fitting, log
from tetherfmu.study.replay.flight import Correction, prepare
from tetherfmu.study.replay.replay import replay

DOCS = Path(__file__).resolve().parents[1]
LOGS = DOCS.parent / "examples" / "flights"
CYCLES = {f"8 October 2019, cycle {int(cycle)}": f"kitepower_20191008_{cycle}.csv" for cycle in ("0012", "0031", "0064")}
FLIGHT_2023, FLIGHT_2025 = "12 May 2023, 299 s", "9 October 2025, 28 minutes"
BEGUN_2023, LAUNCHED_2025, FALLING = 1683900945.6, 1760024111.0, 1760025801.6  # Unix time [s]
LYING = 11.0  # s of the drop, after which the tether lies
DROP, COMPARED, WHOLE_DROP = "drop", 7.2, 46.1  # and s of it
OF_DROP = {
    "dynamic, 40 segments": {"segments": 40},
    "the same, friction 0": {"segments": 40, "ground_friction": 0.0},
    "the same without ground": {"segments": 40, "ground_contact": "none"},
    "the same, 1 m longer": {"segments": 40, "longer": 1.0},
    "the same, wind from 10 m on with exponent 0.1": {"segments": 40, "wind_reference_height": 10.0, "wind_exponent": 0.1},
    "dynamic, 20 segments": {"segments": 20},
    "dynamic, 40 segments, fixed steps of 5 ms": {"segments": 40, "fixed_step": 0.005},
    "the same, backward Euler": {"segments": 40, "fixed_step": 0.005, "fixed_step_method": "backward_euler"},
    "quasi-steady, 40 segments": {"variant": "quasi_steady", "segments": 40},
    "catenary": {"variant": "catenary"},
    "straight": {"variant": "straight"},
}
FULL, BARE = "dynamic, 40 segments", "the same without ground"
NAMES = {"dynamic": "dynamic", "quasi_steady": "quasi-steady", "catenary": "catenary", "straight": "straight"}


def led_by_tension(name, flight):
    """A row of the table of lengths: all tethers driven by the tension, an offset fitted on the first half."""
    half = first_half(flight)
    found = replay(flight, "tension", fit_part=half)
    errors = found.errors[found.errors.part == comparison.ALL].set_index("tether")
    ((value, width),), start = found.fit.found.values(), half.end
    rest = found.residuals[(found.residuals.time >= start) & (found.residuals.tether == "dynamic")]
    distance = np.linalg.norm(flight.kite(flight.times)[0], axis=1)
    more = np.abs(found.flown["dynamic"].table.tether_length - distance)
    with_origin = replay(flight, "tension", ("dynamic",), ("offset", "origin"), half).residuals
    rest_with_origin = with_origin[with_origin.time >= start].length
    row = {
        "flight": name,
        "measured tension, mean [N]": errors.at["dynamic", "measured tension [N]"],
        "offset [m]": f"{value:.1f} ± {width:.1f}",
        "second half: mean [m]": rest.length.mean(),
        "scatter [m]": rest.length.std(),
        "with the origin fitted: mean [m]": rest_with_origin.mean(),
        "its scatter [m]": rest_with_origin.std(),
        "equivalent tension [kN]": 1e-3 * rest.stiffness.mean() * rest.length.std(),
    }
    row |= {f"{label}: rms [m]": errors.at[key, "length: rms about mean [m]"] for key, label in NAMES.items()}
    return row | {"sag and stretch: mean [m]": more.mean(), "at most [m]": more.max()}


def first_half(flight):
    """Part of a flight on which is fitted."""
    return flight.part(flight.start, 0.5 * (flight.start + flight.end))


def led_by_length(name, flight):
    """A row of the table of tensions: the same offset, all tethers driven by the length."""
    found = replay(flight, "length", fit_part=first_half(flight))
    errors = found.errors[found.errors.part == comparison.ALL].set_index("tether")
    row = {"flight": name, "measured tension, mean [N]": errors.at["dynamic", "measured tension [N]"]}
    return row | {f"{label}: rms [N]": errors.at[key, "tension: rms [N]"] for key, label in NAMES.items()}


def of_drop(flight, variant="dynamic", longer=0.0, **options):
    """What a tether, longer by so many m, gives along the drop: a row of its table; over time tensions and lowest node."""
    flight = flight.corrected(Correction(length=longer))
    flown = driven_tethers.fly(flight, variant, "length", **options)
    table = comparison.residuals(flight, {variant: flown})
    since = table.time - flight.start
    air = table[(since >= comparison.SETTLED) & (since <= COMPARED)]
    tension = table.tension + table.measured
    lowest = flown.shapes[:, 1:-1, 2].min(axis=1)
    row = {
        "tension, rms of the difference [N]": comparison.rms(air.tension),
        "correlation": np.corrcoef(air.measured, air.measured + air.tension)[0, 1],
        "mean tension after 11 s [N]": tension[since > LYING].mean(),
        "on the ground at the end [m]": flown.table.grounded_length.iloc[-1],
        "lowest inner node [m]": f"{lowest.min():.2f}",
        "steps refused": len(flown.refusals),
    }
    return row, pd.DataFrame({"time": since, "tension": tension, "measured": table.measured, "lowest": lowest})


def draw_drop(ground, flights, path):
    """Tension above, height of the lowest inner node below, with and without ground."""
    figure = Figure(figsize=(8.0, 5.6), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True)
    first = flights[FULL]
    upper.plot(first.time, first.measured, color=REFERENCE, linewidth=2.5, label="measured")
    styles = {FULL: ("with ground", COLOUR["dynamic"], "-"), BARE: ("without ground", BLUE, "--")}
    for name, (label, colour, line) in styles.items():
        found = flights[name]
        upper.plot(found.time, found.tension, line, color=colour, label=f"TetherDynamic {label}, mean over 1 s")
        lower.plot(found.time, found.lowest, line, color=colour)
    lower.axhline(ground, color=REFERENCE, linewidth=0.8)
    lower.annotate("ground", (0.5, ground), (0, -4), textcoords="offset points", va="top", color=REFERENCE)
    upper.axvspan(comparison.SETTLED, COMPARED, color="0.92", zorder=0)
    upper.annotate("compared", (comparison.SETTLED, 395.0), (4, 0), textcoords="offset points", va="top", color="0.35")
    upper.annotate("the log reads exactly 0", (10.3, 12.0), color=REFERENCE, va="bottom")
    upper.set(ylabel="tension at the ground [N]", ylim=(-10.0, 400.0), xlim=(0.0, first.time.iloc[-1]))
    lower.set(ylabel="height of the lowest inner node [m]", xlabel="time [s]")
    upper.legend(loc="upper right", frameon=False)
    for axes in (upper, lower):
        axes.grid(alpha=0.3)
    save(figure, path)


def fly_2019():
    """Rows of the table of lengths of the three cycles."""
    return [led_by_tension(name, prepare(log.read(LOGS / cycle, "kitepower_2019"))) for name, cycle in CYCLES.items()]


def fly_2023(path):
    """Rows of the tables of lengths and of tensions of the flight of 2023."""
    read = log.read(path, "kitepower_2023")
    flight = prepare(read, BEGUN_2023 - read.begin, BEGUN_2023 - read.begin + 299.0)
    return [led_by_tension(FLIGHT_2023, flight)], [led_by_length(FLIGHT_2023, flight)]


def fly_2025(path, figures):
    """Rows of the tables of lengths, of tensions and of the drop of 2025; draws the drop."""
    read = log.read(path, "kitepower_2025")
    launched, falling = (max(0.0, time - read.begin) for time in (LAUNCHED_2025, FALLING))
    before, drop = prepare(read, launched, falling), prepare(read, falling, falling + WHOLE_DROP)
    rows, flights = [], {}
    for name, options in OF_DROP.items():
        row, flights[name] = of_drop(drop, **options)
        rows.append({"tether": name} | row)
    draw_drop(read.map.ground.ground_height, flights, figures / "measured_drop.svg")
    mean = flights[FULL].measured[flights[FULL].time.between(comparison.SETTLED, COMPARED)].mean()
    fit = fitting.fit(before)
    said = pd.DataFrame([{"tether": f"measured; {fit}", "tension, rms of the difference [N]": mean}])
    return [led_by_tension(FLIGHT_2025, before)], [led_by_length(FLIGHT_2025, before)], rows, said


def kept(path, rows, key):
    """A table with new rows in the place of those of the same key in a file, in the order of the file; writes it."""
    new = pd.DataFrame(rows)
    if path.exists():
        old = pd.read_csv(path)
        if new.empty:
            return old
        new = pd.concat([new, old[~old[key].isin(new[key])]])
    new = new.sort_values(key, key=lambda column: column.map(lambda name: ORDER.index(name) if name in ORDER else 99))
    new.to_csv(path, index=False, float_format="%.6g")
    return pd.read_csv(path)


def shown(table, columns, rows=slice(None)):
    """The part of a table that is on the page: columns, and rows by the names in its first column."""
    return table.set_index(table.columns[0]).loc[rows, columns].reset_index()


SHOWN = {  # columns of the tables on the page, and rows of that of the drop
    "lengths": (["measured tension, mean [N]", "scatter [m]", "equivalent tension [kN]"],),
    "tensions": (["measured tension, mean [N]", "dynamic: rms [N]"],),
    "drop": (
        ["tension, rms of the difference [N]", "mean tension after 11 s [N]", "on the ground at the end [m]"],
        [FULL, "the same, friction 0", BARE, "quasi-steady, 40 segments", "catenary", "straight"],
    ),
}
ORDER = [*CYCLES, FLIGHT_2023, FLIGHT_2025, *OF_DROP]


def main(arguments=None):
    """Fly, write tables, figure and page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--flight-2023", type=file, metavar="LOG", help="log of 12 May 2023 (CSV)")
    parser.add_argument("--flight-2025", type=file, metavar="LOG", help="log of 9 October 2025 (CSV)")
    given = parser.parse_args(arguments)
    data = DOCS / "data"
    with warnings.catch_warnings(action="ignore", category=PlausibilityWarning):
        lengths, tensions, drop, said = fly_2019(), [], [], None
        if given.flight_2023:
            more = fly_2023(given.flight_2023)
            lengths, tensions = lengths + more[0], tensions + more[1]
        if given.flight_2025:
            *more, drop, said = fly_2025(given.flight_2025, DOCS / "figures")
            lengths, tensions = lengths + more[0], tensions + more[1]
    tables = {
        "lengths": kept(data / "measured_lengths.csv", lengths, "flight"),
        "tensions": kept(data / "measured_tensions.csv", tensions, "flight"),
        "drop": kept(data / "measured_drop.csv", drop, "tether"),
    }
    pages = Environment(
        loader=FileSystemLoader(Path(__file__).parent), undefined=StrictUndefined, keep_trailing_newline=True
    )
    text = pages.get_template("measured_flights.md.j2").render(
        {name: markdown(shown(table, *SHOWN[name])) for name, table in tables.items()} | {"falling": f"{FALLING} s"}
    )
    (DOCS / "measurements" / "measured_flights.md").write_text(text, encoding="utf-8")
    if said is not None:
        print(markdown(said))
    print(circumstances())


if __name__ == "__main__":
    sys.exit(main())
