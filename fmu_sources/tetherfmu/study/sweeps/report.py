"""Results of a sweep: tables, figures, one page with the worst flights; and its command."""

import shlex
import sys
from contextlib import suppress
from importlib.util import find_spec
from itertools import combinations
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from tetherfmu.console.colours import BLUE, VERMILLION
from tetherfmu.console.ending import FAILED, remedy
from tetherfmu.console.progress import now
from tetherfmu.files.toml_files import WrongUse
from tetherfmu.runtime.naming import prefixed
from tetherfmu.study.advice.scene_report import html
from tetherfmu.study.measuring.runs import Config
from tetherfmu.study.measuring.store import keeping
from tetherfmu.study.measuring.tables import page

from .statistics import BINS_PER_DECADE
from .sweep import subject_of, sweep

MOST_STEPS = 20  # different values that are joined by their medians
# main questions, if the answer varies, and whether larger is worse
SHOWN = {"peak_tension": True, "power_mean": False, "largest_cycle": True, "time_slack": True}
MOST_VARIED = 4  # columns of the figure


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


def places(values):
    """Numbers of a varied value, and labels for values without numbers."""
    if pd.api.types.is_numeric_dtype(values):
        return values.to_numpy(dtype=float), None
    return pd.factorize(values)


def draw_over(axis, table, varied, statistic):
    """Draw a statistic of all flights over a varied value, with medians where there are few values."""
    x, names = places(table[varied])
    if names is not None:
        axis.set_xticks(range(len(names)), names, rotation=30, ha="right", fontsize=8)
    axis.plot(x, table[statistic], ".", color=BLUE, markersize=4, alpha=0.5, label="flights")
    medians = table[statistic].groupby(x).median()
    if len(medians) <= MOST_STEPS and len(medians) < len(table):
        axis.plot(medians, "-o", color=VERMILLION, markersize=4, linewidth=1.2, label="medians")
    axis.grid(alpha=0.3)


def draw_response(table, varied, statistics, path):
    """Draw statistics (rows) over varied values (columns) in one figure."""
    units, varied = table.attrs["units"], varied[:MOST_VARIED]
    figure = Figure(figsize=(1.0 + 3.6 * len(varied), 0.6 + 2.3 * len(statistics)), layout="constrained")
    panels = figure.subplots(len(statistics), len(varied), sharex="col", sharey="row", squeeze=False)
    for line, statistic in zip(panels, statistics, strict=True):
        for axis, name in zip(line, varied, strict=True):
            draw_over(axis, table, name, statistic)
        line[0].set_ylabel(with_unit(statistic, units))
    for axis, name in zip(panels[-1], varied, strict=True):
        axis.set_xlabel(with_unit(name, units))
    if panels[0, 0].get_legend_handles_labels()[1][1:]:
        panels[0, 0].legend(frameon=False, fontsize=8)
    figure.savefig(path, dpi=90, metadata={"Software": None})


def draw_surface(table, first, second, statistic, path):
    """Draw a statistic as colour over two varied numbers; where flights were refused or broke, crosses."""
    units, known = table.attrs["units"], table[table[statistic].notna()]
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    axis = figure.subplots()
    drawn = None
    if known[first].nunique() > 2 and known[second].nunique() > 2 and len(known) > 5:
        with suppress(RuntimeError, ValueError):  # of points that are on one line
            drawn = axis.tricontourf(known[first], known[second], known[statistic], levels=12)
    dots = axis.scatter(known[first], known[second], c=known[statistic], s=24, edgecolors="white", linewidths=0.5)
    figure.colorbar(drawn or dots, ax=axis, label=with_unit(statistic, units))
    for label, rows, marker in (("refused", table.refused != "", "x"), ("broke", table.broken == 1.0, "+")):
        if rows.any():
            axis.scatter(table[first][rows], table[second][rows], c=VERMILLION, marker=marker, s=40, label=label)
            axis.legend(fontsize=8)
    axis.set(xlabel=with_unit(first, units), ylabel=with_unit(second, units))
    figure.savefig(path, dpi=90, metadata={"Software": None})


def shown_in(table):
    """Columns that answer the main questions, and whether larger is worse: of a system the power of each winch."""
    return {name: SHOWN[each] for each in SHOWN for name in table if name == each or name.endswith(f".{each}")}


def draw_all(table, varied, folder):
    """Draw the main figures; paths in the folder of the page, dict by title."""
    folder.mkdir(exist_ok=True)
    for name in ("response", "surface"):  # of a sweep that was continued with other values
        (folder / f"{name}.png").unlink(missing_ok=True)
    differs = [name for name in shown_in(table) if table[name].nunique() > 1]
    shown, drawn = differs or ["peak_tension"], {}
    if table[shown[0]].notna().any():
        drawn["Over each varied value"] = f"{folder.name}/response.png"
        draw_response(table, varied, shown, folder / "response.png")
    numeric = [name for name in varied if pd.api.types.is_numeric_dtype(table[name]) and table[name].nunique() > 1]
    for first, second in list(combinations(numeric, 2))[:1]:
        if table[shown[0]].notna().any():
            drawn[f"{shown[0]} over {first} and {second}"] = f"{folder.name}/surface.png"
            draw_surface(table, first, second, shown[0], folder / "surface.png")
    return drawn


