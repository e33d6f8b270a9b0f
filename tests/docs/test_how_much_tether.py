"""The pages on how much tether a scene needs have the words and the tables of the sources that write them."""

import csv
import re
from collections import namedtuple
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from matplotlib.text import Text

import make_scene_files
from advice.figures import draw_scenes, questions
from advice.page import BY_REFERENCE, BY_SCENE, TEMPLATES, choice, limits
from manual import DATA, DOCS, page
from tetherfmu.console.colours import COLOUR
from tetherfmu.runtime.variants import VARIANTS
from tetherfmu.study.measuring.tables import templates_of

QUALITY = page("use/quality_of_advice")
OF_QUALITY = templates_of(TEMPLATES).get_template("quality.md.j2")


def test_the_choice_is_what_its_template_says():
    assert page("use/how_much_tether") == choice()


@pytest.mark.parametrize("part", ["errors", "tolerance", "thresholds"])
def test_words_on_the_quality_are_those_of_the_template(part):
    """What is not measured for the page."""
    written = "".join(OF_QUALITY.blocks[part](OF_QUALITY.new_context()))
    assert len(written) > 90
    assert written.strip() in QUALITY


def test_sections_come_in_the_order_of_the_template():
    source = (TEMPLATES / "quality.md.j2").read_text(encoding="utf-8")
    heads = [re.findall(r"^#+ .*", text, re.MULTILINE) for text in (source, QUALITY)]
    assert heads[0] == heads[1]


def written_table(name):
    """Text of a table in `docs/data`."""
    return (DATA / f"{name}.csv").read_text(encoding="utf-8")


def test_tables_beside_the_pages_are_those_of_the_sources():
    """The keys of a scene file, and the thresholds that the advisor reads."""
    assert written_table("scene_keys") == make_scene_files.keys()
    assert written_table("advice_thresholds") == limits().to_csv(index=False)


def test_the_decision_chart_ends_at_each_variant_once():
    asked, last = questions()
    assert sorted([*(variant for *_, variant in asked), last]) == sorted(COLOUR)


@pytest.mark.parametrize(("name", "columns"), [("advice_by_scene", BY_SCENE), ("advice_references", BY_REFERENCE)])
def test_the_files_of_the_advice_have_the_columns_of_the_sources(name, columns):
    assert next(csv.reader(written_table(name).splitlines())) == list(columns)


def test_letters_of_the_scenes_are_large_enough(monkeypatch, tmp_path):
    """On a page that is 700 pixels wide no letter is smaller than 11 pixels, which the text of the page is not far from."""
    kept = []
    monkeypatch.setattr("advice.figures.save", lambda figure, path: kept.append(figure))
    error, cost = (np.geomspace(*ends, len(VARIANTS)) for ends in ((0.1, 0.003), (1e-6, 1e-4)))
    points = pd.DataFrame({"variant": VARIANTS, "error": error, "cost": cost})
    reference = SimpleNamespace(own_error=lambda names: 1e-4)
    scenes = map(namedtuple("Named", "name"), "abcdefgh")
    draw_scenes({scene: (reference, points, None) for scene in scenes}, (), tmp_path / "scenes.svg")
    (figure,) = kept
    figure.canvas.draw()
    width = 72.0 * figure.get_size_inches()[0]  # points
    sizes = {text.get_fontsize() for text in figure.findobj(Text) if text.get_text()}
    assert min(sizes) * 700.0 / width > 11.0
    picture = (DOCS / "figures" / "scenes.svg").read_text(encoding="utf-8")
    assert float(re.search(r'<svg [^>]*width="([\d.]+)pt"', picture)[1]) == pytest.approx(width)
