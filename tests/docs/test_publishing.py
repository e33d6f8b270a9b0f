"""The files for publishing say what the project says: versions, requirements, keywords, figures, references."""

import json
import re
import tomllib
from pathlib import Path

import pytest
import yaml

from tetherfmu.runtime import __version__

PROJECT = Path(__file__).parents[2]
PUBLISHING = PROJECT / "docs" / "publishing"
DECLARED = tomllib.loads((PROJECT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
PAPER = (PUBLISHING / "paper.md").read_text(encoding="utf-8")
BENCHMARKS, STABILITY = "docs/measurements/benchmarks.md", "docs/measurements/stability.md"
FIGURES = {  # of the paper, and the page that has them from its script
    r"takes (\d+ µs) in FMPy": BENCHMARKS,
    r"(\S+ to \S+ times faster) than the same": BENCHMARKS,
    r"MoorDyn takes (\S+ to \S+ times as long)": BENCHMARKS,
    "(43 000 flights)": STABILITY,
    "(12 835 flights)": STABILITY,
}


SECTIONS = ("Summary", "Statement of need", "State of the field", "Software design", "Research impact statement")
SECTIONS += ("AI usage disclosure", "Acknowledgements", "References")  # that the journal asks for


def words(text):
    """A text with its lines as one."""
    return " ".join(text.split())


def test_versions_and_licence_are_those_of_the_project():
    cited = yaml.safe_load((PROJECT / "CITATION.cff").read_text(encoding="utf-8"))
    archived = json.loads((PROJECT / ".zenodo.json").read_text(encoding="utf-8"))
    recipe = yaml.safe_load((PUBLISHING / "recipe.yaml").read_text(encoding="utf-8"))
    assert cited["version"] == archived["version"] == recipe["context"]["version"] == __version__
    assert cited["license"] == archived["license"] == recipe["about"]["license"] == DECLARED["license"]
    assert cited["title"] == archived["title"]
    assert [each["name"] for each in cited["authors"]] == [each["name"] for each in archived["creators"]]
    assert archived["keywords"] == cited["keywords"] == DECLARED["keywords"]
    assert archived["description"] == cited["abstract"]
    assert recipe["about"]["summary"] == DECLARED["description"]


def test_conda_requires_what_pip_does():
    recipe = yaml.safe_load((PUBLISHING / "recipe.yaml").read_text(encoding="utf-8"))
    required = {
        f"python {DECLARED['requires-python']}",
        *(re.sub(r"(?<=\w)(?=[<>=])", " ", each, count=1) for each in DECLARED["dependencies"]),
    }
    assert set(recipe["requirements"]["run"]) == required
    assert recipe["build"]["python"]["entry_points"] == [f"{name} = {place}" for name, place in DECLARED["scripts"].items()]


@pytest.mark.parametrize("figure", FIGURES)
def test_figures_of_the_paper_are_those_of_the_pages(figure):
    (found,) = re.findall(figure, words(PAPER))
    assert found in words((PROJECT / FIGURES[figure]).read_text(encoding="utf-8"))


def test_the_paper_has_the_form_of_its_journal():
    head = yaml.safe_load(PAPER.split("---\n")[1])
    assert {"title", "tags", "authors", "affiliations", "date", "bibliography"} <= head.keys()
    for section in SECTIONS:
        assert f"\n# {section}\n" in PAPER
    assert 750 <= len(PAPER.partition("# Summary")[2].split()) <= 1750
    cited = set(re.findall(r"@(\w+)", PAPER.split("---\n")[2]))
    listed = re.findall(r"^@\w+\{(\w+),", (PUBLISHING / "paper.bib").read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert sorted(cited) == sorted(listed)
