"""Parameters are checked and packed as they are declared, by one kernel for all shells.

share  l_s/L,   line density  density pi d^2/4,   drag width  c d
"""

from math import inf, nan, pi

import numpy as np
import pytest

from tetherfmu import Environment, Solver, Tether
from tetherfmu.kernels import packing
from tetherfmu.libraries.ready import kernels
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.parameters import QUANTITIES_OF_TETHER, numbers_of
from tetherfmu.runtime.variants import BY_NAME, VARIANTS
from tetherfmu.wiring.packing import pack, pack_records
from tetherfmu.wiring.variables import PARAMETERS

DEFAULTS = [each.start for each in PARAMETERS]
NUMBER = {each.name: number for number, each in enumerate(PARAMETERS)}
WITHOUT_KITE = DEFAULTS[: NUMBER["kite_mass"]]
every_variant = pytest.mark.parametrize("variant", VARIANTS)


def segment_property(parameters, segments, which):
    first = at.PARAMETER_SCALARS + which * segments
    return list(parameters[first : first + segments])


def refusal(kites=0, **changes):
    """What is said to defaults with some changes."""
    numbers = DEFAULTS[: None if kites else NUMBER["kite_mass"]]
    for name, value in changes.items():
        numbers[NUMBER[name]] = value
    with pytest.raises(ValueError, match="must be") as refused:
        pack(kernels("dynamic"), numbers, kites=kites)
    return str(refused.value)


def awkward_diameters(count):
    """Diameters [m] whose square by `pow` and by a product differ in the last bit."""
    drawn = np.random.default_rng(1).uniform(1e-3, 0.1, 2000 * count).tolist()
    return [each for each in drawn if each**2 != each * each][:count]


@every_variant
def test_line_density_to_the_last_bit(variant):
    """The same in libraries, just in time and in Python, where a product instead of `pow` would show."""
    diameters = awkward_diameters(20)
    assert len(diameters) == 20
    for diameter in diameters:
        tether = Tether(diameter=diameter, density=1000.0 / 3.0)
        segments, parameters = pack_records(kernels(variant), (tether,), Environment(), Solver())
        quantities = np.array(numbers_of((tether,), Environment(), Solver()), float)
        assert segment_property(parameters, segments, at.LINE_DENSITY)[0] == tether.mass_per_length
        assert packing.line_density(quantities, 0) == tether.mass_per_length


@every_variant
def test_what_a_variant_goes_without(variant):
    """Without nodes one segment, without waves no damping."""
    tether = Tether(segments=4, axial_damping=100.0)
    segments, parameters = pack_records(kernels(variant), (tether,), Environment(), Solver())
    assert segments == (4 if BY_NAME[variant].has_nodes else 1)
    assert len(parameters) == at.parameters_size(segments)
    damping = 100.0 if BY_NAME[variant].has_waves else 0.0
    assert segment_property(parameters, segments, at.DAMPING) == [damping] * segments


def test_tethers_in_series():
    lower = Tether(segments=2, initial_length=30.0, diameter=0.01, density=900.0, drag_coefficient=1.2)
    upper = Tether(segments=3, initial_length=50.0, axial_stiffness=7e5, axial_damping=11.0)
    environment, solver = Environment(gravity=9.7, wind_profile="explog"), Solver(fixed_step=0.01)
    masses, free_ends = ((2, 4.0), (5, 6.0)), (True, False)
    n, parameters = pack_records(
        kernels("dynamic"), (lower, upper), environment, solver, point_masses=masses, free_ends=free_ends
    )
    assert n == 5
    tethers = [lower] * 2 + [upper] * 3
    expected = {
        at.SHARE: [0.5] * 2 + [0.0] * 3,  # the winch changes the lower one only
        at.OFFSET: [0.0] * 2 + [50.0 / 3] * 3,
        at.STIFFNESS: [each.axial_stiffness for each in tethers],
        at.DAMPING: [each.axial_damping for each in tethers],
        at.LINE_DENSITY: [each.density * pi * each.diameter**2 / 4.0 for each in tethers],
        at.DRAG_WIDTH: [each.drag_coefficient * each.diameter for each in tethers],
    }
    for which, values in expected.items():
        assert segment_property(parameters, n, which) == values
    scalars = {at.INITIAL_LENGTH: 80.0, at.GRAVITY: 9.7, at.WIND_PROFILE: at.EXPLOG, at.FIXED_STEP: 0.01}
    scalars |= {at.RELATIVE_TOLERANCE: 1e-4, at.GROUND_IS_FREE: 1.0, at.KITE_IS_FREE: 0.0, at.DAMPING_LAW: at.STRAIN_RATE}
    scalars |= {at.LENGTH_BEYOND: 50.0, at.LEAST_LENGTH: 50.02, at.SHORTEST_LENGTH: 50.02}
    assert {place: parameters[place] for place in scalars} == scalars
    last = at.PARAMETER_SCALARS + at.SEGMENT_PROPERTIES * n
    assert list(parameters[last : last + n + 1]) == [0.0, 0.0, 4.0, 0.0, 0.0, 6.0]
    assert not any(parameters[last + n + 1 :])


