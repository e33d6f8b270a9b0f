"""The page on how much tether a scene needs has the words and the tables of the sources that write it."""

from pathlib import Path

import pytest

from tetherfmu.study.advice.page import declared
from tetherfmu.study.advice.rendering import TEMPLATES

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "how_much_tether.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("part", ["opening", "thresholds", "work_precision", "scene_files", "closing"])
def test_words_keys_and_thresholds_are_those_of_the_sources(part):
    """What is not measured for the page: its words, the keys of a scene file, and the thresholds that the advisor reads."""
    template = TEMPLATES.get_template("page.md.j2")
    written = "".join(template.blocks[part](template.new_context(declared())))
    assert len(written) > 90
    assert written in PAGE
