"""Are the quantities of a log consistent? Positions, velocities, lengths, speeds and tensions in one system of units."""

import numpy as np
from scipy.interpolate import CubicSpline

from tetherfmu.files.toml_files import factors
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.parameters import Tether
from tetherfmu.runtime.plausibility import LARGEST_STRETCH, NEARBY
from tetherfmu.runtime.quantities import doubts_of

from . import delays
from .log import UNCHECKED
from .readings import FASTEST, POSITION, VELOCITY, WIND, between

WINDOW = 1.0  # s, length of compared motions
FEWEST = 4  # of them
UNEXPLAINED = 0.7  # part of the motion that the velocity need not explain
IMPOSSIBLE_NOISE = 10.0  # m/s, in rates of positions over windows, which no receiver has
MOVING = 1.0  # m/s, root mean square motion required for a comparison
REELING = 0.3  # m/s, likewise of a reel-out speed
BLOWING = 2.0  # m/s, mean wind required for a direction
NEAR = 0.3  # distance of a factor from 1, in addition to noise
OFFSET = 0.3  # m/s, doubtful offset of a velocity or a speed, in addition to noise
RANGE_OF_LENGTH = 10.0  # m, standard deviation of a length required for a factor
NOISE = 3.0  # standard deviations of a factor that noise explains
MANY = 20  # rows required to omit those that fit worst
FARTHEST = 1.1  # distance of the kite over the length of the tether, 95th percentile
DOUBTFUL = 1.02  # doubtful value
NEAREST = 0.4  # the same, at its largest
TAUT = 10.0  # tension over weight above which the tether is nearly straight
LEAST_TAUT = 0.97  # median of distance over length while it is
SLACK = 3.0  # tension over the weight of the tether, median, below which it is hardly taut
FORCE_COEFFICIENTS = 0.2, 1.0  # of a soft kite: tension over dynamic pressure and area, median; kgf for N is outside
ZERO = 0.3  # doubtful tension without airspeed over the median of the rest; flights of soft kites have up to 0.2
AIRSPEEDS = 0.4, 2.5  # airspeed over the speed of the kite in the wind, median; km/h for m/s is outside
FLYING = 3.0  # m/s, minimum airspeed of a flying kite
WINDS = 0.33, 3.0  # factor between wind and airspeed; km/h for m/s is outside
FACTORS = np.linspace(0.0, 5.0, 101)  # of the wind that are tried
AXES = ("east", "north", "up")


def check(log):
    """`LogError` if two quantities of a log contradict each other like wrong units, axes or signs; doubts go to its report.

    A quantity that cannot be compared is also a doubt.
    """
    log = delays.moved_by(log, vars(log.map.delay))
    position = log.of(POSITION) - np.array(log.map.station.outlet)
    done, undone = [], []
    clocks = delays.found(log, position)
    delays.judge(log, clocks)
    log = delays.with_one_clock(log, clocks)  # otherwise a delay looks like a wrong sign or unit
    position = log.of(POSITION) - np.array(log.map.station.outlet)
    for name, compare in COMPARISONS.items():
        found = compare(log, position)
        done += [name] if found else []
        undone += [name] if found is False else []
    below = 100.0 * np.nanmean(position[:, 2] < 0.0)
    if below > 50.0:
        log.report.doubt(
            f"kite_position is below the outlet of the winch in {below:.0f} % of the rows; check the axis that points up"
        )
    judge_what_is_not_said(log)
    with_delays = " with these delays removed" if any(each.is_clear for each in clocks) else ""
    log.report.say(f"consistent{with_delays}: {', '.join(done) or 'nothing to compare'}")
    if undone:
        log.report.doubt(f"{UNCHECKED}: {'; '.join(f'{name} ({why_unchecked(log, name)})' for name in undone)}")


def why_unchecked(log, name):
    """Why one of `COMPARISONS` has no result."""
    given = {each.partition("[")[0] for each in log.table} | ({"kite.area"} if log.map.kite.area else set())
    missing = [word for word in name.split() if word in COMPARED and word not in given]
    return f"the log has no {' and no '.join(missing)}" if missing else "too little data"


