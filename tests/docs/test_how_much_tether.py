"""The page on how much tether a scene needs has the words and the tables of the sources that write it."""

import csv
import re
from pathlib import Path

import pytest

from tetherfmu.console.colours import COLOUR
from tetherfmu.study.advice.figures import questions
from tetherfmu.study.advice.page import BY_SCENE, declared
from tetherfmu.study.measuring.tables import TEMPLATES

TEMPLATE = "advice/page.md.j2"
DOCS = Path(__file__).resolve().parents[2] / "docs"
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
