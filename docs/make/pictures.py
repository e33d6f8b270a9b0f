"""Figures of the site as SVG files that follow the theme of their reader, light or dark.

matplotlib draws them on white. `themed` adds a style sheet to such a file. On a dark theme black and white change places,
and the colours of `DARK` become others. On a light one letters in pale colours become darker. All else, such as a colour
map, stays.
"""

import re
from contextlib import contextmanager
from pathlib import Path
from unittest.mock import patch

import matplotlib as mpl
import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure

PAPER, INK = 0x14, 0xE0  # greys that white and black become
DARK = {  # what other colours become: dark lines, then pale areas
    "#0072b2": "#3a9fdb",  # BLUE
    "#1f77b4": "#4a9fdb",  # the first of matplotlib
    "#332288": "#9a8ff0",  # a component
    "#8c6d46": "#b08d61",  # GROUND
    "#1f4e79": "#74aee0",  # of the sketches
    "#c0392b": "#ea7565",
    "#7d5ba6": "#ad8fd6",
    "#2e8b8b": "#45b5b5",
    "#1f5a92": "#74aee0",  # of the house
    "#dceaf7": "#1d3448",
    "#f3ead7": "#3d3422",
}
CONTRAST = 4.5  # least of letters on white (WCAG 2.1, level AA)
TENSIONS = (
    "plasma_r",
    0.22,
    0.7,
)  # colour map of all tensions, its first and last colour: legible on white and on dark paper
MARK = "prefers-color-scheme"
LETTERS = re.compile(r'<g style="fill: (#[0-9a-f]{6})')  # text; marks and areas are no groups
COLOUR = re.compile(r"(fill|stroke): (#[0-9a-f]{6})\b")
PLACE = re.compile(r"(-?\d+\.\d\d)\d+")  # of a number with more than two decimals
RULES = {  # letters need no font, equal figures are equal files, curves are right to 0.3 points
    "svg.fonttype": "path",
    "svg.hashsalt": "tetherfmu",
    "path.simplify_threshold": 0.3,
}


def colours_of_tensions():
    """Colour map of tensions: one scale in README, pages and site."""
    name, first, last = TENSIONS
    return ListedColormap(mpl.colormaps[name](np.linspace(first, last, 256)))


def darkened(colour):
    """Colour on a dark theme of one on white, both as `#rrggbb`; None if it stays."""
    red, green, blue = (int(colour[k : k + 2], 16) for k in (1, 3, 5))
    if max(red, green, blue) - min(red, green, blue) > 8:
        return DARK.get(colour)
    grey = round(INK + (PAPER - INK) * (red + green + blue) / 3.0 / 255.0)
    return "#" + 3 * f"{grey:02x}"


def luminance(colour):
    """Relative luminance (WCAG 2.1) of red, green and blue, array (3,)."""
    return np.where(colour <= 0.04045, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4) @ (0.2126, 0.7152, 0.0722)


def legible(colour):
    """Colour of letters on white that are pale in this one, as `#rrggbb`; None if it stays."""
    shades = np.linspace(1.0, 0.0, 101)[:, None] * mpl.colors.to_rgb(colour)
    first = next(k for k, shade in enumerate(shades) if 1.05 / (luminance(shade) + 0.05) >= CONTRAST)
    return mpl.colors.to_hex(shades[first]) if first and colour != "#ffffff" else None


def rules_for_light(picture):
    """Rules of CSS for the letters of a picture on white."""
    found = {colour: legible(colour) for colour in sorted(set(LETTERS.findall(picture)))}
    return "\n".join(f'g[style*="fill: {colour}"] {{fill: {dark} !important}}' for colour, dark in found.items() if dark)


def rules_for_dark(picture):
    """Rules of CSS for the colours of a picture on dark paper; what has no colour in its file is black."""
    found = {(what, colour): darkened(colour) for what, colour in sorted(set(COLOUR.findall(picture)))}
    lines = [f"svg {{fill: {darkened('#000000')}}}"]
    lines += [f'[style*="{what}: {colour}"] {{{what}: {dark} !important}}' for (what, colour), dark in found.items() if dark]
    return "\n".join(lines)


def themed(picture):
    """Text of an SVG file, with rules for both themes and its coordinates in hundredths of a point."""
    if MARK in picture:
        return picture
    short = re.sub(r'\b(d|x|y)="[^"]*"', lambda found: PLACE.sub(r"\1", found[0]), picture)
    themes = {f"({MARK}: dark)": rules_for_dark(short), f"not all and ({MARK}: dark)": rules_for_light(short)}
    style = "\n".join(f"@media {theme} {{\n{rules}\n}}" for theme, rules in themes.items() if rules)
    return re.sub(r"(<svg\b[^>]*>)", lambda found: f"{found[0]}\n <style>{style}</style>", short, count=1)


def save(figure, path):
    """Write a figure to an SVG file, whatever the ending of the path."""
    path = Path(path).with_suffix(".svg")
    with mpl.rc_context(RULES):
        SAVE(figure, path, format="svg", metadata={"Date": None, "Creator": None})
    path.write_text(themed(path.read_text(encoding="utf-8")), encoding="utf-8")


def places(axes, points):
    """Attributes `d` of paths through points in data, array (frames, points, 2)."""
    shown = axes.transData.transform(points.reshape(-1, 2)).reshape(points.shape) * 72.0 / axes.figure.dpi
    shown[..., 1] = 72.0 * axes.figure.get_size_inches()[1] - shown[..., 1]
    return ["M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in frame) for frame in shown]


def save_moving(figure, moving, seconds, path, colours=()):
    """Write a figure whose lines move to an SVG file, which has its first frame where nothing moves.

    moving : line -> array (frames, points, 2), in data.  seconds : from the first frame to its return.  colours : of some of
    these lines, `#rrggbb` in each frame.
    """
    path, colours = Path(path).with_suffix(".svg"), dict(colours)
    figure.canvas.draw()
    figure.set_layout_engine("none")  # nothing else moves
    for number, (line, points) in enumerate(moving.items()):
        line.set_gid(f"moving_{number}")
        line.set_data(*points[0].T)
    save(figure, path)
    picture, timing = path.read_text(encoding="utf-8"), f'dur="{seconds:g}s" repeatCount="indefinite"'
    for number, (line, points) in enumerate(moving.items()):
        before, place, after = picture.partition(f'<g id="moving_{number}">')
        drawn, _, after = after.partition("/>")
        animated = {"d": places(line.axes, points), "stroke": colours.get(line)}
        animations = "".join(
            f'<animate attributeName="{name}" {timing} values="{";".join(values)}"/>'
            for name, values in animated.items()
            if values
        )
        picture = f"{before}{place}{drawn}>{animations}</path>{after}"
    path.write_text(picture, encoding="utf-8")


SAVE = Figure.savefig


@contextmanager
def as_svg():
    """Within it, figures that examples save as PNG become such files beside it."""
    with patch.object(Figure, "savefig", lambda figure, path, **_: save(figure, path)):
        yield
