"""Tethers of a material, tethers of another diameter, ends from angles and along paths."""

import numpy as np
import pytest

from tetherfmu import MATERIALS, MovingEnd, Tether, TetherDynamic, TetherStraight, inputs_along, kite_at, tether_of


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


@pytest.mark.parametrize("wrong", [(0.0, 0.0), 5.0, lambda t: (0.0, 0.0, 0.0), "here"])
def test_an_end_that_is_something_else_is_refused(wrong):
    with pytest.raises(ValueError, match=r"^ground is .*; it must be a MovingEnd, or three numbers where it stays$"):
        inputs_along(3, 0.02, ground=wrong)