def edges(time):
    """Rows at which windows of `WINDOW` begin, fewer than rows and than seconds + 2, array (windows + 1,)."""
    return np.unique((time - time[0]) // WINDOW, return_index=True)[1]


def known(time, values, longest_gap):
    """Values [any] at the edges of windows, array (windows + 1, columns), linear between readings; NaN in longer gaps."""
    places = edges(time)
    found = np.full((len(places), values.shape[1]), np.nan)
    for k, column in enumerate(values.T):
        there = np.isfinite(column)
        if there.sum() > 1:
            found[:, k] = between(time[places], time[there], column[there], longest_gap)
    return found


def rates(log, values):
    """Mean rates of change of values, array (rows, columns), over windows, array (windows, columns); NaN: not known."""
    found = known(log.time, values, log.map.smoothing.longest_gap)
    return np.diff(found, axis=0) / np.diff(log.time[edges(log.time)])[:, None]


def means(log, values):
    """Means of values over windows, likewise: of the cubic splines through their readings."""
    integrals = np.full(values.shape, np.nan)
    for k, column in enumerate(values.T):
        there = np.isfinite(column)
        if there.sum() >= 4:
            integrals[there, k] = CubicSpline(log.time[there], column[there]).antiderivative()(log.time[there])
    return rates(log, integrals)


def compare_speed(log, position):
    """Whether the kite is known to move at a possible speed; LogError if it is impossible."""
    speed = np.linalg.norm(rates(log, position), axis=1)
    if not np.isfinite(speed).any():
        return False
    if np.nanmedian(speed) > FASTEST:
        raise log.wrong(f"kite_position moves by {np.nanmedian(speed):.4g} m/s; check its unit, and that of the time")
    return True


def compare_velocity(log, position):
    """Whether positions change according to the velocity; LogError if not."""
    if log.of(VELOCITY) is None:
        return False
    moved, velocity = rates(log, position), means(log, log.of(VELOCITY))
    both = np.isfinite(moved).all(axis=1) & np.isfinite(velocity).all(axis=1)
    if both.sum() < FEWEST:
        return False
    moved, velocity = moved[both], velocity[both]
    ways = ways_of(velocity)
    if len(ways):
        for way, found, noise in zip(ways, *robust(velocity @ ways.T, moved), strict=True):
            if np.abs(found - way).max() > NEAR + NOISE * noise:
                raise log.wrong(
                    f"kite_velocity contradicts kite_position: where the velocity says {in_words(way)}, the position "
                    f"changes by {in_words(found)}; check columns, axes, signs and units of both, or leave kite_velocity out"
                )
    doubt_offset(log, "kite_velocity", moved - velocity, "the change of kite_position")
    rest, moves = np.median(np.linalg.norm(moved - velocity, axis=1)), np.median(np.linalg.norm(moved, axis=1))
    text = f"the position moves at {moves:.3g} m/s and differs from the velocity by {rest:.3g} m/s; check columns, axes"
    if rest > max(UNEXPLAINED * moves, IMPOSSIBLE_NOISE):
        raise log.wrong(f"kite_velocity contradicts kite_position: {text}, signs and units of both")
    if rest > max(UNEXPLAINED * moves, NOISE * (MOVING + log.map.smoothing.position_noise / WINDOW)):
        log.report.doubt(
            f"kite_velocity explains little of the motion of kite_position: {text}, and smoothing.position_noise"
        )
    return len(ways) > 0 or moves < MOVING


def doubt_offset(log, name, rest, reference):
    """Doubt a velocity or a speed that always differs from its reference; rest : differences, array (windows, axes)."""
    middle = np.median(rest, axis=0)
    noise = NOISE * 1.25 * np.std(rest, axis=0) / np.sqrt(len(rest))  # of a median
    if np.any(np.abs(middle) > OFFSET + noise):
        shown = ", ".join(f"{each:.2g}" for each in -middle)
        log.report.doubt(f"{name} is too large by {shown} m/s all the time, compared with {reference}; check its zero")


def ways_of(velocity):
    """Directions with motion, array (ways, 3), unit vectors: the axes if there is some in each direction."""
    _, sizes, ways = np.linalg.svd(velocity, full_matrices=False)
    moving = sizes > MOVING * np.sqrt(len(velocity))
    return np.eye(3) if moving.all() else ways[moving]


def in_words(way):
    """A displacement [m] in words; negligible components are omitted."""
    parts = [f"{each:.2g} m {axis}" for each, axis in zip(way, AXES, strict=True) if abs(each) > 0.1 * np.abs(way).max()]
    return ", ".join(parts) or "nowhere"


def robust(a, b):
    """Least squares of a x = b without the rows that fit worst, a tenth: x and the standard deviations of its rows.

    Arrays (columns of a, columns of b) and (columns of a,); a has at least one column.
    """
    keep = np.ones(len(a), bool)
    for _ in range(3):
        found = np.linalg.lstsq(a[keep], b[keep], rcond=None)[0]
        rest = np.linalg.norm(b - a @ found, axis=1)
        noise = np.sqrt(np.mean(rest[keep] ** 2) * np.diag(np.linalg.pinv(a[keep].T @ a[keep])))
        keep = rest <= np.quantile(rest, 0.9 if len(rest) >= MANY else 1.0)
    return found, noise


def compare_length(log, position):
    """Whether the tether is as long as the kite is far away; LogError if the kite is much farther away."""
    if "tether_length" not in log.table:
        return False
    noise = log.map.smoothing.position_noise
    length = log.map.station.length_outside(log.table["tether_length"].to_numpy())
    distance = np.linalg.norm(position, axis=1) - log.map.kite.end_below
    ratio = distance / np.where(length > 0.0, length, np.nan)
    if not np.isfinite(ratio).any():
        return False
    far, excess = np.nanquantile(ratio, 0.95), np.nanquantile(distance - length, 0.95)
    check = "as far away as tether_length; check both units, the origin and its altitude, and which length is logged"
    if far > FARTHEST and excess > NEARBY:
        raise log.wrong(f"kite_position is, in 5 % of the rows or more, {far:.3g} times {check}")
    if far > DOUBTFUL and excess > NOISE * noise:
        log.report.doubt(f"kite_position is up to {far:.4g} times {check}")
    if far < NEAREST:
        log.report.doubt(f"kite_position is never more than {far:.2g} times {check}")
    both = np.isfinite(ratio)
    if both.sum() >= MANY and np.std(length[both]) > RANGE_OF_LENGTH:
        ((factor,), _), (spread, _) = robust(np.stack([length[both], np.ones(both.sum())], axis=1), distance[both, None])
        if abs(factor - 1.0) > NEAR + NOISE * spread:
            log.report.doubt(
                f"kite_position is {factor:.2g} m farther away for each metre of tether_length; check its sign (it grows as "
                "the winch pays out), its unit, and which length is logged"
            )
    if "ground_tension" in log.table:
        taut = ratio[log.table["ground_tension"].to_numpy() > TAUT * log.map.weight * length]
        middle = np.nanmedian(taut) if np.isfinite(taut).sum() >= FEWEST else 1.0
        if middle < LEAST_TAUT:
            log.report.doubt(f"kite_position is, while the tether is taut, only {middle:.3g} times {check}")
    return True


def compare_reeling(log, position):
    """Whether the length, or the distance, changes according to the reel-out speed; LogError if the length does not."""
    if "reel_out_speed" not in log.table:
        return None
    speed, is_length = means(log, log.table[["reel_out_speed"]].to_numpy()), "tether_length" in log.table
    what = "tether_length" if is_length else "the distance of kite_position"
    rate = rates(log, log.table[["tether_length"]].to_numpy() if is_length else np.linalg.norm(position, axis=1)[:, None])
    both = np.isfinite(rate[:, 0]) & np.isfinite(speed[:, 0])
    if both.sum() < FEWEST or np.sqrt(np.mean(speed[both] ** 2)) < REELING:
        return False
    ((factor,), _), (noise, _) = robust(np.hstack([speed[both], np.ones((both.sum(), 1))]), rate[both])
    doubt_offset(log, "reel_out_speed", rate[both] - factor * speed[both], f"the change of {what.removeprefix('the ')}")
    text = f"{what} changes by {factor:.2g} m for each metre of reel_out_speed; check the sign (positive pays out) and units"
    if is_length and abs(factor - 1.0) > 2.0 * NEAR + NOISE * noise:
        raise log.wrong(text)
    if abs(factor - 1.0) > NEAR + NOISE * noise:
        log.report.doubt(text)
    return True


def compare_tension(log, position):
    """Whether the tension is plausible for a kite of this area; LogError if it has the wrong sign."""
    if "ground_tension" not in log.table:
        return None
    tension, area = log.table["ground_tension"].to_numpy(), log.map.kite.area
    low, high = np.nanquantile(tension, [0.05, 0.95])
    if -low > max(high, TAUT * log.map.weight * np.nanmedian(np.linalg.norm(position, axis=1))):
        raise log.wrong(
            f"ground_tension is {low:.4g} N at its lowest, {high:.4g} N at its highest; a tether pulls: check its sign"
        )
    if np.nanmedian(tension) < 0.0:
        log.report.doubt(f"the median of ground_tension is {np.nanmedian(tension):.3g} N; check its zero")
    strain = high / log.map.tether.axial_stiffness
    if strain > LARGEST_STRETCH - 1.0:
        log.report.doubt(f"ground_tension would stretch the tether by {100.0 * strain:.3g} %; check its unit, and [tether]")
    judge_small_tension(log, position)
    if "airspeed" not in log.table or not area:
        return False
    pressure = 0.5 * log.map.environment.air_density * log.table["airspeed"].to_numpy() ** 2 * area
    fast = np.isfinite(pressure) & np.isfinite(tension) & (pressure > np.nanmedian(pressure))
    if fast.sum() < FEWEST:
        return False
    found, (least, most) = np.median(tension[fast] / pressure[fast]), FORCE_COEFFICIENTS
    log.report.say(f"size: ground_tension is {found:.2g} times dynamic pressure and area of the kite")
    if not least <= found <= most:
        log.report.doubt(
            f"ground_tension is {found:.2g} times dynamic pressure and area of the kite, {least:g} to {most:g} "
            f"are usual for soft kites; {probably(units_of_tension(log, found, least, most))}check its unit, "
            "that of airspeed, and "
            "kite.area",
            of_unit=True,
        )
    judge_zero_of_tension(log, tension, pressure)
    return True


def judge_zero_of_tension(log, tension, pressure):
    """Doubt a tension that does not vanish with the dynamic pressure [N] while the winch pays out."""
    if "reel_out_speed" not in log.table:
        return
    out = np.isfinite(tension) & np.isfinite(pressure) & (log.table["reel_out_speed"].to_numpy() > REELING)
    if out.sum() < MANY or np.corrcoef(tension[out], pressure[out])[0, 1] < delays.LEAST:
        return
    ((factor,), (zero,)), (_, noise) = robust(np.stack([pressure[out], np.ones(out.sum())], axis=1), tension[out, None])
    if abs(zero) > ZERO * factor * np.median(pressure[out]) + NOISE * noise:
        log.report.doubt(
            f"ground_tension would be {zero:.2g} N without airspeed, by its change with the dynamic pressure while the "
            "winch pays out; check its zero"
        )


def judge_small_tension(log, position):
    """Doubt a tension at which the tether would hang slack, unless the logged length exceeds the distance."""
    distance = np.linalg.norm(position, axis=1)
    if "tether_length" in log.table:
        length = log.map.station.length_outside(log.table["tether_length"].to_numpy())
        if not np.nanmedian(distance) > LEAST_TAUT * np.nanmedian(length):
            return
    middle, weight = np.nanmedian(log.table["ground_tension"]), log.map.weight * np.nanmedian(distance)
    if doubts_of(log.map.tether) or not 0.0 < middle < SLACK * weight:
        return
    log.report.doubt(
        f"the median of ground_tension is {middle:.3g} N, and the tether weighs {weight:.3g} N; "
        f"{probably(units_of_tension(log, middle / weight, TAUT, np.inf)[:1])}check its unit, and [tether]",
        of_unit=True,
    )


def units_of_tension(log, found, least, most):
    """Units of the logged tension, the smallest first, that put a multiple of it between two numbers."""
    (column,) = log.map.sources["ground_tension"].numbers
    known = sorted(factors("N").items(), key=lambda unit: unit[1])
    return [spelled for spelled, factor in known if least <= found * factor / column.factor <= most]


def probably(units):
    """Which units were probably meant, if any is known."""
    return f"{' or '.join(units)} was probably meant: " if units else ""


def compare_wind(log, position):
    """Whether the wind is plausible for the airspeed of the kite; doubts concern airspeed and direction."""
    wind, velocity = log.of(WIND), log.of(VELOCITY)
    if wind is None:
        return None
    mean, place = np.nanmean(wind, axis=0)[:2], np.nanmean(position, axis=0)
    if np.linalg.norm(mean) > BLOWING and mean @ place[:2] < -0.3 * np.linalg.norm(mean) * np.linalg.norm(place):
        log.report.doubt("wind_velocity blows from kite_position to the station: check direction and signs of both")
    if velocity is None or "airspeed" not in log.table:
        return False
    if log.map.environment.wind_profile == at.POWER_LAW:
        height = np.maximum(position[:, 2:], log.map.environment.wind_reference_height)
        wind = wind * (height / log.map.environment.wind_reference_height) ** log.map.environment.wind_exponent
    rows = edges(log.time)
    wind, velocity, airspeed = wind[rows], velocity[rows], log.table["airspeed"].to_numpy()[rows]
    both = np.isfinite(wind).all(axis=1) & (np.linalg.norm(velocity, axis=1) > FLYING) & np.isfinite(airspeed)
    if both.sum() < FEWEST:
        return False
    speeds = np.linalg.norm(velocity[both] - FACTORS[:, None, None] * wind[both], axis=2)
    ratio = np.median(airspeed[both] / np.maximum(speeds[FACTORS == 1.0], 1e-3))
    best = FACTORS[np.argmin(np.median(np.abs(speeds - airspeed[both]), axis=1))]
    if not AIRSPEEDS[0] <= ratio <= AIRSPEEDS[1]:
        log.report.doubt(f"airspeed is {ratio:.2g} times the speed of the kite in wind_velocity; check the units of both")
    elif np.linalg.norm(mean) > BLOWING and not WINDS[0] <= best <= WINDS[1]:
        log.report.doubt(
            f"wind_velocity fits airspeed and kite_velocity best times {best:.2g}; check its unit and direction"
        )
    return True


def judge_what_is_not_said(log):
    """Doubt a default tether, and still air."""
    tether = log.map.tether
    for doubt in doubts_of(tether, "tether."):
        log.report.doubt(doubt, of_unit=True)
    if tether == Tether() and not log.map.names_tether:
        log.report.doubt(
            f"the map does not specify the tether: the default is used, {1000.0 * tether.diameter:g} mm and "
            f"{1000.0 * tether.mass_per_length:.3g} g/m; give a table [tether], or set tether.diameter, ..."
        )
    if log.of(WIND) is None:
        log.report.doubt("there is no wind_velocity: the tethers fly in still air")


COMPARISONS = {  # comparisons: True if done, False without data to compare with, None without the quantity
    "speed of kite_position": compare_speed,
    "kite_position against kite_velocity": compare_velocity,
    "kite_position against tether_length": compare_length,
    "reel_out_speed against the change of length or distance": compare_reeling,
    "size of ground_tension against airspeed and kite.area": compare_tension,
    "wind_velocity against airspeed and kite_velocity": compare_wind,
}
COMPARED = ("kite_position", "kite_velocity", "tether_length", "ground_tension", "airspeed", "kite.area", "wind_velocity")
