"""What is done to the table of a known flight, and what must be the same of it all the same."""

import numpy as np

from tetherfmu.libraries.examples import EXAMPLES

CYCLE = EXAMPLES / "flights" / "kitepower_20191008_0012.csv"
KEPT = ("time", "kite_pos_east", "kite_pos_north", "kite_height", "ground_tether_force", "ground_tether_reelout_speed")
FORCE, SPEED_2019 = "ground_tether_force", "ground_tether_reelout_speed"
ROUNDED = 0.02  # m, m/s: what millimetres and 1e-8 deg in a log, smoothed, come to, ten times
FEW = 0.5  # m, m/s: of a smoothed motion where a second, or a part of the readings, is missing
RATHER = 1.0  # of the largest tension [%], where it is interpolated over two tenths of a second; over 1 s: 6


def texts(table):
    """The same table with its cells as texts."""
    return table.astype(object).map(lambda cell: cell if isinstance(cell, str) else f"{cell:.10g}")


def put(table, column, rows, cell):
    """The same table with a text in some rows of a column."""
    table = texts(table)
    table.loc[rows, column] = cell
    return table


def changed(table, **columns):
    """The same table with other columns; each is a function of the old one."""
    return table.assign(**{name: function(table[name]) for name, function in columns.items()})


def on(names, function):
    """Function of a table: the same one with these columns changed."""
    return lambda table: changed(table, **dict.fromkeys(names.split(), function))


def scaled(names, factor):
    """Function of a table: the same one with these columns multiplied."""
    return on(names, lambda column: factor * column)


def shifted(names, by):
    """Function of a table: the same one with a number added to these columns."""
    return on(names, lambda column: column + by)


def within(names, rows, function):
    """Function of a table: the same one with these columns changed in some rows."""
    return on(names, lambda column: column.where(~column.index.isin(rows), function(column)))


def held_from(names, rows):
    """Function of a table: the same one with these columns in some rows as in the first of them."""
    return within(names, rows, lambda column: column[rows[0]])


def swapped(one, other):
    """Function of a table: the same one with the names of two columns swapped."""
    return lambda table: table.rename(columns={one: other, other: one})


def without(names):
    """Function of a table: the same one without these columns."""
    return lambda table: table.drop(columns=names.split())


def lines_of(table):
    """Lines of the log."""
    return table.to_csv(index=False).splitlines()


def with_decimal_commas(table, separator=";"):
    return texts(table).map(lambda cell: cell.replace(".", ",")).to_csv(index=False, sep=separator)


def as_whole_numbers(table):
    """The same table with coordinates in 1e-7 deg."""
    return table.assign(lat=(table["lat"] * 1e7).round(), lon=(table["lon"] * 1e7).round())


def spread_over(count, seed=1):
    """A part of the rows, one in `count`, at random, neither the first nor the last ones."""
    rows = np.arange(30, 1100)
    return np.sort(np.random.default_rng(seed).choice(rows, len(rows) // count, replace=False))


def held(table, names, rows):
    """The same table, in which some columns change only every few rows, as those of a slower sensor."""
    return table.assign(**{name: table[name].where(table.index % rows == 0).ffill() for name in names})


def of_the_day(time):
    """Times of the day, hh:mm:ss.fff, the first of which is one minute before midnight."""
    at = 86340.0 + np.asarray(time)
    return [f"{int(t // 3600) % 24:02d}:{int(t // 60) % 60:02d}:{t % 60:06.3f}" for t in at]


def assert_same(found, unbroken, motion, tension, shift=0.0):
    """The motion [m, m/s], the length [m] and the tension [% of its largest] are those of the unbroken log.

    shift : by how much later the log begins [s].  The first and last second are left out: nothing is known beyond them.
    """
    time = np.arange(1.0, min(found.end, unbroken.end - shift) - 1.0, 0.1)
    assert time[-1] > 100.0
    for mine, right in zip(found.kite(time), unbroken.kite(time + shift), strict=True):
        assert np.abs(mine - right).max() < motion
    mine, right = (found.measured("ground_tension", time), unbroken.measured("ground_tension", time + shift))
    assert np.abs(mine - right).max() < 0.01 * tension * right.max()
    mine, right = found.length(time), unbroken.length(time + shift)
    assert np.abs(mine - mine[0] - right + right[0]).max() < max(0.1, motion)
    if "tether_length" in unbroken.log.table:
        assert np.abs(mine - right).max() < max(0.1, motion)
