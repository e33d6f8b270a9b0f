"""Flights in turbulence: the box that the example makes, winds between ends, spectra of the force, and what is printed."""

import re
from dataclasses import replace

import numpy as np
import pytest

from manual import page
from running import EXAMPLES, assert_is_drawn, run_code, run_python
from tetherfmu import FrozenTurbulence, open_box
from wind import box_of_turbulence as box
from wind import force_spectrum, own_flight

FLIGHTS = ("parked kite", "parked kite, mean wind alone", "circle", "circle, mean wind alone")


def spectral_divergence(field, spacing):
    """Root mean square of the divergence of a periodic field over that of its gradients."""
    waves = [np.fft.fftn(field[..., i]) for i in range(3)]
    k = np.meshgrid(*(np.fft.fftfreq(n, d) for n, d in zip(field.shape[:3], spacing, strict=True)), indexing="ij")
    divergence = sum(each * wave for each, wave in zip(k, waves, strict=True))
    gradients = sum(np.abs(each * wave) ** 2 for each in k for wave in waves)
    return np.sqrt((np.abs(divergence) ** 2).sum() / gradients.sum())


def test_the_box_is_free_of_divergence_and_has_its_deviation():
    """With 1e-6 of it, the rounding of 32-bit numbers."""
    field = box.velocity(1.2, points=(64, 32, 32))
    assert field.dtype == np.float32
    assert field[..., 0].std() == pytest.approx(1.2, rel=1e-6)
    assert np.abs(field.mean(axis=(0, 1, 2))).max() < 1e-6
    assert spectral_divergence(field, box.SPACING) < 1e-6


def test_the_box_has_the_spectrum_of_von_karman():
    """Along the wind F(k) ~ (1 + (k L)^2)^(-5/6): from one twentieth of the shortest wave's number to a fifth of it.

    The sum over 48 x 96 lines scatters by a few percent, and short waves across, which the grid lacks, take a tenth.
    """
    field = box.velocity(1.0)[..., 0]
    power = (np.abs(np.fft.rfft(field, axis=0)) ** 2).mean(axis=(1, 2))
    k = 2.0 * np.pi * np.fft.rfftfreq(box.POINTS[0], box.SPACING[0])
    shape = power * (1.0 + (k * box.LENGTH) ** 2) ** (5.0 / 6.0)
    low, high = shape[8:16].mean(), shape[16:26].mean()
    assert high == pytest.approx(low, rel=0.2)


def test_prints_and_draws_what_the_page_says(tmp_path, dist):
    """Within 2 %: the parked kite amplifies what other libraries of mathematics round."""
    code = f"""
from pathlib import Path
from wind import turbulence
turbulence.find_fmu = lambda name: Path({str(dist)!r}) / f"{{name}}.fmu"
turbulence.main(["--out", {str(tmp_path)!r}])
"""
    done = run_code(code)
    assert done.returncode == 0, done.stderr
    for name in FLIGHTS:
        (said,) = re.findall(rf"^{name}: (.*)$", done.stdout, re.MULTILINE)
        (written,) = re.findall(rf"^\| {name} \| (.*)$", page("use/example_fmus"), re.MULTILINE)
        numbers = [np.array(re.findall(r"\d+\.?\d*", text), dtype=float) for text in (said, written)]
        np.testing.assert_allclose(*numbers, rtol=0.02, atol=0.11)  # one of the last digit
    assert_is_drawn(tmp_path / "turbulence.png")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--box", EXAMPLES / "README.md"), "is not the name of a wind box"),
        (("--box", EXAMPLES.parent / "tests" / "reference" / "mann_u.turb"), "does not say how many points it has"),
        (("--points", "1.5", "4", "8"), "'1.5' is not possible; it must be a whole number"),
    ],
)
def test_wrong_boxes_end_in_one_line(tmp_path, dist, options, words):
    given = ("--fmu", dist / "TetherDynamic.fmu", "--out", tmp_path, *options)
    done = run_python(EXAMPLES / "wind" / "turbulence.py", *given, cwd=tmp_path)
    assert done.returncode == 2
    assert words in done.stderr
    assert len(done.stderr.splitlines()) == 1


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


SPACING = 10.0  # of the box [m]; the wind carries a gust of that size past a point in 1 s


@pytest.mark.parametrize(("share", "allowed"), [(0.997, 0.05), (0.98, 0.01)])
def test_the_spectrum_at_low_frequency(share, allowed):
    """Of the power. The sag turns the tether out of its chord: 2.4 % less for 0.3 % of stretch, 0.1 % for 2 %. With the load
    halved between the ends, whatever its place, it would be wrong by tens of percent, as that of the catenary is.
    """
    tether = replace(force_spectrum.TAUT, initial_length=share * force_spectrum.DISTANCE)
    assert force_spectrum.ratio_in_band(force_spectrum.spectra(SPACING, tether)) == pytest.approx(1.0, abs=allowed)


def test_the_power_of_a_sine():
    """A force of amplitude A has the power A^2/2, all of it at its frequency."""
    time = force_spectrum.STEP * np.arange(6400)
    force = np.zeros((6400, 3))
    force[:, 1] = 3.0 * np.sin(2.0 * np.pi * 0.0625 * time) + 7.0
    density = force_spectrum.spectrum(force)
    assert density.argmax() == 8
    assert density[8] / 128.0 == pytest.approx(4.5, rel=1e-12)
