"""Every variant answers the same script, with the same names and the same signs.

Scene: a taut tether (1 % longer than unstretched, T = EA (c/L - 1) = 6.2 kN) of a kite that flies at 20 m/s across a wind
of 8 m/s. Weight and drag across it are q = 4 % of T together, so all variants are close to the straight line.
"""

import numpy as np
import pytest
from fmpy import read_model_description

from balance import VARIANTS
from scenes import same
from tetherfmu import StepRefused
from tetherfmu.export.archive import SLAVES
from tetherfmu.python import models
from tetherfmu.runtime.parameters import Environment, Solver, Tether, Winch
from tetherfmu.runtime.variants import BY_NAME

KITE = np.array([300.0, 40.0, 400.0])
KITE_VELOCITY = np.array([-4.0, 19.0, 1.0])
WIND = (8.0, 0.0, 0.0)
STEP = 0.02
TAUT = Tether(initial_length=np.linalg.norm(KITE) / 1.01)
every_variant = pytest.mark.parametrize("variant", VARIANTS)


def script(model, steps=5):
    """Initialize and step along a straight line; returns the outputs of the start and of each step."""
    rows = [model.initialize(kite_position=KITE, kite_velocity=KITE_VELOCITY, wind_velocity=WIND)]
    for k in range(steps):
        position = KITE + k * STEP * KITE_VELOCITY
        rows.append(model.step(STEP, kite_position=position, kite_velocity=KITE_VELOCITY, wind_velocity=WIND))
    return rows


def taut(variant, **changes):
    return getattr(models, variant)(Tether(initial_length=TAUT.initial_length, **changes), solver=Solver(initial_shape=2))


@every_variant
def test_end_forces_of_a_taut_tether_agree(variant):
    reference, outputs = script(taut("TetherDynamic"))[-1], script(taut(variant))[-1]
    for name, toward in (("ground_force", KITE), ("kite_force", -KITE)):
        force, expected = getattr(outputs, name), getattr(reference, name)
        assert force @ toward > 0.999 * np.linalg.norm(force) * np.linalg.norm(toward)  # both ends are pulled inwards
        # q is shared differently between the ends: the variants move a quarter of it at most
        assert np.linalg.norm(force - expected) < 0.01 * np.linalg.norm(expected)
    for name in ("ground_tension", "kite_tension", "max_tension"):
        assert np.isclose(getattr(outputs, name), getattr(reference, name), rtol=0.01)


@every_variant
def test_other_outputs_of_a_taut_tether_agree(variant):
    reference, outputs = script(taut("TetherDynamic"))[-1], script(taut(variant))[-1]
    chord = np.linalg.norm(KITE + 5 * STEP * KITE_VELOCITY)
    assert outputs.tether_length == TAUT.initial_length
    assert np.isclose(outputs.kite_stiffness, TAUT.axial_stiffness / TAUT.initial_length, rtol=1e-12)
    assert outputs.kite_damping == pytest.approx(
        TAUT.axial_damping / TAUT.initial_length if variant == "TetherDynamic" else 0.0, rel=1e-12
    )
    assert outputs.slack_segments == 0
    # sqrt(mu L c/T); T differs by less than 1 %
    mass = TAUT.density * np.pi / 4.0 * TAUT.diameter**2 * TAUT.initial_length
    assert np.isclose(outputs.wave_time, np.sqrt(mass * chord / reference.max_tension), rtol=0.01)
    # a parabola under q sags by q c/(8 T) and leaves the ground at the angle q/(2 T) to its chord
    assert 0.0 <= outputs.sag < 0.04 / 8.0 * chord
    assert abs(outputs.ground_elevation - np.arctan2(KITE[2], np.hypot(KITE[0], KITE[1]))) < 0.02
    assert abs(outputs.ground_azimuth - np.arctan2(KITE[1], KITE[0])) < 0.02 / np.cos(outputs.ground_elevation)
    if variant != "TetherStraight":
        # shape of the load: uniform, or as the square of the distance
        assert np.isclose(outputs.sag, reference.sag, rtol=0.1)
    assert np.allclose(outputs.shape[[0, -1]], [np.zeros(3), KITE + 5 * STEP * KITE_VELOCITY], atol=1e-9)


