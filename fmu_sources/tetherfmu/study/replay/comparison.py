"""How far are the tethers from the log? Residuals in metres and newtons, by phase and cycle, and the band they lie in."""

import numpy as np
import pandas as pd

from . import driven_tethers
from .columns import LABELS
from .flight import EVERY

MEAN = 1.0  # s, averaging time of tensions before comparison
SETTLED = 1.2  # s from the start that are not compared: a tether starts in equilibrium
ALL, NONE = "all", "not named"


def averaged(values):
    """Mean over `MEAN`, centred, of values every `EVERY`; a Series or an array, as array."""
    return pd.Series(np.asarray(values)).rolling(round(MEAN / EVERY), center=True, min_periods=1).mean().to_numpy()


def residuals(flight, flown):
    """Results of the tethers minus the log, a DataFrame with a row for each tether and time, with the labels of the log.

    flown : dict from the name of a tether to its `runs.Flown`.  Columns: `length`, of the unstretched lengths [m];
    `tension`, of the means over `MEAN` at the ground [N]; `measured`, the measured mean [N]; `band` [N], tension change
    of the taut tether by the noise of a position (`stiffness` [N/m] times noise), NaN while the tether is slack.
    """
    length, measured = flight.length(flight.times), averaged(flight.measured("ground_tension", flight.times))
    rows = np.clip(np.searchsorted(flight.log.time, flight.times, side="right") - 1, 0, None)
    labels = {name: flight.log.table[name].to_numpy()[rows] for name in LABELS if name in flight.log.table}
    parts = []
    for name, each in flown.items():
        table = each.table
        taut = flight.is_taut(table.tether_length.to_numpy())
        band = table.kite_stiffness.where(taut) * flight.log.map.smoothing.position_noise
        noise = {"stiffness": table.kite_stiffness, "band": band}
        found = {"length": table.tether_length - length, "tension": averaged(table.mean_tension) - measured}
        parts.append(pd.DataFrame({"time": flight.times, "tether": name, **found, "measured": measured, **noise} | labels))
    return pd.concat(parts, ignore_index=True)


def errors(found, start, lead):
    """Table of `residuals` by tether: over all, by phase and by cycle, except near the start [s].

    lead : quantity that drives the winch; it has no residual.
    """
    found, judged = found[found.time >= start + SETTLED], of_length if lead == "tension" else of_tension
    rows = []
    for label in (None, *(name for name in LABELS if name in found and found[name].nunique() > 1)):
        for keys, part in found.groupby(["tether", label] if label else ["tether"], sort=False):
            row = {"part": f"{label} {keys[1] or NONE}" if label else ALL, "tether": keys[0]}
            rows.append(row | {"time [s]": round(len(part) * EVERY, 1)} | judged(part))
    return pd.DataFrame(rows).dropna(axis=1, how="all")


def of_length(part):
    """Statistics of the length in a part of `residuals`, by the heads of the columns."""
    scatter = rms(part.length - part.length.mean())
    return {
        "measured tension [N]": part.measured.mean(),
        "length: mean [m]": part.length.mean(),
        "length: rms about mean [m]": scatter,
        "equivalent tension [N]": scatter * part.stiffness.mean(),
        "equivalent position noise [N]": part.band.mean(),
    }


def of_tension(part):
    """Statistics of the tension."""
    known = part[np.isfinite(part.tension)]
    alike = np.corrcoef(known.measured, known.measured + known.tension)[0, 1] if len(known) > 1 else np.nan
    return {
        "measured tension [N]": part.measured.mean(),
        "tension: mean [N]": part.tension.mean(),
        "tension: rms [N]": rms(part.tension),
        "correlation": round(alike, 3),
        "equivalent position noise [N]": part.band.mean(),
    }


def rms(values):
    """Root mean square of the known values; NaN if there are none."""
    known = values[np.isfinite(values)]
    return float(np.sqrt(np.mean(known**2))) if len(known) else np.nan


def rounded(errors):
    """A table of errors, see `errors`, for people: lengths to 1 cm, tensions to three digits, and to 0.1 N."""
    table = errors.copy()
    for head in table.columns:
        if head.endswith(" [m]"):
            table[head] = table[head].round(2) + 0.0  # not -0
        elif head.endswith(" [N]"):
            table[head] = table[head].map(lambda force: round(float(f"{force:.3g}"), 1) + 0.0)
    return table


def untrustworthy(found):
    """Fraction of the time in which the finest tether is taut, and the part of it in which noise exceeds tension.

    Noise: from positions only, as tension of the taut tether; tension: measured. NaN if it is never taut.
    """
    finest = found[(found.tether == driven_tethers.finest(found.tether.unique())) & np.isfinite(found.measured)]
    taut = finest[np.isfinite(finest.band)]
    share = float((taut.band > taut.measured.abs()).mean()) if len(taut) else np.nan
    return len(taut) / max(1, len(finest)), share
