"""From the columns of a log to SI units, x east, y north, z up, seen from the origin of its map."""

import numpy as np

from tetherfmu.files.csv_files import from_angles
from tetherfmu.runtime.inputs import components

from .columns import FROM_ANGLES, GEODETIC_POINT, WIND_FROM, Source

EARTH_RADIUS = 6378137.0  # m, at the equator
ROUNDS = 5  # iterations for an origin; each reduces the error by three digits
SCATTER = 10.0  # m, largest median difference of positions in degrees and in metres
TURN = 2.0 * np.pi  # rad


def local(latitude, longitude, altitude, origin):
    """East, north, up [m], array (rows, 3), of WGS 84 coordinates [deg, deg, m] seen from an origin, likewise."""
    from pymap3d import geodetic2enu  # only logs with such coordinates need it

    return np.stack(geodetic2enu(latitude, longitude, altitude, *origin), axis=-1)


def origin_of(geodetic, metres):
    """Latitude, longitude [deg] and altitude [m] of the origin of positions in metres.

    geodetic, metres : the same positions, arrays (rows, 3), NaN if unknown. The median over the flight, which
    outliers do not affect. ValueError if no row has both, or if they are different positions.
    """
    both = np.isfinite(geodetic).all(axis=1) & np.isfinite(metres).all(axis=1)
    both &= (np.abs(geodetic[:, 0]) < 90.0) & (np.abs(geodetic[:, 1]) <= 360.0) & geodetic[:, :2].any(axis=1)
    if not both.any():
        raise ValueError("the origin cannot be found: no row has a position in degrees and in metres")
    geodetic, metres = geodetic[both], metres[both]
    origin = np.median(geodetic, axis=0)
    for _ in range(ROUNDS):
        away = local(*geodetic.T, origin) - metres
        east, north, up = np.median(away, axis=0)
        circle = EARTH_RADIUS * np.cos(np.radians(origin[0]))
        origin = origin + np.array([np.degrees(north / EARTH_RADIUS), np.degrees(east / circle), up])
        if not np.abs(origin[0]) < 90.0:
            break
    scatter = np.median(np.linalg.norm(away - np.median(away, axis=0), axis=1))
    if not scatter <= SCATTER:
        raise ValueError(
            f"the origin cannot be found: its positions in degrees and in metres differ by {scatter:.3g} m; "
            f"{SCATTER:g} m at most is allowed; check columns, axes and units of [origin]"
        )
    return tuple(map(float, origin))


def convert(raw, found, table, report):
    """Put the quantities of a map into a table; raw : dict from a column of the log to its readings."""
    for name, source in found.sources.items():
        numbers = source.read(raw)
        if source.kind == GEODETIC_POINT:
            refuse_other_angles(source, numbers)
            numbers = local(*numbers.T, station_of(raw, found, report))
        elif source.kind == FROM_ANGLES:
            numbers = from_angles(numbers)
            report.say(f"{name} is that of elevation, azimuth and distance: {', '.join(source.columns)}")
        elif source.kind == WIND_FROM:
            speed, angle = numbers.T
            numbers = speed[:, None] * np.column_stack([-np.sin(angle), -np.cos(angle), 0.0 * angle])
            judge_angle(source.numbers[1], raw[source.columns[1]], report)
        table[list(components(name, numbers.shape[1]))] = numbers


def refuse_other_angles(source, numbers):
    """ValueError if most geodetic coordinates [deg, deg, m], array (rows, 3), are invalid."""
    for name, column, values, most in zip(("latitude", "longitude"), source.columns, numbers.T, (90.0, 360.0), strict=False):
        known = values[np.isfinite(values)]
        if len(known) and np.abs(np.median(known)) > most:
            raise ValueError(
                f"{column} is {np.median(known):.6g} deg in the middle; a {name} is at most {most:g} deg; check its "
                'unit (angle = "1e-7 deg"?)'
            )


def station_of(raw, found, report):
    """The origin of a map in geodetic coordinates, computed from the log if the map says so."""
    if not isinstance(found.origin[0], Source):
        return found.origin
    geodetic, metres = (source.read(raw) for source in found.origin)
    refuse_other_angles(found.origin[0], geodetic)
    origin = origin_of(geodetic, metres)
    report.say(f"origin: latitude {origin[0]:.6f} deg, longitude {origin[1]:.6f} deg, altitude {origin[2]:.2f} m")
    return origin


def judge_angle(direction, readings, report):
    """Doubt a direction of the wind in degrees that looks like radians, and vice versa."""
    largest = np.max(np.abs(readings), initial=0.0, where=np.isfinite(readings))
    if direction.factor != 1.0 and 0.0 < largest <= TURN:
        report.doubt(f"{direction.name}, from where wind_velocity comes, is {largest:.3g} deg at most: is it in radians?")
    if direction.factor == 1.0 and largest > 2.0 * TURN:
        report.doubt(f"{direction.name}, from where wind_velocity comes, is up to {largest:.3g} rad: is it in degrees?")
