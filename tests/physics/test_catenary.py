"""The elastic catenary under its weight: published numbers, limits in closed form, another solution, and the chain's limit.

With the tension (H, V - w L/2) at the ground end, (H, V + w L/2) at the kite, span a and rise b:

    a = H L/EA + H/w (asinh((V + w L/2)/H) - asinh((V - w L/2)/H)),   b = V L/EA + (T_kite - T_ground)/w

Source: H. M. Irvine, Cable Structures (1981), section 1.3. The chain with its half end weights tends to it as 1/n^2.
"""

import numpy as np
import pytest
from numpy.polynomial.legendre import leggauss
from scipy.optimize import brentq

from mechanics import line_density
from tetherfmu import Tether, TetherCatenary, TetherDynamic, TetherQuasiSteady

pytestmark = pytest.mark.filterwarnings("ignore:a segment is stretched")  # far beyond what ropes bear
KITE, LENGTH = (100.0, 100.0, 800.0), 853.0240324867758
GROUND_FORCE = np.array([2.7950759559722207, -1.5790958788949883])  # horizontal, vertical
KITE_FORCE = np.array([-2.7950759559722207, -74.55491405628115])
CHAINS = pytest.mark.parametrize("model", [TetherQuasiSteady, TetherDynamic])


def hang(kite, length, model=TetherCatenary, **tether):
    return model(Tether(initial_length=length, **tether)).initialize(kite_position=kite)


def in_plane(outputs, kite):
    """Components of ground force and kite force, (2, 2): horizontal towards the kite, and vertical."""
    forces = np.array([outputs.ground_force, outputs.kite_force])
    return np.stack([forces[:, :2] @ kite[:2] / np.hypot(*kite[:2]), forces[:, 2]], axis=1)


def spans(h, v, w, length, stiffness):
    """Span and rise of the equations above."""
    v1, v2 = v - 0.5 * w * length, v + 0.5 * w * length
    span = h * length / stiffness + h / w * (np.arcsinh(v2 / h) - np.arcsinh(v1 / h))
    return span, v * length / stiffness + (np.hypot(h, v2) - np.hypot(h, v1)) / w


def by_bisection(span, rise, w, length, stiffness):
    """(H, V) by Brent's method twice: the rise grows with V, and on the curve of the right rise the span grows with H."""
    reach = w * length + stiffness * (abs(rise) + span) / length

    def v_of(log_h):
        def excess(v):
            return spans(np.exp(log_h), v, w, length, stiffness)[1] - rise

        return brentq(excess, -reach, reach, xtol=1e-300, rtol=1e-15, maxiter=1000)

    limits = np.log(1e-9 * w * length), np.log(reach)
    log_h = brentq(lambda q: spans(np.exp(q), v_of(q), w, length, stiffness)[0] - span, *limits, xtol=1e-15, rtol=1e-15)
    return np.exp(log_h), v_of(log_h)


def exact_forces(kite, length):
    """As `in_plane`, of the equations above."""
    tether = Tether(initial_length=length)
    w = line_density(tether) * 9.81
    h, v = by_bisection(np.hypot(*kite[:2]), kite[2], w, length, tether.axial_stiffness)
    return np.array([[h, v - 0.5 * w * length], [-h, -v - 0.5 * w * length]])


def test_published_numbers():
    outputs = hang(KITE, LENGTH)
    assert np.allclose(in_plane(outputs, KITE), [GROUND_FORCE, KITE_FORCE], rtol=1e-9, atol=0.0)
    assert np.isclose(outputs.ground_tension, 3.2102949076988487, rtol=1e-9)
    assert np.isclose(outputs.kite_tension, 74.60728958713835, rtol=1e-9)
    assert np.isclose(outputs.ground_elevation, np.arctan2(*GROUND_FORCE[::-1]), rtol=1e-9)
    assert np.isclose(outputs.ground_azimuth, np.pi / 4.0, rtol=1e-9)


def test_published_thick_tether():
    rope = {"diameter": 29.71973504179974e-3, "density": 970.0, "axial_stiffness": 8.047069220746364e7}
    outputs = hang((100.0, 100.0, 300.0), 431.66247903554, **rope)
    # Published with 6 and 7 digits for gravity 9.8066; forces grow in proportion to it, but for their stretch, 3e-5
    assert np.isclose(outputs.ground_tension * 9.8066 / 9.81, 461.229, rtol=1e-4)
    assert np.isclose(outputs.kite_tension * 9.8066 / 9.81, 2440.856, rtol=1e-4)


