"""The page on how much tether a scene needs has the words and the tables of the sources that write it."""

import csv
import re
import struct
from collections import namedtuple
from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text

from advice.figures import draw_scenes, questions
from advice.page import BY_SCENE, declared
from tetherfmu.console.colours import COLOUR
from tetherfmu.runtime.variants import VARIANTS
from tetherfmu.study.measuring.tables import templates_of

TEMPLATE = "page.md.j2"
DOCS = Path(__file__).resolve().parents[2] / "docs"
TEMPLATES = templates_of(DOCS / "make" / "advice")
PAGE = (DOCS / "use" / "how_much_tether.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("part", ["opening", "advice", "scene_files", "errors", "tolerance", "thresholds"])
def test_words_keys_and_thresholds_are_those_of_the_sources(part):
    """What is not measured for the page: its words, the keys of a scene file, and the thresholds that the advisor reads."""
    template = TEMPLATES.get_template(TEMPLATE)
    written = "".join(template.blocks[part](template.new_context(declared())))
    assert len(written) > 90
    assert written in PAGE


def test_sections_come_in_the_order_of_the_template():
    source, _, _ = TEMPLATES.loader.get_source(TEMPLATES, TEMPLATE)
    heads = [re.findall(r"^#+ .*", text, re.MULTILINE) for text in (source, PAGE)]
    assert heads[0] == heads[1]


def test_the_decision_chart_ends_at_each_variant_once():
    asked, last = questions()
    assert sorted([*(variant for *_, variant in asked), last]) == sorted(COLOUR)


def test_the_file_of_the_advice_has_the_columns_of_the_sources():
    text = (DOCS / "data" / "advice_by_scene.csv").read_text(encoding="utf-8")
    assert next(csv.reader(text.splitlines())) == list(BY_SCENE)


def test_letters_of_the_scenes_are_large_enough(monkeypatch, tmp_path):
    """On a page that is 700 pixels wide no letter is smaller than 11 pixels, which the text of the page is not far from."""
    kept = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, path, dpi, metadata: kept.append((figure, dpi)))
    points = pd.DataFrame({"variant": VARIANTS, "error": [0.1, 0.03, 0.01, 0.003], "cost": [1e-6, 1e-5, 2e-5, 1e-4]})
    reference = SimpleNamespace(own_error=lambda names: 1e-4)
    scenes = map(namedtuple("Named", "name"), "abcdefgh")
    draw_scenes({scene: (reference, points, None) for scene in scenes}, (), tmp_path / "scenes.png")
    ((figure, dpi),) = kept
    figure.canvas.draw()
    shown = 700.0 / (figure.get_size_inches()[0] * dpi)
    sizes = {text.get_fontsize() for text in figure.findobj(Text) if text.get_text()}
    assert min(sizes) * dpi / 72.0 * shown > 11.0
    width = struct.unpack(">I", (DOCS / "figures" / "scenes.png").read_bytes()[16:20])[0]
    assert width == round(figure.get_size_inches()[0] * dpi)
