"""What a sweep writes: tables, a figure for each pair of a varied value and a statistic, one page; and its command."""

import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from tetherfmu.console.colours import BLUE, VERMILLION
from tetherfmu.console.ending import FAILED, remedy
from tetherfmu.console.progress import now
from tetherfmu.files.scene_files import load
from tetherfmu.files.toml_files import WrongUse
from tetherfmu.study.advice.scene_report import html
from tetherfmu.study.measuring.store import keeping
from tetherfmu.study.measuring.tables import page

from .statistics import BINS_PER_DECADE
from .sweep import config_of, sweep

MOST_STEPS = 20  # different values that are joined by their medians
SHOWN = ("peak_tension", "largest_cycle", "time_slack")  # figures on the page, with the largest value of each output


def bins_of(table):
    """Cycles of all flights by range, a DataFrame with the columns flight, from, to and cycles."""
    rows = [(flight, int(k), count) for flight, bins in enumerate(table.attrs["bins"]) for k, count in bins.items()]
    rows = sorted(rows)
    low = [10.0 ** (k / BINS_PER_DECADE) for _, k, _ in rows]
    high = [10.0 ** ((k + 1) / BINS_PER_DECADE) for _, k, _ in rows]
    return pd.DataFrame({"flight": [row[0] for row in rows], "from": low, "to": high, "cycles": [row[2] for row in rows]})


def write_tables(table, folder):
    """Write flights and cycles to a folder (Path), as CSV and, where pyarrow is installed, as Parquet; the paths."""
    plain, written = table.copy(), []
    plain.attrs = {}
    for name, each in {"flights": plain.reset_index(), "cycles": bins_of(table)}.items():
        written.append(folder / f"{name}.csv")
        each.to_csv(written[-1], index=False, lineterminator="\r\n")
        if find_spec("pyarrow"):
            written.append(folder / f"{name}.parquet")
            each.to_parquet(written[-1], engine="pyarrow", index=False)
    if not find_spec("pyarrow"):
        print(f"no Parquet files: pyarrow is not installed ({remedy('pyarrow')})", file=sys.stderr)
    return written


def with_unit(name, units):
    """Label of an axis."""
    return f"{name} [{units[name]}]" if units.get(name) else name


def draw(table, varied, statistic, path):
    """Draw a statistic of all flights over a varied value, with medians where there are few values."""
    figure = Figure(figsize=(5.6, 3.8))
    axis, units, values = figure.add_axes((0.16, 0.15, 0.8, 0.8)), table.attrs["units"], table[varied]
    if pd.api.types.is_numeric_dtype(values):
        x = values.to_numpy(dtype=float)
    else:
        x, names = pd.factorize(values)
        axis.set_xticks(range(len(names)), names, rotation=30, ha="right", fontsize=8)
    axis.plot(x, table[statistic], ".", color=BLUE, markersize=4, alpha=0.5, label="flights")
    medians = table[statistic].groupby(x).median()
    if len(medians) <= MOST_STEPS and len(medians) < len(table):
        axis.plot(medians, "-o", color=VERMILLION, markersize=4, linewidth=1.2, label="medians")
        axis.legend(frameon=False, fontsize=8)
    axis.set(xlabel=with_unit(varied, units), ylabel=with_unit(statistic, units))
    axis.grid(alpha=0.3)
    figure.savefig(path, dpi=90, metadata={"Software": None})


def draw_all(table, varied, statistics, folder):
    """Draw each pair of a varied value and a statistic that has numbers; paths in the folder, dict by pair."""
    folder.mkdir(exist_ok=True)
    drawn = {}
    for name in varied:
        for statistic in statistics:
            if table[statistic].notna().any():
                file = f"{statistic} over {name}.png".replace(" ", "_")
                draw(table, name, statistic, folder / file)
                drawn[name, statistic] = f"{folder.name}/{file}"
    return drawn