def random_cases(count):
    random = np.random.default_rng(3)
    for _ in range(count):
        distance, elevation, azimuth = random.uniform((10.0, -1.55, -np.pi), (800.0, 1.55, np.pi))
        out = np.cos(elevation)
        kite = distance * np.array([out * np.cos(azimuth), out * np.sin(azimuth), np.sin(elevation)])
        yield pytest.param(kite, distance * (1.0 + random.uniform(-0.01, 0.5)))


NAMED = {
    "slack": (KITE, LENGTH),
    "taut": ((300.0, 0.0, 400.0), 495.0),
    "just as long as the chord": ((300.0, 0.0, 400.0), 500.0),
    "horizontal": ((200.0, -100.0, 0.0), 230.0),
    "horizontal and taut": ((200.0, -100.0, 0.0), 223.0),
    "below the ground station": ((20.0, 50.0, -300.0), 320.0),
    "below and taut": ((20.0, 50.0, -300.0), 304.0),
    "very slack": ((3.0, 0.0, 1.0), 400.0),
}


@pytest.mark.parametrize(
    ("kite", "length"), [*(pytest.param(*case, id=name) for name, case in NAMED.items()), *random_cases(60)]
)
def test_is_the_solution_of_the_equations(kite, length):
    outputs, expected = hang(kite, length), exact_forces(kite, length)
    # of the larger end force; where L is the chord, 1e-16 of rounding in it are 1e-11 of the tension
    assert np.abs(in_plane(outputs, kite) - expected).max() < 1e-9 * np.abs(expected).max()
    assert np.allclose(outputs.shape[-1], kite, atol=1e-9 * length)


@pytest.mark.parametrize("rise", [-100.0, -40.0, 40.0, 100.0])
@pytest.mark.parametrize("length", [99.0, 101.0, 150.0])
def test_vertical(rise, length):
    """Taut: a bar, T = EA (|b|/L - 1) at mid-length. Slack: a fold without width, V = b/(L/EA + 2/w)."""
    tether = Tether(initial_length=length)
    w, stiffness = line_density(tether) * 9.81, tether.axial_stiffness
    v = rise / (length / stiffness + 2.0 / w)
    if abs(v) > 0.5 * w * length:
        v = np.sign(rise) * stiffness * (abs(rise) / length - 1.0)
    outputs = hang((0.0, 0.0, rise), length)
    half = 0.5 * w * length
    # the horizontal force of a fold is a rounding error; the bar's tension has that of its stretch
    assert np.allclose(outputs.ground_force, [0.0, 0.0, v - half], rtol=1e-9, atol=1e-9 * half)
    assert np.allclose(outputs.kite_force, [0.0, 0.0, -v - half], rtol=1e-9, atol=1e-9 * half)
    # the fold hangs (L - |b|)/2 below the lower end, but for its stretch of 1e-5
    assert np.isclose(outputs.sag, max(0.0, 0.5 * (length - abs(rise))), rtol=0, atol=1e-5 * length)


# --- the chain


@CHAINS
def test_chain_converges_with_second_order(model):
    """Errors of both forces over that on the kite; without the weight of the end nodes the order is 1."""
    numbers, exact = (22, 44, 88, 176), [GROUND_FORCE, KITE_FORCE]
    chains = [in_plane(hang(KITE, LENGTH, model, segments=n), KITE) for n in numbers]
    errors = np.array([np.linalg.norm(each - exact, axis=1) for each in chains]) / np.linalg.norm(KITE_FORCE)
    orders = np.log2(errors[:-1] / errors[1:])
    assert np.allclose(orders[0], 2.0, atol=0.2)  # the ground end is so slack that the next term still counts
    assert np.allclose(orders[1:], 2.0, atol=0.05)
    assert (errors[0] < 0.002).all()  # the bar for n = 22


ENDS = {
    "equal height": ((400.0, 0.0, 0.0), 401.0),
    "equal height, slack": ((100.0, 0.0, 0.0), 150.0),
    "below, slack": ((30.0, 0.0, -60.0), 100.0),
    "taut": ((0.0, 300.0, 300.0), 424.0),
}


