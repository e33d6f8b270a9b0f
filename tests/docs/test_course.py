"""The course: each lesson is short, has all its parts, and runs as a script; what it prints agrees with a formula."""

import re
from pathlib import Path

import numpy as np
import pytest

import make_course
import tetherfmu
from course_pages import CODE, lessons, notebook
from running import run_code

DOCS = Path(__file__).resolve().parents[2] / "docs"
LESSONS = lessons(DOCS)
MOST_LINES, WIDEST = 20, 105  # of code on a page, of a line that a window of 1400 px shows
WEIGHT = 724.0 * np.pi / 4.0 * 0.004**2 * 9.81  # of the default tether [N/m]
each_lesson = pytest.mark.parametrize("path", LESSONS, ids=lambda path: path.stem)


def code_of(path):
    """The code of all cells of a page."""
    return "".join(CODE.findall(path.read_text(encoding="utf-8")))


@each_lesson
def test_code_is_short(path):
    lines = [line for line in code_of(path).splitlines() if line.strip()]
    assert 0 < len(lines) <= MOST_LINES
    assert max(map(len, lines)) <= WIDEST


@each_lesson
def test_all_parts_are_there(path):
    """A title with a number, for whom the lesson is, a question, a picture, what to change, an exercise, its answer."""
    text = path.read_text(encoding="utf-8")
    start = re.match(r"# (\d+)\. .+\n\nFor [^\n]*(?:\n[^\n]+)*After this lesson you can", text)
    assert start[1] == path.stem[:2].lstrip("0")
    parts = ["**Question.**", "plt.show()", "## What to change next", "## Exercise", "<summary>"]
    assert sorted(parts, key=text.index) == parts
    assert text.rstrip().endswith("</details>")  # the answer is the last
    assert f"](../figures/course/{path.stem}.svg)" in text


@each_lesson
def test_it_imports_public_names_only(path):
    for module, names in re.findall(r"^\s*from (tetherfmu[\w.]*) import (.+)$", code_of(path), re.MULTILINE):
        assert module == "tetherfmu"
        assert set(names.split(", ")) <= set(tetherfmu.__all__)
    assert set(re.findall(r"^\s*import (tetherfmu\S*)", code_of(path), re.MULTILINE)) <= {"tetherfmu"}


