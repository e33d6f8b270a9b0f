"""What the constants of a map do: delays, mean wind, places of sensor and outlet, rope that is counted; and still air."""

import numpy as np

from study.replay.breaking import changed
from study.replay.known_flight import FULL, KGF, SLACK, WIND, enu, flown, full, map_of, motions, path
from study.replay.test_doubted_logs import TIME, calm
from tetherfmu.study.replay import columns, driven_tethers

LATE = {  # column of the known flight: quantity of the map, and its delay [s]
    **dict.fromkeys(("lat", "lon", "alt"), ("kite_position", 0.3)),
    **dict.fromkeys(("vn", "ve", "vd"), ("kite_velocity", 0.4)),
    "length": ("tether_length", 0.5),
    "speed": ("reel_out_speed", 0.2),
    "force": ("ground_tension", 0.7),
}
TIMES = np.arange(10.0, 110.0, 0.05)  # s, in the middle of the log


def test_delayed_quantities_are_put_back(folder):
    """Each by its own time. Between readings of 10 Hz a curve bends by a h^2/8: 2 cm at 15 m/s2, of 30 m/s."""
    table = full()
    for name, (_, delay) in LATE.items():
        table[name] = motions(table["time"].to_numpy() - delay)[name]
    delays = "\n".join(f"{quantity} = {delay}" for quantity, delay in dict.fromkeys(LATE.values()))
    found = flown(folder, table, map_of(f"{FULL}[delay]\n{delays}\n", folder, "late"))
    position, velocity = path(TIMES)
    np.testing.assert_allclose(found.kite(TIMES)[0], position, atol=0.1)
    np.testing.assert_allclose(found.kite(TIMES)[1], velocity, atol=0.3)
    np.testing.assert_allclose(found.length(TIMES), SLACK * np.linalg.norm(position, axis=1), atol=0.02)
    expected = KGF * motions(TIMES)["force"]
    np.testing.assert_allclose(found.measured("ground_tension", TIMES), expected, atol=0.01 * expected.max())


def test_the_wind_is_averaged(folder):
    """A swing of a half over 3 s is gone in the mean over 30 s, to a reading of its 300."""
    swing = 1.0 + 0.5 * np.sin(2.0 * np.pi / 3.0 * enu()["time"])
    found = flown(folder, changed(enu(), wind_x=lambda wind: wind * swing), "enu")
    inner = (TIMES > 20.0) & (TIMES < 100.0)
    np.testing.assert_allclose(found.wind(TIMES[inner])[:, 0], WIND[0], rtol=0.5 / 300.0)


def test_the_end_of_the_tether_is_found_from_sensor_outlet_and_rope(folder):
    """Sensor: p + b p/|p| + outlet, whose rate is v + b (v - e (e v))/|p|, where p is the end seen from the outlet."""
    outlet, below, inside, offset = np.array((5.0, -3.0, 10.0)), 12.0, 7.0, 2.0
    table = enu()
    position, velocity = path(table["time"].to_numpy())
    distance = np.linalg.norm(position, axis=1, keepdims=True)
    e = position / distance
    turning = velocity - e * np.sum(e * velocity, axis=1, keepdims=True)
    table[["x", "y", "z"]] = position + below * e + outlet
    table[["vx", "vy", "vz"]] = velocity + below * turning / distance
    table["tether_length"] += inside - offset
    constants = {"kite.end_below": below, "station.drum_to_outlet": inside, "station.length_offset": offset}
    constants |= {
        f"station.outlet_{axis}": each for axis, each in zip(("east", "north", "up"), outlet.tolist(), strict=True)
    }
    found = flown(folder, table, columns.load("enu").with_constants(constants))
    position, velocity = path(TIMES)
    np.testing.assert_allclose(found.kite(TIMES)[0], position, atol=0.05)  # the smoother: 1 cm
    np.testing.assert_allclose(found.kite(TIMES)[1], velocity, atol=0.1)
    np.testing.assert_allclose(found.length(TIMES), SLACK * np.linalg.norm(position, axis=1), atol=0.02)


def test_still_air_exerts_no_force(folder):
    """Of a tether in equilibrium between ends that rest: what both ends carry is its weight."""
    table = calm(TIME, np.tile((60.0, 0.0, 80.0), (len(TIME), 1)), 101.0 + 0.0 * TIME)
    found = flown(folder, table, "enu")
    made = driven_tethers.fly(found, "catenary", "tension").table
    weight = found.log.map.weight * made.tether_length
    assert weight.min() > 5.0  # N
    assert made.air_force.max() < 1e-6 * weight.min()
