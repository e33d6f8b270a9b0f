"""Figures of the site follow the theme of the reader: paper and ink change places, colour maps stay."""

import re
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure

from pictures import DARK, as_svg, darkened, legible, save, save_moving, themed
from tetherfmu.console.colours import BLACK, GREY, PALETTE

FIGURES = Path(__file__).resolve().parents[2] / "docs" / "figures"
LEAST = 4.5  # contrast of text by WCAG 2.1, level AA


def luminance(colour):
    """Relative luminance of a colour, as WCAG 2.1 defines it."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in mpl.colors.to_rgb(colour)]
    return sum(share * c for share, c in zip((0.2126, 0.7152, 0.0722), linear, strict=True))


def contrast(one, other):
    """Contrast of two colours, from 1 to 21."""
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_paper_and_ink_change_places():
    assert contrast(darkened("#000000"), darkened("#ffffff")) > 10.0
    assert luminance(darkened("#ffffff")) < luminance(darkened("#808080")) < luminance(darkened("#000000"))


@pytest.mark.parametrize("colour", DARK)
def test_colours_can_be_read_on_dark_paper(colour):
    """Lines become lighter than paper, pale areas darker than ink."""
    other = darkened("#ffffff") if contrast(colour, "#ffffff") > 3.0 else darkened("#000000")
    assert contrast(darkened(colour), other) > LEAST


@pytest.mark.parametrize("colour", [*map(str.lower, PALETTE.values()), GREY, BLACK])
def test_letters_can_be_read_on_white(colour):
    """In each colour of the project, as in one that is as little darker as possible."""
    shown = legible(colour) or colour
    assert contrast(shown, "#ffffff") >= LEAST
    assert shown == colour or contrast(shown, "#ffffff") < 1.05 * LEAST


def test_letters_of_figures_are_legible(tmp_path):
    figure = Figure()
    figure.text(0.5, 0.5, "wind", color="#56B4E9")
    save(figure, tmp_path / "letters.svg")
    rule = f'g[style*="fill: #56b4e9"] {{fill: {legible("#56b4e9")} !important}}'
    assert rule in (tmp_path / "letters.svg").read_text(encoding="utf-8")


def test_colours_of_a_map_stay():
    shades = mpl.colormaps["viridis"].resampled(64)
    assert [colour for colour in map(mpl.colors.to_hex, map(shades, range(64))) if darkened(colour)] == []


def drawn(path):
    """A figure, with a line in a colour that becomes lighter."""
    figure = Figure()
    figure.subplots().plot([0.0, 1.0], color="#0072B2")
    save(figure, path)
    return path.read_text(encoding="utf-8")


def test_equal_figures_are_equal_files_with_rules_for_dark(tmp_path):
    first, second = (drawn(tmp_path / f"{name}.svg") for name in ("first", "second"))
    assert first == second == themed(first)
    assert f'[style*="stroke: #0072b2"] {{stroke: {DARK["#0072b2"]} !important}}' in first


def test_a_line_moves(tmp_path):
    """Its first and its last place are where matplotlib draws them, from the upper left corner."""
    figure = Figure(figsize=(2.0, 1.0))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0))
    (line,) = axes.plot([0.0], [0.0])
    save_moving(figure, {line: np.array([[(0.0, 0.0), (1.0, 1.0)], [(0.5, 0.5), (1.0, 0.0)]])}, 2.0, tmp_path / "moving")
    picture = (tmp_path / "moving.svg").read_text(encoding="utf-8")
    (values,) = re.findall(
        r'<animate attributeName="d" dur="2s" repeatCount="indefinite" values="([^"]*)"/></path>', picture
    )
    assert values == "M0.0 72.0L144.0 0.0;M72.0 36.0L144.0 72.0"  # points of 1/72 in
    assert re.search(r'<g id="moving_0">\s*<path d="M 0 72 \nL 144 0 \n"', picture)


def test_pictures_of_examples_become_svg(tmp_path):
    with as_svg():
        Figure().savefig(tmp_path / "example.png", dpi=150)
    assert [path.name for path in tmp_path.iterdir()] == ["example.svg"]


@pytest.mark.parametrize("path", sorted(FIGURES.rglob("*.svg")), ids=lambda path: path.stem)
def test_figures_have_rules_for_dark(path):
    picture = path.read_text(encoding="utf-8")
    assert themed(picture) == picture
    assert not re.search(r"\bd=\"[^\"]*\.\d{3}", picture)  # hundredths of a point