@each_lesson
def test_its_notebook_has_its_code_and_no_outputs(path):
    cells = notebook(path.read_text(encoding="utf-8"))["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert [f"{cell['source']}\n" for cell in code] == CODE.findall(path.read_text(encoding="utf-8"))
    assert code[-1]["metadata"]["jupyter"]["source_hidden"]
    assert not any(re.search(r"</?details>|\]\(\.\.|^!\[", cell["source"]) for cell in cells)


def test_contents_have_all_lessons_in_order():
    listed = re.findall(r"^\d+\. \[(.+)\]\((\w+)\.md\)$", (DOCS / "course" / "index.md").read_text("utf-8"), re.MULTILINE)
    heads = [path.read_text(encoding="utf-8").partition("\n")[0].partition(". ")[2] for path in LESSONS]
    assert listed == [(head, path.stem) for head, path in zip(heads, LESSONS, strict=True)]
    assert len(listed) == 13


@pytest.fixture
def printed(fmu_folder, tmp_path):
    """Function that runs a lesson beside the FMUs and returns what it prints, which its file shows; it draws a picture."""
    (tmp_path / "dist").symlink_to(fmu_folder, target_is_directory=True)

    def run(number):
        (path,) = (path for path in LESSONS if path.stem.startswith(number))
        texts = make_course.ran(path, tmp_path, lambda code, folder: run_code(code, cwd=folder))
        page = path.read_text(encoding="utf-8")
        without_times = [re.sub(r"[\d.]+ µs", "µs", text) for text in (page, make_course.with_outputs(page, texts))]
        assert without_times[0] == without_times[1]
        assert (tmp_path / "picture.svg").exists()
        return "".join(texts)

    return run


def numbers(pattern, text):
    """The numbers in the groups of a pattern that a text has once; {} stands for a number."""
    (found,) = re.findall(pattern.replace("{}", r"(-?[\d.]+)"), text)
    return [float(number) for number in np.atleast_1d(found)]


def test_1_a_taut_tether_is_a_spring(printed):
    """The kite end also carries half of the weight, along the tether."""
    spring, fmu = numbers("spring: {} N, FMU: {} N", printed("01"))
    assert spring == pytest.approx(614600.0 * (500.0 / 497.5 - 1.0), abs=0.5)
    assert fmu == pytest.approx(spring + 0.5 * WEIGHT * 497.5 * 0.8, rel=3e-3)  # the wave that the last segment brings


def test_2_end_forces_are_weight_and_drag(printed):
    """The sag turns the tether by some degrees: 2 % of the drag."""
    text = printed("02")
    for name in ("along the wind", "upwards"):
        measured, formula = numbers(name + ": {} N, by formula {} N", text)
        assert measured == pytest.approx(formula, rel=0.02)


def test_3_a_kite_feels_a_quarter_of_the_drag(printed):
    """The rest, some percent, is the lag of the tether behind its chord."""
    text = printed("03")
    slow, fast = numbers("at 20 m/s the tether holds the kite back with {} N, at 40 m/s {} N", text)
    assert fast == pytest.approx(4.0 * slow, rel=0.03)
    assert numbers("measured: {}", text)[0] == pytest.approx(0.25, rel=0.04)


def test_4_segments_are_of_second_order(printed):
    text = printed("04")
    names = ("TetherStraight", "TetherCatenary", "TetherQuasiSteady", "TetherDynamic")
    errors = [numbers(name + ": error {}%", text)[0] for name in names]
    assert errors == sorted(errors, reverse=True)
    assert numbers("a factor of {}", text)[0] == pytest.approx(4.0, rel=0.1)  # 4, and a term of fourth order


def test_5_drag_is_its_integral_over_the_height(printed):
    text = printed("05")
    measured, formula = numbers("both ends: {} N, by the integral {} N", text)
    assert measured == pytest.approx(formula, rel=5e-3)  # 20 segments, and the bow of the tether
    calm, gusty = (numbers(name + ": mean pull {} N, largest {} N", text) for name in ("mean wind", "turbulence"))
    assert calm[0] == calm[1]
    assert gusty[1] > calm[1]


def test_6_a_drum_with_inertia_changes_the_tension(printed):
    text = printed("06")
    assert numbers(r"\b0 kg: {} to {} N", text) == [3000.0, 3000.0]
    formula, measured = numbers("by formula {} N to both sides, in the flight {} N", text)
    assert measured == pytest.approx(formula, rel=0.05)  # the rope at the drum has mass, too


def test_7_the_kite_rests_where_moments_balance(printed):
    """About the ground station, with the tether as its chord: half of its weight and drag act at the kite."""
    text = printed("07")
    measured = numbers("at {} degrees", text)[0]
    push = 0.5 * 1.225 * 8.0**2
    lift, drag, air = 7.0 * push - 98.1, 1.5 * push, push * 0.958 * 0.004 * 200.0
    angles = np.radians(np.linspace(45.0, 90.0, 4501))
    half = 0.5 * (air * np.sin(angles) ** 2 + WEIGHT * 200.0 * np.cos(angles))
    turns = drag * np.sin(angles) - lift * np.cos(angles) + half  # moment over length [N]
    assert measured == pytest.approx(np.degrees(angles[np.abs(turns).argmin()]), abs=0.3)
    alone = np.degrees(np.arctan2(lift, drag))
    assert numbers("^{} degrees", text.splitlines()[-1])[0] == pytest.approx(alone - measured, abs=0.1)


def test_8_the_kite_carries_what_has_left_the_ground(printed):
    text = printed("08")
    for name in ("downwards", "sideways"):
        measured, formula = numbers(name + " {} N, formula {} N", text)
        assert measured == pytest.approx(formula, rel=5e-3)  # the tether stretches


def test_9_a_load_is_a_pendulum(printed):
    period, formula = numbers("period {} s, by formula {} s", printed("09"))
    assert formula == pytest.approx(2.0 * np.pi * np.sqrt(40.0 / 9.81), abs=0.01)
    assert period == pytest.approx(formula, rel=5e-3)  # the amplitude adds 0.2 %


def test_10_ropes_share_the_load(printed):
    """A drone carries the weight of its rope, too, which is 1.3 % of that of the load."""
    text = printed("10")
    last = numbers("36 m apart: each drone is pulled with {} N", text)[0]
    formula = numbers("by statics {} N", text)[0]
    assert formula == pytest.approx(0.5 * 30.0 * 9.81 / np.sqrt(1.0 - 0.9**2), abs=0.5)
    assert formula < last < 1.03 * formula


def test_11_the_tension_leads(printed):
    """The stiffness is that of the mean length; the tether changes its length by a third."""
    pytest.importorskip("pandas", reason="needs the extra study")
    text = printed("11")
    by_hand, tether = numbers(r"a metre is {} kN \(the tether says {} kN\)", text)
    assert by_hand == pytest.approx(tether, rel=0.03)
    error, tension = numbers("so the error is {} kN, of a mean tension of {} kN", text)
    assert error > tension


def test_12_a_delayed_force_needs_short_steps(printed):
    text = printed("12")
    limit = numbers("2 c/k = {} ms", text)[0]
    assert 1.0 < limit < 5.0
    short, longer, longest = (numbers(rf"\b{step} ms: .* factor of {{}}", text)[0] for step in (1, 5, 10))
    assert short < 1.0 < longer < longest


def test_13_a_lean_fmu_gives_the_same_numbers(printed):
    text = printed("13")
    full, lean = (numbers(f"{name}/TetherDynamic.fmu: {{}} variables, pulls with {{}} N", text) for name in ("dist", "lean"))
    assert lean[0] < 0.3 * full[0]
    assert lean[1] == full[1]
    assert text.splitlines()[-1] == str([*(f"kite_position[{i}]" for i in (1, 2, 3)), "kite_tension"])