def test_a_mass_ends_the_section_at_the_winch():
    tethers = Tether(segments=4, initial_length=40.0), Tether(segments=1, initial_length=5.0)
    masses = ((0, 1.0), (1, 0.0), (3, 2.0), (4, 3.0), (5, 4.0))
    n, parameters = pack_records(kernels("dynamic"), tethers, Environment(), Solver(), point_masses=masses)
    assert segment_property(parameters, n, at.SHARE) == [1.0 / 3.0] * 3 + [0.0] * 2
    assert segment_property(parameters, n, at.OFFSET) == [0.0] * 3 + [10.0, 5.0]
    assert (parameters[at.LENGTH_BEYOND], parameters[at.LEAST_LENGTH]) == (15.0, 15.03)


def test_a_free_kite():
    numbers = list(DEFAULTS)
    numbers[NUMBER["kite_mass"]], numbers[NUMBER["segments"]] = 25.0, 3
    n, parameters = pack(kernels("dynamic"), numbers, kites=1)
    assert parameters[at.KITE_IS_FREE] == 1.0
    last = at.PARAMETER_SCALARS + at.SEGMENT_PROPERTIES * n
    assert list(parameters[last : last + 4]) == [0.0, 0.0, 0.0, 25.0]


@pytest.mark.parametrize("number", range(len(DEFAULTS)))
def test_limits_of_each_parameter(number):
    """The limits themselves are allowed, what is beyond them and what is no finite number is not."""
    declared, quantity = PARAMETERS[number], PARAMETERS[number].quantity
    lowest, highest = (1, len(quantity.choices)) if quantity.choices else (quantity.minimum, quantity.maximum)
    if declared.kind == "Real":
        beyond = (np.nextafter(lowest, -inf), np.nextafter(highest, inf), nan, inf, -inf)
    else:
        unused = (number for number, name in enumerate(quantity.choices, start=1) if not name)
        beyond = (lowest - 1, highest + 1, nan, inf, -inf, 1e300, -1e300, *((1.5,) if quantity.choices else ()), *unused)
    for value in map(float, beyond):
        shown = int(value) if declared.kind != "Real" and value.is_integer() else value
        said = refusal(1, **{declared.name: value})
        assert said == f"{declared.name} is {shown!r}; it must be {quantity.range()}"
    for value in (lowest, highest):
        numbers = list(DEFAULTS)
        numbers[NUMBER["initial_length"]], numbers[NUMBER["segments"]] = 100.0, 1
        numbers[number] = value
        assert pack(kernels("dynamic"), numbers, kites=1)[0] == (value if declared.name == "segments" else 1)


def test_what_does_not_fit_together():
    assert refusal(segments=2.5) == "segments is 2.5; it must be a whole number"
    assert refusal(initial_length=0.1) == "initial_length is 0.1 m for 20 segments; it must be at least 0.01 m for each"
    said = "surface_roughness is 10.0; it must be less than wind_reference_height (6.0 m) for this wind_profile"
    for profile in (3, 4):
        assert refusal(wind_profile=profile, surface_roughness=10.0) == said


@pytest.mark.parametrize(
    ("tethers", "said"),
    [
        ([Tether(), Tether(damping_law=2)], "damping_law must be the same for all tethers in series"),
        (
            [Tether(), Tether(), Tether(slack_stiffness_ratio=0.5, slack_damping_ratio=0.5)],
            "slack_stiffness_ratio must be the same for all tethers in series",
        ),
        ([Tether(segments=200), Tether(segments=101)], "segments is 301 in all; it must be at most 300"),
        (
            [Tether(), Tether(segments=9, initial_length=0.08)],
            "initial_length is 0.08 m for 9 segments; it must be at least 0.01 m for each",
        ),
    ],
)
def test_tethers_that_do_not_fit_together(tethers, said):
    with pytest.raises(ValueError, match="must be") as refused:
        pack_records(kernels("dynamic"), tethers, Environment(), Solver())
    assert str(refused.value) == said


def test_environment_and_solver_behind_tethers_in_series():
    """Their names are right however many tethers are before them."""
    numbers = [*WITHOUT_KITE[:QUANTITIES_OF_TETHER] * 2, *WITHOUT_KITE]
    numbers[2 * QUANTITIES_OF_TETHER + NUMBER["fixed_step"]] = -1.0
    with pytest.raises(ValueError, match=r"fixed_step is -1\.0; it must be at least 0 s"):
        pack(kernels("dynamic"), numbers, tethers=3)
