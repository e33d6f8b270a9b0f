"""The time of a log: texts, Unix time, whole seconds, rows that are there twice or in the wrong order."""

from bisect import bisect_right

import numpy as np
import pandas as pd

HUGE = 1e100  # of whatever unit: no number
LATEST = 1e11  # s, after which no flight was: Unix time in a smaller unit
LONGEST_STEP = 10.0  # s from row to row: time in a smaller unit
ROUNDED = 1.5  # mean number of rows with equal time above which times count as rounded
SAME = 0.9  # of the rows with equal times: with so many copies, rows are copied, not times rounded
MOST_BACK = 0.05  # of the rows: largest share of inconsistent times
DAY = 86400.0  # s
OF_DAY = r"\d{1,2}:\d{2}:\d{2}([.,]\d*)?"  # a time of the day, hours first
ALLOWED = "numbers, dates such as 2019-10-08 13:12:08.8, or times of the day such as 13:12:08.8"


def repaired(cells, column, factor, report):
    """Times [s] of the rows of a log, increasing, array (kept,), and these rows.

    cells : DataFrame of texts.  column, factor : of the time, and from its unit to s.  ValueError for invalid flight
    times.
    """
    time = seconds(cells[column], factor, report)
    rows = np.flatnonzero(np.isfinite(time))
    if len(rows) * 2 < len(time):
        raise ValueError(f"{column} has no time in {len(time) - len(rows)} of {len(time)} rows; it must have {ALLOWED}")
    if np.median(np.abs(time[rows])) > LATEST:
        raise ValueError(f"{column} is {np.median(time[rows]):.6g} s; is it in another unit? time.unit may be ms, us, ns")
    rows = rows[np.abs(time[rows]) <= LATEST]
    report.count("dropped", len(time) - len(rows), len(time), "which have no time")
    if np.all(np.diff(time[rows]) <= 0.0) and time[rows[0]] > time[rows[-1]]:
        rows = rows[::-1]
        report.say("reversed: the time falls from row to row")
    time = past_midnight(time[rows], report)
    time, rows = in_order(time, rows, cells, column, report)
    if time[0] == time[-1]:
        raise ValueError(f"{column} does not grow: {cells[column].iloc[rows[0]]} in all rows")
    time, rows = apart(time, rows, cells, report)
    if np.median(np.diff(time)) > LONGEST_STEP:
        raise ValueError(
            f"{column} grows by {np.median(np.diff(time)):.3g} s from row to row; {LONGEST_STEP:g} s at most is allowed; is "
            "it in another unit? time.unit may be ms, us, ns"
        )
    report.say(f"time from 0 at {column} = {cells[column].iloc[rows[0]]}, {time[-1] - time[0]:.1f} s")
    return time, rows


def seconds(cells, factor, report):
    """Times [s] of a column of numbers, dates, or times of the day, array (rows,); NaN for others."""
    found = pd.to_numeric(cells, errors="coerce").to_numpy(float, copy=True)
    found[~(np.abs(found) < HUGE)] = np.nan
    if np.isfinite(found).sum() * 2 >= len(cells):
        return found * factor
    of_day = cells.where(cells.str.fullmatch(OF_DAY)).str.replace(",", ".", regex=False)
    times = pd.to_timedelta(of_day, errors="coerce")
    if times.notna().sum() * 2 >= len(cells):
        report.say(f"{cells.name} is the time of the day")
        return times.dt.total_seconds().to_numpy()
    dates = pd.to_datetime(cells, errors="coerce", format="ISO8601", utc=True)
    if dates.notna().sum() * 2 >= len(cells):
        report.say(f"{cells.name} has dates")
        return (dates - pd.Timestamp(0, tz="UTC")).dt.total_seconds().to_numpy()
    return np.full(len(cells), np.nan)


def past_midnight(time, report):
    """Times [s] that continue after midnight, where a time of day restarts."""
    if not np.all((time >= 0.0) & (time <= DAY)):
        return time
    days = np.concatenate([[0], np.cumsum(np.diff(time) < -0.99 * DAY)])
    if days[-1]:
        report.say(f"midnight: the time of the day restarts {days[-1]} times")
    return time + DAY * days


def in_order(time, rows, cells, column, report):
    """Times and rows without those that do not fit in with the others; ValueError if there are many."""
    kept = never_falling(time)
    if len(time) - len(kept) > MOST_BACK * len(time):
        k = int(np.argmax(np.diff(time) < 0.0))
        raise ValueError(
            f"{column} goes back: {len(time) - len(kept)} of {len(time)} rows are in the wrong order, the first after "
            f"{time[k]:.10g} s, where {time[k + 1]:.10g} s follows at row {cells.index[rows[k + 1]]} of the file; is this "
            "more than one log?"
        )
    report.count("dropped", len(time) - len(kept), len(time), "whose time does not fit in between those of the rows around")
    return time[kept], rows[kept]


def never_falling(time):
    """Places of the longest part of some numbers that never falls, array (kept,); found by patience sorting."""
    if np.all(np.diff(time) >= 0.0):
        return np.arange(len(time))
    last, places, before = [], [], []  # for the best part of each length: its last number, and its place
    for place, number in enumerate(time.tolist()):
        k = bisect_right(last, number)
        before.append(places[k - 1] if k else -1)
        last[k : k + 1], places[k : k + 1] = [number], [place]
    kept = [places[-1]]
    while before[kept[-1]] >= 0:
        kept.append(before[kept[-1]])
    return np.array(kept[::-1])


def apart(time, rows, cells, report):
    """Times and rows so that no two have the same time: copies of a row are dropped, rows of a rounded time are spread."""
    again = np.concatenate([[False], np.diff(time) == 0.0])
    if not again.any():
        return time, rows
    copies = cells.iloc[rows].duplicated().to_numpy() & again
    if copies.sum() >= SAME * again.sum():
        report.count("dropped", int(copies.sum()), len(rows), "which are copies of the row above")
        time, rows, again = time[~copies], rows[~copies], again[~copies]
    elif len(time) > ROUNDED * (len(time) - again.sum()):
        return spread(time, report), rows
    report.count("dropped", int(again.sum()), len(rows), "whose time is that of the row above")
    return time[~again], rows[~again]


def spread(time, report):
    """Times of rows with a rounded clock: rows with equal time are distributed evenly; at the margins on one side."""
    values, first, counts = np.unique(time, return_index=True, return_counts=True)
    inner = counts[1:-1] if len(counts) > 2 else counts  # the first and the last one may be parts
    whole, width = int(np.median(inner)), float(np.median(np.diff(values)))
    shift = np.maximum(whole, counts)  # rows of a time that has more are as close as they must be
    start = np.where(np.arange(len(values)) == 0, shift - counts, 0)
    place = np.arange(len(time)) - np.repeat(first, counts) + np.repeat(start, counts)
    report.say(f"spread: times are rounded to {width:g} s; the {whole} rows of each are spaced evenly")
    return time + width * place / np.repeat(shift, counts)
