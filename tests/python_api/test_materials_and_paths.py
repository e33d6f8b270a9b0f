"""Tethers of a material, tethers of another diameter, ends from angles and along paths."""

import numpy as np
import pytest

from tetherfmu import MATERIALS, MovingEnd, Tether, TetherDynamic, TetherStraight, inputs_along, kite_at, tether_of
from tetherfmu.runtime.inputs import by_name


def test_another_diameter_is_as_stiff_as_its_area():
    """Twice the diameter: four times E A, damping and mass; a hanging weight stretches it a quarter as far."""
    thin = Tether(initial_length=500.0)
    thick = thin.with_diameter(2.0 * thin.diameter)
    assert thick.mass_per_length == pytest.approx(4.0 * thin.mass_per_length)
    assert thick.axial_damping / thick.axial_stiffness == pytest.approx(thin.axial_damping / thin.axial_stiffness)
    tensions = [TetherStraight(each, gravity=0.0).initialize((0.0, 0.0, 505.0)).kite_tension for each in (thin, thick)]
    assert tensions[0] == pytest.approx(614600.0 * 0.01)
    assert tensions[1] == pytest.approx(4.0 * tensions[0])


@pytest.mark.parametrize(
    ("material", "mass", "stiffness"),
    [
        ("dyneema_sk75", 724.0 * np.pi / 4.0, 55e9 * np.pi / 4.0),
        ("dyneema_sk78", 724.0 * np.pi / 4.0, 55e9 * np.pi / 4.0),
        ("steel", 3989.7, 4.04e10),
        ("polyester", 797.8, 1.09e9),
    ],
)
def test_materials_have_the_numbers_of_their_sources(material, mass, stiffness):
    """Per square of the nominal diameter, kg/m and N for a diameter of 1 m; 10 mm has 1e-4 of both."""
    tether = tether_of(material, 0.01, initial_length=50.0)
    assert tether.mass_per_length == pytest.approx(1e-4 * mass)
    assert tether.axial_stiffness == pytest.approx(1e-4 * stiffness)
    assert tether.initial_length == 50.0
    assert MATERIALS[material].source


def test_angles_are_those_of_the_outputs():
    """A taut, weightless tether leaves the ground in the direction of the kite."""
    station = np.array((10.0, -20.0, 5.0))
    kite = kite_at(elevation=0.6, azimuth=-2.0, distance=500.0, ground_position=station)
    outputs = TetherStraight(initial_length=495.0, gravity=0.0).initialize(kite, ground_position=station)
    assert outputs.ground_elevation == pytest.approx(0.6, abs=1e-12)
    assert outputs.ground_azimuth == pytest.approx(-2.0, abs=1e-12)
    assert np.linalg.norm(kite - station) == pytest.approx(500.0)


def test_velocity_of_a_path_by_differences():
    """Error of central differences: difference^2/6 times the third derivative, here 0.3^3 500; and rounding."""
    path = MovingEnd(lambda t: (500.0 * np.cos(0.3 * t), 500.0 * np.sin(0.3 * t), 0.0), difference=1e-3)
    for time in (0.0, 1.7):
        exact = 150.0 * np.array((-np.sin(0.3 * time), np.cos(0.3 * time), 0.0))
        np.testing.assert_allclose(path.at(time)[1], exact, rtol=0, atol=1e-6 / 6.0 * 13.5 + 1e-9)
    assert MovingEnd(path.position, lambda t: (1.0, 2.0, 3.0)).at(0.0)[1].tolist() == [1.0, 2.0, 3.0]


def test_a_flight_along_paths_equals_a_loop():
    kite = MovingEnd(lambda t: (300.0 * np.cos(0.1 * t), 300.0 * np.sin(0.1 * t), 400.0))
    ground = MovingEnd(lambda t: (0.0, 0.1 * t, 0.0))
    inputs = inputs_along(
        20, 0.02, kite, ground, reel_out_speed=lambda t: 0.1 * t, wind_velocity=lambda t: (8.0 + t, 0.0, 0.0), start=1.0
    )
    loop, whole = TetherDynamic(), TetherDynamic()
    for tether in (loop, whole):
        tether.initialize(*kite.at(1.0), *ground.at(1.0), wind_velocity=(9.0, 0.0, 0.0))
    flown = whole.fly(inputs, 0.02)
    for k in range(20):
        time = 1.0 + 0.02 * k
        given = {"reel_out_speed": 0.1 * time, "wind_velocity": (8.0 + time, 0.0, 0.0)}
        outputs = loop.step(0.02, *kite.at(time), *ground.at(time), **given)
    np.testing.assert_array_equal(flown.kite_force[-1], outputs.kite_force)
    np.testing.assert_array_equal(flown.positions[-1], loop.positions)


