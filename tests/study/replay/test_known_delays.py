"""What a map says of the times in a log: quantities that are logged late, and the time over which the wind is averaged."""

import numpy as np

from tests.study.replay.breaking import changed
from tests.study.replay.known_flight import FULL, KGF, SLACK, WIND, enu, flown, full, map_of, motions, path

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