CHANGED = {
    "axial_damping": 50.0,
    "slack_stiffness_ratio": 0.5,
    "slack_damping_ratio": 0.1,
    "damping_law": 2,
    "segments": 3,
    "relative_tolerance": 1e-6,
    "fixed_step": 1e-3,
    "initial_shape": 1,
}


@pytest.mark.parametrize("variant", SLAVES)
@pytest.mark.parametrize("name", CHANGED)
def test_says_what_it_ignores_and_ignores_it(variant, name):
    """A slack, moving, reeling tether: an ignored parameter changes no bit of any output, another one does.

    What governs the steps of the solver does so at the drum of a winch by force.
    """
    has_drum = name in ("relative_tolerance", "fixed_step")
    winch = Winch(winch_control="force", winch_mass=5.0) if has_drum else Winch()
    told = {"winch_force": 500.0} if has_drum else {"reel_out_speed": 1.0}

    def fly(**changes):
        tether = {
            key: value for key, value in changes.items() if key not in ("relative_tolerance", "fixed_step", "initial_shape")
        }
        solver = {"initial_shape": 2} | {key: value for key, value in changes.items() if key not in tether}
        # released from a stretched straight line, a dynamic tether has slack segments after a while, also with a free kite
        tether = Tether(initial_length=400.0, **tether)
        model = getattr(models, variant)(tether, solver=Solver(**solver), winch=winch, shape_points=5)
        model.initialize(kite_position=KITE, kite_velocity=KITE_VELOCITY, wind_velocity=WIND, **told)
        lead = {} if BY_NAME[model.variant].kite_is_free else {"kite_position": 0.81 * KITE}
        return [model.step(0.1, **lead, wind_velocity=WIND, **told) for _ in range(20)]

    ignored = name in BY_NAME[getattr(models, variant).variant].ignored
    unchanged = all(same(a, b) for a, b in zip(fly(), fly(**{name: CHANGED[name]}), strict=True))
    assert unchanged == ignored


@every_variant
def test_fmu_says_what_it_ignores(fmu_folder, variant):
    known = read_model_description(str(fmu_folder / f"{variant}.fmu")).modelVariables
    ignored = {each.name for each in known if "ignored: " in each.description}
    waves = {"axial_damping", "slack_damping_ratio", "damping_law", "initial_shape", "breaking_force"}
    nodes = {"segments", "slack_stiffness_ratio"}
    ground = {"ground_contact", "ground_height", "ground_friction", "ground_sink"}
    expected = {
        "TetherDynamic": set(),
        "TetherQuasiSteady": waves,
        "TetherCatenary": waves | nodes | {"ground_sink"},
        "TetherStraight": waves | nodes | ground,
    }
    assert ignored == expected[variant]


def test_environment_is_not_ignored():
    """Each parameter of the air and of gravity changes the forces of every variant."""
    for variant in VARIANTS:
        model = getattr(models, variant)
        plain = script(model(TAUT), 1)[-1]
        for change in ({"air_density": 1.0}, {"air_density_scale_height": 8550.0}, {"gravity": 9.0}, {"wind_profile": 2}):
            assert not same(script(model(TAUT, Environment(**change)), 1)[-1], plain), (variant, change)


def test_refused_initialization_keeps_the_state():
    """A tether that runs goes on after an initialization that cannot be done."""
    tether = models.TetherDynamic()
    tether.initialize()
    tether.step(0.02)
    state = tether.get_state()
    with pytest.raises(StepRefused):
        tether.initialize(kite_position=(np.nan, 0.0, 400.0))
    with pytest.raises(StepRefused):
        tether.initialize(kite_position=(1e200, 0.0, 0.0))
    np.testing.assert_array_equal(tether.get_state(), state)
    tether.step(0.02)