def test_three_numbers_are_an_end_that_stays():
    place = (1.0, 2.0, 3.0)
    still = MovingEnd(lambda t: place, lambda t: (0.0, 0.0, 0.0))
    np.testing.assert_array_equal(inputs_along(3, 0.02, place, still), inputs_along(3, 0.02, still, place))
    assert inputs_along(1, 0.02, ground=(1.0, 2.0, 3.0))[0, :12].tolist() == [300, 0, 400, 0, 0, 0, 1, 2, 3, 0, 0, 0]


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ((0.0, 0.0), r"^ground has the shape \(2,\); it must be \(3,\), \(4, 3\) or a MovingEnd$"),
        (np.zeros((3, 3)), r"^ground has the shape \(3, 3\); it must be \(3,\), \(4, 3\) or a MovingEnd$"),
        (5.0, r"^ground has the shape \(\); it must be \(3,\), \(4, 3\) or a MovingEnd$"),
        (lambda t: (0.0, 0.0, 0.0), "^ground is a function; make a MovingEnd of it$"),
        ("here", "^ground is 'here'; it must be numbers, or a MovingEnd$"),
    ],
)
def test_an_end_that_is_something_else_is_refused(wrong, said):
    with pytest.raises(ValueError, match=said):
        inputs_along(4, 0.02, ground=wrong)


@pytest.mark.parametrize(
    ("signal", "said"),
    [
        (
            {"reel_out_speed": np.zeros(3)},
            r"^reel_out_speed has the shape \(3,\); it must be a number, \(4,\) or a function",
        ),
        ({"wind_velocity": np.zeros((4, 2))}, r"^wind_velocity has the shape \(4, 2\); it must be \(3,\), \(4, 3\) or a f"),
        ({"wind_velocity": lambda t: (8.0, 0.0)}, r"^wind_velocity has the shape \(4, 2\); it must be"),
        ({"wind_velocity": "west"}, "^wind_velocity is 'west'; it must be numbers, or a function of the time$"),
        ({"wind_velocity": ["west"] * 50}, r"^wind_velocity is \['west', 'west', .*\.\.\.\]; it must be numbers"),
    ],
)
def test_a_signal_of_another_shape_is_refused_without_its_numbers(signal, said):
    with pytest.raises(ValueError, match=said) as refused:
        inputs_along(4, 0.02, **signal)
    assert len(str(refused.value)) < 130


def test_logged_signals_become_the_inputs_of_their_steps():
    """Rows as they are; a parabola of positions has its own velocities, as differences of second order are exact for it."""
    times = 0.02 * np.arange(50)
    path = np.stack((3.0 * times, 1.0 - times**2, 100.0 + 0.0 * times), axis=1)
    speed, wind = np.sin(times), np.stack((8.0 + times, times, 0.0 * times), axis=1)
    rows = by_name(inputs_along(50, 0.02, kite=path, reel_out_speed=speed, wind_velocity=wind, winch_force=7.0))
    np.testing.assert_array_equal(rows["kite_position"], path)
    np.testing.assert_allclose(
        rows["kite_velocity"], np.stack((3.0 + 0.0 * times, -2.0 * times, 0.0 * times), axis=1), atol=1e-10
    )
    np.testing.assert_array_equal(rows["reel_out_speed"][:, 0], speed)
    np.testing.assert_array_equal(rows["wind_velocity"], wind)
    assert (rows["winch_force"] == 7.0).all()
    given = by_name(inputs_along(50, 0.02, kite=path, kite_velocity=wind))
    np.testing.assert_array_equal(given["kite_velocity"], wind)
