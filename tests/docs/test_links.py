"""Every link of the manual leads somewhere: files, sections of pages, and addresses that are whole."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = sorted([*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md"), *ROOT.glob("examples/**/*.md")])
LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")


def without_code(text):
    """A page without its blocks of code and its literals."""
    return re.sub(r"`[^`\n]*`", "", re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL))


def anchors(path):
    """Names by which links reach the sections of a page, made as GitHub and MyST make them."""
    heads = re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```$", "", path.read_text("utf-8"), flags=re.M | re.S), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(path):
    for link in LINK.findall(without_code(path.read_text(encoding="utf-8"))):
        target, _, section = link.partition("#")
        if re.match(r"\w+:", link):
            assert re.fullmatch(r"https://[\w.-]+\.\w+(/\S*)?", link), link
        else:
            file = (path.parent / target).resolve() if target else path
            assert file.exists(), link
            assert not section or section in anchors(file), link


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_tests_that_a_page_names_are_there(path):
    named = re.findall(r"\btests/[\w/]+\.\w+", path.read_text(encoding="utf-8"))
    assert [name for name in named if not (ROOT / name).exists()] == []


SOURCES = [path for folder in ("fmu_sources", "examples", "tests", "docs") for path in (ROOT / folder).rglob("*.*")]
CITING = sorted(path for path in SOURCES if path.suffix in (".py", ".c", ".h", ".js", ".md"))
PACKAGE = ROOT / "fmu_sources" / "tetherfmu"
ROOMS = [
    PACKAGE,
    *(PACKAGE / room for room in ("kernels", "runtime", "study")),
    *map(ROOT.joinpath, ("docs", "examples", "tests")),
]
CITED = re.compile(r"`((?:\w+/)+\w+\.(?:py|c|h|js|toml))`")


def test_files_that_others_cite_are_there():
    """With a path, in code and on pages, from a folder of the project or from one above the file."""
    cited = [(path, name) for path in CITING for name in CITED.findall(path.read_text(encoding="utf-8"))]
    assert len(cited) > 200
    assert [each for each in cited if not any((room / each[1]).exists() for room in (*ROOMS, *each[0].parents))] == []


def test_links_are_found():
    """Most pages have one, also to sections; else the test above would hold of nothing."""
    links = [LINK.findall(without_code(path.read_text(encoding="utf-8"))) for path in PAGES]
    assert sum(map(bool, links)) > 0.8 * len(PAGES)
    assert any("#" in link for each in links for link in each)


def test_the_readme_links_to_pages_that_are_there_for_each_kind_of_user():
    table = (ROOT / "README.md").read_text(encoding="utf-8").partition("## Where to go next")[2].partition("##")[0]
    rows = [row for row in table.splitlines() if "](" in row]
    assert rows
    assert all(len(LINK.findall(row)) == 3 for row in rows)