def overview(table, varied, statistics):
    """A row for each statistic: how it is distributed over the flights, and its rank correlation with the varied values."""
    numeric = [name for name in varied if pd.api.types.is_numeric_dtype(table[name]) and table[name].nunique() > 1]
    rows = []
    for name in statistics:
        values = table[name].dropna()
        if values.empty:
            continue
        row = {"statistic": with_unit(name, table.attrs["units"]), "least": values.min(), "median": values.median()}
        row |= {"95 % below": values.quantile(0.95), "largest": values.max(), "in flight": int(values.idxmax())}
        for other in numeric:
            varies = values.nunique() > 1
            row[f"with {other}"] = float(table[name].corr(table[other], method="spearman")) if varies else np.nan
        rows.append(row)
    return pd.DataFrame(rows)


def values_in_words(table, name):
    """What a varied value was, for people."""
    values = table[name]
    if not pd.api.types.is_numeric_dtype(values):
        return f"{values.nunique()} values: {', '.join(map(str, values.unique()[:5]))}"
    return f"{values.nunique()} values from {values.min():.4g} to {values.max():.4g}"


def reasons_of(table):
    """How often flights were refused, by reason, and one of them: a DataFrame."""
    refused = table[table.refused != ""].refused
    reasons = refused.str.replace(r"\d[\d.e+-]*", "#", regex=True)  # the same but for numbers
    rows = [(len(each), int(each.index[0]), refused[each.index[0]]) for _, each in refused.groupby(reasons, sort=False)]
    return pd.DataFrame(sorted(rows, reverse=True), columns=["flights", "such as flight", "reason"])


def write(table, scene, config, folder):
    """Write all to a folder (Path): tables, figures, report.md and report.html; paths for people."""
    varied = table.attrs["varied"]
    statistics = [name for name in table.attrs["units"] if name not in varied]
    written = write_tables(table, folder)
    drawn = draw_all(table, varied, statistics, folder / "figures")
    largest = [name for name in statistics if name.endswith("_max")]
    shown = [name for name in (*SHOWN, *largest) if table[name].max() > 0.0]
    facts = {"table": table, "scene": scene, "config": config, "reasons": reasons_of(table), "shown": shown}
    facts |= {"names": varied, "statistics": statistics}
    facts["varied"] = {with_unit(name, table.attrs["units"]): values_in_words(table, name) for name in varied}
    text = page("sweeps/sweep.md.j2", overview=overview(table, varied, statistics), drawn=drawn, **facts)
    (folder / "report.md").write_text(text, encoding="utf-8")
    (folder / "report.html").write_text(html(f"Sweep of {scene.name}", text), encoding="utf-8")
    return [*written, folder / "figures", folder / "report.html"]


def run(options):
    """Sweep, write and print what came out."""
    scene = load(options.scene, options.settings, quiet=True)  # `sweep` says what is in doubt
    if options.method == "sobol" and options.samples & (options.samples - 1):
        print(f"--samples is {options.samples}: the points of Sobol are balanced for powers of 2 only", file=sys.stderr)
    folder = options.out or Path("study") / f"{scene.name}_sweep"
    names = ("samples", "method", "seed", "settings", "outputs", "percentiles", "cycles_of", "start", "tether", "segments")
    given = {name: getattr(options, name) for name in (*names, "step", "processes", "dask")}
    try:
        with keeping():
            table = sweep(options.scene, options.vary, out=folder, **given)
    except (TypeError, ValueError) as error:
        raise WrongUse(str(error)) from None
    now("drawing")
    written = write(table, scene, config_of(scene, options.tether, options.segments, options.step), folder)
    refused = int((table.refused != "").sum())
    duration = "" if "duration" in table.attrs["varied"] else f" of {scene.duration:g} s"
    broken = int(table.break_time.notna().sum())
    broke = f", {broken} broke, as in flight {table.break_time.first_valid_index()}" if broken else ""
    print(f"{len(table)} flights{duration}, {refused} of them refused{broke}")
    if refused < len(table):
        k = int(table.peak_tension.idxmax())
        numbers = (name for name in table.attrs["varied"] if not isinstance(table[name][k], str))
        at = ", ".join(f"{name} = {table[name][k]:.4g}" for name in numbers)
        print(f"largest tension: {table.peak_tension[k]:.1f} N, in flight {k}: {at}")
    for path in written:
        print(path)
    return FAILED if refused == len(table) else 0