@CHAINS
@pytest.mark.parametrize(("kite", "length"), ENDS.values(), ids=ENDS)
def test_richardson_extrapolation_is_the_catenary(model, kite, length):
    """Left is order 4 with a factor of order 10, 10/60^4 = 8e-7; 2e-6 is a hundredth of the plain error at n = 120."""
    coarse, fine = (in_plane(hang(kite, length, model, segments=n), kite) for n in (60, 120))
    exact = exact_forces(kite, length)
    size = line_density(Tether()) * 9.81 * length + exact[0, 0]
    np.testing.assert_allclose((4.0 * fine - coarse) / 3.0, exact, atol=2e-6 * size)


@CHAINS
def test_published_chain(model):
    """22 segments; published without the weight of the end nodes, with 5 decimals."""
    outputs = hang(KITE, LENGTH, model, segments=22)
    half_weight = np.array([0.0, 0.0, 0.08925189330624916 * LENGTH / 44.0])
    assert np.allclose(outputs.ground_force + half_weight, [1.92751, 1.92751, 0.042482], atol=6e-6)
    assert np.allclose(outputs.kite_force + half_weight, [-1.92751, -1.92751, -72.71586], atol=6e-6)


# --- starts that are made from their solution

# From the tension (H, V) at mid-length the closed form gives the ends, here with the difference of the asinh as the integral
# of ds/sqrt(H^2 + (V + w s)^2), which does not cancel. Where V/(w L) is just below a power of two, V + w L/2 and V - w L/2
# are rounded differently. Without `exact` in `elastic_catenary.py` some starts below 128, 256, ... are refused, and some of
# those that are stretched a hundred times.
TAUT, COUNT = 100.0, 2000
LOAD = line_density(Tether()) * 9.81
UNIT = LOAD * TAUT  # weight of the tether [N]
POINTS, WEIGHTS = leggauss(40)


def span_and_rise(horizontal, vertical, axial_stiffness):
    """Ends [m] of the elastic catenary with this tension [N] at mid-length; the integral is exact to 1e-16 for H > w L."""
    along = vertical + 0.5 * UNIT * POINTS
    span = horizontal * TAUT * (1.0 / axial_stiffness + 0.5 * WEIGHTS @ (1.0 / np.hypot(horizontal, along)))
    rise = TAUT * (vertical / axial_stiffness + 0.5 * WEIGHTS @ (along / np.hypot(horizontal, along)))
    return span, rise


def largest_error(horizontal, vertical, axial_stiffness):
    """Largest error of the ground force of starts with these tensions [N], over the tension; none may be refused."""
    model = TetherCatenary(initial_length=TAUT, axial_stiffness=axial_stiffness, shape_points=0)
    errors = []
    for h, v in zip(horizontal, vertical, strict=True):
        span, rise = span_and_rise(h, v, axial_stiffness)
        found = model.initialize(kite_position=(span, 0.0, rise)).ground_force
        errors.append(np.linalg.norm(found - (h, 0.0, v - 0.5 * UNIT)) / np.hypot(h, v))
    return max(errors)


# the strain is some 1e-3 and positions have errors of 1e-16 of the length: 1e-12, and ten times that for sums
@pytest.mark.parametrize("power", [5, 6, 7, 8, 9, 10])
def test_taut_below_a_power_of_two(power):
    random = np.random.default_rng(power)
    vertical = UNIT * (2.0**power - random.uniform(0.0, 0.5, COUNT))
    horizontal = vertical * 10.0 ** random.uniform(-1.0, 1.0, COUNT)
    stiffness = 100.0 * 2.0**power * UNIT
    assert largest_error(horizontal, vertical, stiffness) < 1e-11


# strain 1e-9 to 0.1 with EA up to 1e12 N; errors of 1e-16 of the length are then up to 1e-7 of the strain
@pytest.mark.parametrize("axial_stiffness", [1e3, 1e6, 1e9, 1e12])
def test_slack_to_taut(axial_stiffness):
    random = np.random.default_rng(1)
    tension = UNIT * 10.0 ** random.uniform(0.1, np.log10(0.1 * axial_stiffness / UNIT), COUNT)
    angle = random.uniform(-1.0, 1.0, COUNT)
    assert largest_error(tension * np.cos(angle), tension * np.sin(angle), axial_stiffness) < 1e-6


def test_stretched_a_hundred_times():
    random = np.random.default_rng(1)
    tension = 10.0 ** random.uniform(1.5, 2.5, COUNT)  # EA is 1 N
    angle = random.uniform(-1.5, 1.5, COUNT)
    assert largest_error(tension * np.cos(angle), tension * np.sin(angle), 1.0) < 1e-11
