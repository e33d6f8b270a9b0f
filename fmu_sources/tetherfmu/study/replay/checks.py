"""Do the quantities of a log fit each other? Positions, velocities, lengths, speeds and tensions in one system of units."""

import numpy as np

from tetherfmu.runtime.inputs import components

from .log import LogError

WINDOW = 1.0  # s, over which motions are compared
FEWEST = 10  # of them
MOVING = 1.0  # m/s, standard deviation of a component from which on it can be compared
NEAR = 0.3  # of a factor to 1
FARTHEST = 1.1  # distance of the kite over the length of the tether, 95th percentile
NEAREST = 0.4  # the same, at its largest
FORCE_COEFFICIENTS = 0.02, 2.5  # of a kite: tension over dynamic pressure and area, 95th percentile
AXES = ("east", "north", "up")


def check(log):
    """LogError if two quantities of a log contradict each other as wrong units, axes or signs do; doubts go to its report."""
    position = log.of(components("kite_position", 3)) - np.array(log.map.station.outlet)
    velocity = log.of(components("kite_velocity", 3))
    radial = rates(log.time, np.linalg.norm(position, axis=1)[:, None])
    checked = []
    if velocity is not None:
        check_velocity(rates(log.time, position), means(log.time, velocity))
        checked.append("positions with velocities")
    if "tether_length" in log.table:
        check_length(np.linalg.norm(position, axis=1), log.table["tether_length"].to_numpy(), log.report)
        checked.append("distance with tether_length")
    if "reel_out_speed" in log.table:
        speed = means(log.time, log.table[["reel_out_speed"]].to_numpy())
        if "tether_length" in log.table:
            check_factor(rates(log.time, log.table[["tether_length"]].to_numpy()), speed, "tether_length", log.report)
        else:
            check_factor(radial, speed, "the distance of the kite", log.report)
        checked.append("reel_out_speed with what it changes")
    if "ground_tension" in log.table:
        checked += check_tension(log)
    log.report.say(f"fit each other: {', '.join(checked) or 'nothing to compare'}")


def windows(time):
    """Pairs of rows (first, behind the last) of windows of `WINDOW`."""
    edges = np.arange(time[0], time[-1], WINDOW)
    places = np.searchsorted(time, edges)
    return list(zip(places[:-1], places[1:], strict=True))


def rates(time, values):
    """Rates of change over windows, array (windows, columns); NaN where a reading is missing."""
    pairs = [(i, min(j, len(time) - 1)) for i, j in windows(time)]
    return np.array([(values[j] - values[i]) / (time[j] - time[i]) if j > i else values[i] * np.nan for i, j in pairs])


def means(time, values):
    """Means over the same windows."""
    return np.array([values[i : j + 1].mean(axis=0) for i, j in windows(time)])


def check_velocity(moved, velocity):
    """LogError unless the change of positions is the velocity, both arrays (windows, 3) [m/s]."""
    known = np.isfinite(moved).all(axis=1) & np.isfinite(velocity).all(axis=1)
    moves = np.flatnonzero(velocity[known].std(axis=0) > MOVING) if known.sum() >= FEWEST else []
    if len(moves) == 0:
        return
    moved, velocity = moved[known] - moved[known].mean(axis=0), velocity[known] - velocity[known].mean(axis=0)
    factors = robust(velocity[:, moves], moved)
    for row, axis in zip(factors, moves, strict=True):
        if np.abs(row - np.eye(3)[axis]).max() > NEAR:
            way = ", ".join(f"{each:.2g}" for each in row)
            raise LogError(
                f"kite_velocity and kite_position do not fit: for each metre {AXES[axis]} by the velocity the position moves "
                f"({way}) m east, north, up; check columns, signs and units of both, or leave kite_velocity out"
            )


def robust(a, b):
    """Least squares of a x = b, array (columns of a, columns of b), without the rows that fit worst, a tenth."""
    keep = np.ones(len(a), bool)
    for _ in range(3):
        found = np.linalg.lstsq(a[keep], b[keep], rcond=None)[0]
        rest = np.linalg.norm(b - a @ found, axis=1)
        keep = rest <= np.quantile(rest, 0.9)
    return found


def check_length(distance, length, report):
    """LogError if the kite is farther away than the tether is long; a doubt if it is always near."""
    known = np.isfinite(distance) & np.isfinite(length)
    ratio = distance[known] / length[known]
    if not len(ratio):
        return
    far = np.quantile(ratio, 0.95)
    if far > FARTHEST:
        raise LogError(
            f"the kite is {far:.3g} times as far away as tether_length says (in 5 % of the rows, or farther); check the units "
            "of both, the origin, and what length is counted"
        )
    if far < NEAREST:
        report.doubt(f"the kite is never farther away than {far:.2g} times tether_length: are both in the same unit?")


def check_factor(rate, speed, what, report):
    """LogError unless the length, or the distance, changes as the reel-out speed says, arrays (windows, 1) [m/s]."""
    known = np.isfinite(rate[:, 0]) & np.isfinite(speed[:, 0])
    if known.sum() < FEWEST or speed[known].std() < 0.3:
        return
    (factor,) = robust(speed[known], rate[known])[0]
    if abs(factor - 1.0) > 2.0 * NEAR:
        raise LogError(
            f"{what} changes by {factor:.2g} m for each metre of reel_out_speed; check the sign (positive pays out) and units"
        )
    if abs(factor - 1.0) > NEAR:
        report.doubt(f"{what} changes by {factor:.2g} m for each metre of reel_out_speed")


def check_tension(log):
    """Doubt a tension that is negative, or too large or too small for the kite; what was compared."""
    tension, area = log.table["ground_tension"].to_numpy(), log.map.kite.area
    if np.nanmedian(tension) < 0.0:
        raise LogError(f"ground_tension is {np.nanmedian(tension):.4g} N in the middle; a tether pulls, so check its sign")
    if "airspeed" not in log.table or not area:
        log.report.doubt("the size of ground_tension is not checked: the map has no column airspeed, or no kite.area")
        return []
    pressure = 0.5 * log.map.environment.air_density * log.table["airspeed"].to_numpy() ** 2 * area
    fast = np.isfinite(pressure) & np.isfinite(tension) & (pressure > np.nanmedian(pressure))
    found = np.quantile(tension[fast] / pressure[fast], 0.95) if fast.any() else 1.0
    low, high = FORCE_COEFFICIENTS
    if not low <= found <= high:
        log.report.doubt(
            f"ground_tension is {found:.2g} times dynamic pressure and area of the kite; from {low:g} to {high:g} are usual: "
            "check its unit (N, kgf, kN)"
        )
    return ["ground_tension with airspeed and area"]
