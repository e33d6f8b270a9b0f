"""The house: import contract, figure and manual agree; imports point downwards, without a circle."""

import re
from pathlib import Path

import pytest

import make_house

ROOT = Path(__file__).resolve().parents[2]
HEIGHT = {room: -level for level, floor in enumerate(make_house.floors()) for room in floor}


@pytest.fixture(scope="module")
def arrows():
    """Pairs of rooms, of which the first imports the second."""
    return make_house.arrows()


def test_arrows_point_downwards(arrows):
    assert [(start, end) for start, end in sorted(arrows) if HEIGHT[start] <= HEIGHT[end]] == []


def test_each_room_has_an_arrow(arrows):
    """It imports another one, or is imported; so there are arrows."""
    assert {room for arrow in arrows for room in arrow} == HEIGHT.keys()


def test_each_folder_is_a_room():
    folders = {path.parent.relative_to(make_house.PACKAGE) for path in make_house.PACKAGE.rglob("__init__.py")}
    names = {
        ".".join(folder.parts)
        for folder in folders
        if folder.parts and (folder.parts[0] not in ("export", "files", "study") or len(folder.parts) == 1)
    }
    assert names <= HEIGHT.keys()


def test_the_manual_describes_no_other_room():
    """What each room does stands in the figure; the manual has what is not in it."""
    manual = (ROOT / "docs" / "contributors" / "developing.md").read_text(encoding="utf-8")
    section = manual.partition("## Architecture")[2].partition("\n## ")[0]
    described = set(re.findall(r"^\*\*([\w. ]+)\*\*", section, re.MULTILINE))
    assert described
    assert described < HEIGHT.keys()


def test_the_figure_has_the_present_rooms_and_words(tmp_path):
    """`python docs/make/make_house.py` draws it again; its texts are also comments in the file."""
    make_house.draw(tmp_path / "house.svg")
    shown, present = (
        re.findall("<!-- (.*) -->", path.read_text(encoding="utf-8")) for path in (make_house.FIGURE, tmp_path / "house.svg")
    )
    assert shown == present
    assert {room.removeprefix("kernels.") for room in HEIGHT} - {"kernels"} <= set(shown)


def test_only_pairs_arrays_and_the_compilation_know_llvm():
    knowing = {
        path.relative_to(make_house.PACKAGE).as_posix()
        for path in (make_house.PACKAGE / "kernels").rglob("*.py")
        if re.search(r"llvmlite|numba\.extending|numba\.core", path.read_text(encoding="utf-8"))
    }
    assert knowing == {"kernels/linear_algebra/pairs.py", "kernels/flat_arrays.py", "kernels/compilation.py"}


def test_only_one_file_of_the_kernels_knows_the_places_of_the_parameters():
    knowing = [
        path.name
        for path in (make_house.PACKAGE / "kernels").rglob("*.py")
        if "PARAMETER_SCALARS" in path.read_text("utf-8")
    ]
    assert knowing == ["properties.py"]
