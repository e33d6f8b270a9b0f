"""A flight of one's own in turbulence: the wind of the box at points between the ends, and what it does to the pull."""

import sys

import numpy as np

from running import EXAMPLES, run_python

sys.path.append(str(EXAMPLES))

from tetherfmu import FrozenTurbulence, open_box
from wind import own_flight


def test_winds_between_the_ends_are_those_of_its_points():
    """For moving ends, point by point."""
    wind = FrozenTurbulence(own_flight.MEAN, open_box(own_flight.BOX))
    times = np.linspace(0.0, 40.0, 2501)
    kite = np.stack([own_flight.kite(time) for time in times])
    found = wind.between(times, (0.0, 0.0, 10.0), kite, 5)
    for k in (0, 1, 1250, 2499, 2500):
        points = np.array([(0.0, 0.0, 10.0) + share * (kite[k] - (0.0, 0.0, 10.0)) for share in (0.0, 0.25, 0.5, 0.75, 1.0)])
        np.testing.assert_array_equal(found[k], wind.at(times[k], points))


def test_turbulence_makes_the_pull_uneven():
    """Without it the pull has the period of the circle, 20 s; turbulence differs from turn to turn."""
    calm, rough = (own_flight.fly(box).of("ground_tension")[200:] for box in (None, open_box(own_flight.BOX)))
    turn = 1000  # steps
    differences = [np.abs(pull[turn:] - pull[:-turn]).max() for pull in (calm, rough)]
    assert differences[0] < 0.01 * calm.mean()
    assert differences[1] > 3.0 * differences[0]


def test_it_prints_both_flights():
    done = run_python(EXAMPLES / "wind" / "own_flight.py")
    assert done.returncode == 0, done.stderr
    assert [line.partition(":")[0] for line in done.stdout.splitlines()] == ["mean wind alone", "turbulent wind"]
    assert run_python(EXAMPLES / "wind" / "own_flight.py", "--box", __file__).stderr.count("\n") == 1