def worst_flights(table, varied, scene, config, settings):
    """The worst flight for each main question, and how to repeat it: a DataFrame.

    scene : file or name.  config : `Config` or `SystemConfig`, settings : pairs, of all flights.
    """
    rows, same = [], f" --step {config.step:g}"
    if isinstance(config, Config):  # of a scene
        same = f" --tether {config.variant}{same}" + (f" --set segments={config.segments}" if config.segments else "")
    for name, is_large in shown_in(table).items():
        if table[name].nunique() < 2:
            continue
        k = int(table[name].idxmax() if is_large else table[name].idxmin())
        values = [*settings, *((each, table[each][k]) for each in varied)]
        again = " ".join(f"--set {each}={shlex.quote(in_toml(value))}" for each, value in values)
        row = {"worst": with_unit(name, table.attrs["units"]), "value": float(table[name][k]), "flight": k}
        rows.append(row | {"to fly it": f"`tetherfmu fly {scene}{same} {again}`"})
    return pd.DataFrame(rows)


def in_toml(value):
    """A value in the form of --set."""
    return repr(value.item() if isinstance(value, np.generic) else value) if not isinstance(value, str) else value


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
    """A varied value for people."""
    values = table[name]
    if not pd.api.types.is_numeric_dtype(values):
        return f"{values.nunique()} values: {', '.join(map(str, values.unique()[:5]))}"
    return f"{values.nunique()} values from {values.min():.4g} to {values.max():.4g}"


def reasons_of(table):
    """How often flights were refused, by reason, and one of them: a DataFrame."""
    refused = table[table.refused != ""].refused
    reasons = refused.str.replace(r"\d[\d.e+-]*", "#", regex=True)  # the same except for numbers
    rows = [(len(each), int(each.index[0]), refused[each.index[0]]) for _, each in refused.groupby(reasons, sort=False)]
    return pd.DataFrame(sorted(rows, reverse=True), columns=["flights", "such as flight", "reason"])


def write(table, scene, config, folder, asked=None, settings=()):
    """Write all to a folder (Path): tables, figures, report.md and report.html; paths for people.

    asked : file or name of the scene, None: its name.  settings : pairs, of all flights.
    """
    varied = table.attrs["varied"]
    statistics = [name for name in table.attrs["units"] if name not in varied]
    written = write_tables(table, folder)
    facts = {"table": table, "scene": scene, "config": config, "reasons": reasons_of(table)}
    facts |= {"drawn": draw_all(table, varied, folder / "figures"), "files": [path.name for path in written]}
    facts["worst"] = worst_flights(table, varied, asked or scene.name, config, settings)
    facts["varied"] = {with_unit(name, table.attrs["units"]): values_in_words(table, name) for name in varied}
    text = page("sweeps/sweep.md.j2", overview=overview(table, varied, statistics), **facts)
    (folder / "report.md").write_text(text, encoding="utf-8")
    (folder / "report.html").write_text(html(f"Sweep of {scene.name}", text), encoding="utf-8")
    return [*written, folder / "figures", folder / "report.html"]


def run(options):
    """Sweep, write and print the results."""
    tether, segments = options.tether, options.segments
    with prefixed("", WrongUse):  # `sweep` prints doubts
        subject = subject_of(options.scene, options.settings, tether, segments, options.step, quiet=True)
    scene, config = subject.base, subject.config
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
    written = write(table, scene, config, folder, options.scene, options.settings)
    refused = int((table.refused != "").sum())
    duration = "" if "duration" in table.attrs["varied"] else f" of {scene.duration:g} s"
    broken = int(table.break_time.notna().sum())
    how = "broke or let go" if (scene.flight if isinstance(config, Config) else scene).has_release else "broke"
    broke = f", {broken} {how}, as in flight {table.break_time.first_valid_index()}" if broken else ""
    print(f"{len(table)} flights{duration}, {refused} of them refused{broke}")
    if refused < len(table):
        k = int(table.peak_tension.idxmax())
        numbers = (name for name in table.attrs["varied"] if not isinstance(table[name][k], str))
        at = ", ".join(f"{name} = {table[name][k]:.4g}" for name in numbers)
        print(f"largest tension: {table.peak_tension[k]:.1f} N, in flight {k}: {at}")
    for path in written:
        print(path)
    return FAILED if refused == len(table) else 0
