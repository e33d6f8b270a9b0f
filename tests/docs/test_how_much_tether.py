"""The page on how much tether a scene needs has the words and the tables of the sources that write it."""

from pathlib import Path

from tetherfmu.study.advice.page import threshold_table
from tetherfmu.study.advice.page_text import CLOSING, OPENING, scene_file_tables

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "how_much_tether.md").read_text(encoding="utf-8")


def test_words_and_keys_are_those_of_the_sources():
    assert OPENING in PAGE
    assert CLOSING in PAGE
    assert "\n".join(scene_file_tables()) in PAGE


def test_thresholds_are_those_that_the_advisor_reads():
    assert "\n".join(threshold_table()) in PAGE
