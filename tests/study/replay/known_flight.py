"""A flight of known motion, logs of it in several forms, and what a log becomes when it is flown."""

from functools import cache

import numpy as np
import pandas as pd

from tetherfmu.study.replay import columns, log
from tetherfmu.study.replay.flight import prepare

ORIGIN = (52.0, 4.0, 10.0)  # station: latitude, longitude [deg], altitude [m]
AREA, COEFFICIENT, AIR_DENSITY = 20.0, 0.5, 1.225  # of the kite [m2, -], of the air [kg/m3]
WIND = np.array([9.0, 2.0, 0.0])  # [m/s]
SLACK = 1.002  # length over distance
KGF = 9.80665  # N

FULL = f"""
time = "time"
tether_length = "length"
reel_out_speed = "speed"
airspeed = "airspeed"
phase = "phase"
[kite_position]
latitude = "lat"
longitude = "lon"
altitude = "alt"
[origin]
latitude = {ORIGIN[0]}
longitude = {ORIGIN[1]}
altitude = {ORIGIN[2]}
[kite_velocity]
north = "vn"
east = "ve"
down = "vd"
[ground_tension]
column = "force"
unit = "kgf"
[wind_velocity]
speed = "wind"
from = "wind_from"
[kite]
area = {AREA}
[tether]
diameter = "10 mm"
axial_stiffness = "3.8 MN"
"""


def path(time):
    """Position [m] and velocity [m/s] of a kite in figures of eight while it is reeled out and in, arrays (times, 3)."""
    rate = 2.0 * np.pi / 20.0
    distance, reeling = 250.0 + 30.0 * np.sin(rate / 3.0 * time), 30.0 * rate / 3.0 * np.cos(rate / 3.0 * time)
    azimuth, turning = 0.2 + 0.35 * np.sin(rate * time), 0.35 * rate * np.cos(rate * time)
    elevation, climbing = 0.6 + 0.12 * np.sin(2.0 * rate * time), 0.24 * rate * np.cos(2.0 * rate * time)
    out = np.stack([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)], axis=1)
    across = np.stack([-np.cos(elevation) * np.sin(azimuth), np.cos(elevation) * np.cos(azimuth), 0.0 * time], axis=1)
    upwards = np.stack(
        [-np.sin(elevation) * np.cos(azimuth), -np.sin(elevation) * np.sin(azimuth), np.cos(elevation)], axis=1
    )
    turned = turning[:, None] * across + climbing[:, None] * upwards
    return distance[:, None] * out, reeling[:, None] * out + distance[:, None] * turned


def geodetic(points):
    """Latitude, longitude [deg] and altitude [m] of points seen from `ORIGIN`, array (rows, 3), by Newton's method.

    ECEF of WGS 84: X = (N + h) cos(phi) cos(lam), Y = (N + h) cos(phi) sin(lam), Z = (N (1 - e2) + h) sin(phi),
    N = a / sqrt(1 - e2 sin(phi)^2), and the axes east, north, up of the origin.
    """
    found = np.tile(np.array(ORIGIN), (len(points), 1))
    for _ in range(6):
        rest = points - seen_from_origin(*found.T)
        found = found + rest[:, [1, 0, 2]] * (1.0 / 111e3, 1.0 / (111e3 * np.cos(np.radians(ORIGIN[0]))), 1.0)
    return found


def seen_from_origin(latitude, longitude, altitude, origin=ORIGIN):
    """East, north, up [m] of geodetic coordinates [deg, deg, m], array (rows, 3)."""
    phi0, lam0 = np.radians(origin[0]), np.radians(origin[1])
    dx, dy, dz = ecef(latitude, longitude, altitude) - ecef(*np.array(origin)[:, None])
    east = -np.sin(lam0) * dx + np.cos(lam0) * dy
    north = -np.sin(phi0) * np.cos(lam0) * dx - np.sin(phi0) * np.sin(lam0) * dy + np.cos(phi0) * dz
    up = np.cos(phi0) * np.cos(lam0) * dx + np.cos(phi0) * np.sin(lam0) * dy + np.sin(phi0) * dz
    return np.stack([east, north, up], axis=1)


def ecef(latitude, longitude, altitude):
    """X, Y, Z [m] of geodetic coordinates [deg, deg, m] on the ellipsoid with semi-axes 6378137 m and 6356752.314245 m."""
    phi, lam = np.radians(latitude), np.radians(longitude)
    a, b = 6378137.0, 6356752.314245
    normal = a**2 / np.hypot(a * np.cos(phi), b * np.sin(phi))
    around = (normal + altitude) * np.cos(phi)
    return np.array([around * np.cos(lam), around * np.sin(lam), (normal * b**2 / a**2 + altitude) * np.sin(phi)])


def motions(time):
    """Quantities of the known flight at times [s], DataFrame: columns of the map `FULL`, and x, y, z, vx, vy, vz."""
    position, velocity = path(time)
    distance = np.linalg.norm(position, axis=1)
    made = pd.DataFrame({"time": time})
    made[["lat", "lon", "alt"]] = geodetic(position)
    made[["x", "y", "z"]], made[["vx", "vy", "vz"]] = position, velocity
    made[["ve", "vn", "vd"]] = velocity * (1.0, 1.0, -1.0)
    made["length"] = SLACK * distance
    made["speed"] = SLACK * np.sum(position * velocity, axis=1) / distance
    made["airspeed"] = np.linalg.norm(velocity - WIND, axis=1)
    made["force"] = COEFFICIENT * 0.5 * AIR_DENSITY * AREA * made["airspeed"] ** 2 / KGF
    made["wind"], made["wind_from"] = np.hypot(WIND[0], WIND[1]), np.degrees(np.arctan2(-WIND[0], -WIND[1])) % 360.0
    made["phase"] = "flying"
    return made


def full(every=0.1, duration=120.0):
    """A log of the known flight, DataFrame with the digits that loggers write."""
    return _full(every, duration).copy()


@cache
def _full(every, duration):
    made = motions(np.round(np.arange(0.0, duration, every), 6))
    return made.round({"lat": 8, "lon": 8, **dict.fromkeys(made.columns.drop(["time", "lat", "lon", "phase"]), 3)})


def enu(every=0.1, duration=120.0):
    """A log of the known flight for the map `enu`."""
    made = full(every, duration)
    made = made.rename(columns={"length": "tether_length", "speed": "reel_out_speed"})
    made["ground_tension"] = made["force"] * KGF
    made["wind_x"], made["wind_y"], made["wind_z"] = WIND
    left_out = ["lat", "lon", "alt", "ve", "vn", "vd", "force", "wind", "wind_from"]
    return made.drop(columns=left_out)


def map_of(text, folder, name="own"):
    """`Columns` of the text of a map."""
    place = folder / f"{name}.toml"
    place.write_text(text, encoding="utf-8")
    return columns.load(place)


def written(folder, contents):
    """Path of a log: a DataFrame, a text, or bytes."""
    place = folder / "flight.csv"
    if isinstance(contents, pd.DataFrame):
        contents = contents.to_csv(index=False)
    place.write_bytes(contents if isinstance(contents, bytes) else contents.encode())
    return place


def flown(folder, contents, found):
    """`Flight` of a log with a map."""
    return prepare(log.read(written(folder, contents), found))
