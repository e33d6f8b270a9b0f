"""From the columns of a log to SI units, x east, y north, z up, seen from where the tether leaves the winch."""

import numpy as np

from tetherfmu.runtime.inputs import components

EARTH_RADIUS, FLATTENING = 6378137.0, 1.0 / 298.257223563  # of the ellipsoid WGS 84 [m, -]


def radii(latitude):
    """Radii of curvature of the ellipsoid along a meridian and across it [m] at a latitude [rad]."""
    squared = FLATTENING * (2.0 - FLATTENING)  # of the eccentricity
    w = 1.0 - squared * np.sin(latitude) ** 2
    return EARTH_RADIUS * (1.0 - squared) / w**1.5, EARTH_RADIUS / np.sqrt(w)


def local(latitude, longitude, altitude, origin):
    """East, north, up [m], array (rows, 3), of geodetic coordinates [deg, deg, m] near an origin.

    On the tangent plane of the ellipsoid at the origin; 1 km away it is wrong by 0.1 m at most.
    """
    meridian, across = radii(np.radians(origin[0]))
    up = np.asarray(altitude) - origin[2]
    east = np.radians(np.asarray(longitude) - origin[1]) * (across + origin[2]) * np.cos(np.radians(origin[0]))
    north = np.radians(np.asarray(latitude) - origin[0]) * (meridian + origin[2])
    return np.column_stack([east, north, up])


def origin_of(geodetic, metres):
    """Latitude, longitude [deg] and altitude [m] of the point from which positions in metres are counted.

    geodetic, metres : the same positions, arrays (rows, 3), NaN where they are not known. The median over the flight, which
    a reading that is wrong does not move. ValueError if no row has both.
    """
    both = np.isfinite(geodetic).all(axis=1) & np.isfinite(metres).all(axis=1) & (np.abs(geodetic[:, 0]) <= 90.0)
    if not both.any():
        raise ValueError("the origin cannot be found: no row has a position in degrees and in metres")
    geodetic, metres = geodetic[both], metres[both]
    meridian, across = radii(np.radians(np.median(geodetic[:, 0])))
    latitude = np.median(geodetic[:, 0] - np.degrees(metres[:, 1] / meridian))
    longitude = np.median(geodetic[:, 1] - np.degrees(metres[:, 0] / (across * np.cos(np.radians(latitude)))))
    return float(latitude), float(longitude), float(np.median(geodetic[:, 2] - metres[:, 2]))


def convert(raw, found, table, report):
    """Put the quantities of a map into a table; raw : dict from a column of the log to its readings."""
    for name, vector in found.vectors.items():
        readings = np.column_stack([raw[column] for column in vector.columns])
        if vector.is_geodetic:
            points = local(*readings[:, :2].T, readings[:, 2] * vector.factor, station_of(raw, found, report))
        else:
            points = readings * vector.factor * vector.signs
        table[list(components(name, 3))] = points
    for name, scalar in found.scalars.items():
        if name != "wind_speed":
            table[name] = raw[scalar.column] * scalar.factor
    if found.wind_from:
        speed = raw[found.scalars["wind_speed"].column] * found.scalars["wind_speed"].factor
        angle = raw[found.wind_from.column] * found.wind_from.factor
        to = np.column_stack([-np.sin(angle), -np.cos(angle), 0.0 * angle])
        table[list(components("wind_velocity", 3))] = speed[:, None] * to
        judge_angle(found, raw[found.wind_from.column], report)


def station_of(raw, found, report):
    """The origin of a map in geodetic coordinates, found in the log if the map leads there."""
    if not hasattr(found.origin[0], "columns"):
        return found.origin
    geodetic, metres = (np.column_stack([raw[column] for column in vector.columns]) for vector in found.origin)
    geodetic = geodetic * (1.0, 1.0, found.origin[0].factor)
    origin = origin_of(geodetic, metres * found.origin[1].factor * found.origin[1].signs)
    report.say(f"origin: latitude {origin[0]:.6f} deg, longitude {origin[1]:.6f} deg, altitude {origin[2]:.2f} m")
    return origin


def judge_angle(found, readings, report):
    """Doubt degrees that look like radians."""
    known = readings[np.isfinite(readings)]
    if found.wind_from.factor != 1.0 and len(known) and np.all(np.abs(known) <= 2.0 * np.pi):
        report.doubt(f"{found.wind_from.column} is never above {np.abs(known).max():.3g} deg: is it in radians?")
