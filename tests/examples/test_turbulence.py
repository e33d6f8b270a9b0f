"""Flights in turbulence: the box that the example makes, and what it prints and draws."""

import re
import sys

import numpy as np
import pytest

from running import EXAMPLES, assert_is_drawn, run_code, run_python

sys.path.append(str(EXAMPLES))

from wind import box_of_turbulence as box

PAGE = EXAMPLES.parent / "docs" / "use" / "example_fmus.md"
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


def test_prints_and_draws_what_the_page_says(tmp_path, folder):
    """Within 2 %: the parked kite amplifies what other libraries of mathematics round."""
    code = f"""
from pathlib import Path
from wind import turbulence
turbulence.find_fmu = lambda name: Path({str(folder)!r}) / f"{{name}}.fmu"
turbulence.main(["--out", {str(tmp_path)!r}])
"""
    done = run_code(code)
    assert done.returncode == 0, done.stderr
    page = PAGE.read_text(encoding="utf-8")
    for name in FLIGHTS:
        (said,) = re.findall(rf"^{name}: (.*)$", done.stdout, re.MULTILINE)
        (written,) = re.findall(rf"^\| {name} \| (.*)$", page, re.MULTILINE)
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
def test_wrong_boxes_end_in_one_line(tmp_path, folder, options, words):
    given = ("--fmu", folder / "TetherDynamic.fmu", "--out", tmp_path, *options)
    done = run_python(EXAMPLES / "wind" / "turbulence.py", *given, cwd=tmp_path)
    assert done.returncode == 2
    assert words in done.stderr
    assert len(done.stderr.splitlines()) == 1
