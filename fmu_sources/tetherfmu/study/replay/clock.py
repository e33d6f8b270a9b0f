"""The time of a log: texts, Unix time, whole seconds, rows that are there twice or in the wrong order."""

import numpy as np
import pandas as pd

MILLISECONDS = 1e11  # s, after which no flight was: Unix time in a smaller unit
WHOLE = 3.0  # rows of the same time, on average, from which on times are taken as rounded
MOST_BACK = 0.05  # of the rows that may stand before the row above them


def repaired(cells, factor, report):
    """Times [s] of a column of texts, from 0 on and growing, array (kept,), and the rows that they belong to.

    factor : of the unit of the column.  ValueError if these are no times of a flight.
    """
    time, total = seconds(cells, factor, report), len(cells)
    rows = np.flatnonzero(np.isfinite(time))
    report.count("dropped", total - len(rows), total, "which have no time")
    if len(rows) < 2:
        raise ValueError(f"the column {cells.name} has no times")
    time = time[rows]
    if np.abs(time).max() > MILLISECONDS:
        raise ValueError(f"{cells.name} is {time[0]:.6g} s; is it in another unit? time.unit may be ms, min, h")
    if np.all(np.diff(time) <= 0.0) and time[0] > time[-1]:
        time, rows = time[::-1], rows[::-1]
        report.say("reversed: the time falls from row to row")
    if len(time) > WHOLE * len(np.unique(time)):
        time = spread(time, report)
    order = np.concatenate([[True], time[1:] > np.maximum.accumulate(time)[:-1]])
    back = np.concatenate([[False], np.diff(time) < 0.0])
    if back.mean() > MOST_BACK:
        raise ValueError(f"{cells.name} goes back in {int(back.sum())} of {total} rows; it must grow from row to row")
    report.count("dropped", int((~order).sum()), total, "whose time is that of a row above, or before it")
    time, rows = time[order], rows[order]
    if len(time) < 2 or time[-1] <= time[0]:
        raise ValueError(f"{cells.name} does not grow: {time[0]:g} in all rows")
    report.say(f"time from 0 at {cells.name} = {cells.iloc[rows[0]]}, {time[-1] - time[0]:.1f} s")
    return time - time[0], rows


def seconds(cells, factor, report):
    """Times [s] of texts, numbers or dates, array (rows,); NaN for others."""
    found = pd.to_numeric(cells, errors="coerce").to_numpy(float, copy=True)
    found[~np.isfinite(found)] = np.nan
    if np.isfinite(found).sum() * 2 < len(cells):
        dates = pd.to_datetime(cells, errors="coerce", format="mixed", utc=True)
        if dates.notna().sum() * 2 > len(cells):
            report.say(f"{cells.name} has dates")
            return (dates - pd.Timestamp(0, tz="UTC")).dt.total_seconds().to_numpy()
    return found * factor


def spread(time, report):
    """Times of rows whose clock was rounded: rows of the same time lie evenly in it; those of a part of it at its side."""
    values, first, counts = np.unique(time, return_index=True, return_counts=True)
    if np.any(np.diff(time) < 0.0):
        raise ValueError(f"time goes back after {time[np.argmax(np.diff(time) < 0.0)]:g} s")
    whole, width = int(np.median(counts)), float(np.median(np.diff(values))) if len(values) > 1 else 1.0
    shift = np.maximum(whole, counts)  # rows of a time that has more are as close as they must be
    start = np.where(np.arange(len(values)) == 0, shift - counts, 0)
    place = np.arange(len(time)) - np.repeat(first, counts) + np.repeat(start, counts)
    report.say(f"spread: times are rounded to {width:g} s; the {whole} rows of each lie evenly in it")
    return time + width * place / np.repeat(shift, counts)
