"""The tutorial as a user runs it: each lesson draws, prints a line, does no more work than it may; copies run."""

import re
from pathlib import Path

import pytest

from running import assert_is_drawn, run, run_python
from tetherfmu.__main__ import main as tetherfmu
from tetherfmu.libraries.examples import EXAMPLES, example

MOST_WORK = 200_000  # evaluations and steps of a lesson: with 15 microseconds for each from Python, three seconds
MOST_SIMULATED = 130.0  # seconds: 6500 rows of 20 ms to compute and to draw
LEAST_LINES, MOST_LINES = 20, 60  # of its file: what a newcomer reads at a sitting
MOVING = ("05", "06", "08", "11", "12")  # lessons with an animation
LINE = re.compile(r"^(\w+): .+; ([\d.e+-]+) s in [\d.e+-]+ ms, [\d.e+-]+ times real time \((.+)\)$")
lessons = example("tutorial.command").lessons
NAMES = list(lessons())
COSTS = [
    "solve_ivp without events: COST (published: Julia 0.606 ms, Python 20 ms)",
    "solve_ivp with events: COST (published: Julia 0.741 ms, Python 31 ms)",
]


@pytest.mark.parametrize("names", [NAMES[:8], NAMES[8:18], NAMES[18:]], ids=["01 to 06", "06b to 13", "quasi-steady"])
def test_each_lesson_runs(fmu_folder, tmp_path, names):
    """Some in one process."""
    code = f"""
import effort
effort.count()
from tetherfmu.__main__ import main
for name in {names}:
    assert main(["tutorial", name, "--out", {str(tmp_path)!r}]) == 0
    print("work", *effort.spent())
"""
    lines = run(fmu_folder, code).splitlines()
    work = [list(map(int, line.split()[1:])) for line in lines if line.startswith("work")]
    assert max(map(sum, work)) <= MOST_WORK
    uncounted = [name for name, (evaluations, steps) in zip(names, work, strict=True) if not evaluations + steps]
    assert uncounted == [name for name in names if name == "11"]  # an FMU does the work there
    said = [found for found in map(LINE.match, lines) if found]
    assert [found[1] for found in said] == [lessons()[name].stem for name in names]
    for found in said:
        assert float(found[2]) <= MOST_SIMULATED
        assert_is_drawn(Path(found[3]))
    if "03c" in names:  # the cost of events, beside the published times
        assert [
            re.sub(r"\d+\.\d\d ms, error \d\.\de-\d\d m", "COST", line) for line in lines if "published" in line
        ] == COSTS


@pytest.mark.parametrize("name", NAMES)
def test_a_lesson_is_short(name):
    """The whole file, with its docstring and blank lines."""
    assert LEAST_LINES <= len(lessons()[name].read_text(encoding="utf-8").splitlines()) <= MOST_LINES


def test_a_script_runs_its_own_lesson_only(tmp_path):
    """It imports other lessons; wrong options end it with status 2, from any folder."""
    script = lessons()["03"]
    done = run_python(script, cwd=tmp_path)
    assert [line.split(":")[0] for line in done.stdout.splitlines()] == ["tether_03"]
    wrong = run_python(script, "--nonsense", cwd=tmp_path)
    assert wrong.returncode == 2
    assert "--nonsense" in wrong.stderr


def test_the_list_has_each_lesson_with_its_question(capsys):
    assert tetherfmu(["tutorial"]) == 0
    *questions, last = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in questions] == NAMES
    assert all(re.search(r"[?.]$", line) for line in questions)
    assert "tetherfmu[examples]" in last
    numbers = "01 02 03 03b 03c 04 05 06 06b 06c 07 08 09 10 10b 11 12 13"
    assert NAMES[:18] == numbers.split()


def test_some_lessons_move(fmu_folder):
    """And what moves is the whole tether, all the time that was simulated."""
    code = f"""
import sys
sys.path.insert(0, {str(EXAMPLES / "tutorial")!r})
for name in {MOVING}:
    found = __import__(f"tether_{{name}}").lesson()
    print(name, round(found.simulated / 0.02) - len(found.movie.positions), *found.movie.positions.shape[1:])
"""
    moved = [line.split() for line in run(fmu_folder, code).splitlines()]
    assert [name for name, *_ in moved] == list(MOVING)
    assert all(abs(int(missing)) <= 1 and int(nodes) > 5 and axes == "3" for _, missing, nodes, axes in moved)


def test_an_animation_is_written_as_gif_or_with_its_frames(tmp_path, monkeypatch, capsys):
    monkeypatch.syspath_prepend(EXAMPLES / "tutorial")
    import lessons
    import tether_05

    full = tether_05.lesson

    def short(in_space):
        found = full()
        movie = found.movie._replace(positions=found.movie.positions[:11], in_space=in_space)
        return found._replace(movie=movie)

    for option, in_space in (("--animate", False), ("--save-frames", True)):
        run_lesson = lessons.command_line(lambda in_space=in_space: short(in_space), tether_05)
        assert run_lesson(["--out", str(tmp_path), option]) == 0
    assert (tmp_path / "tether_05.gif").read_bytes().startswith(b"GIF")
    assert len(list((tmp_path / "tether_05_frames").glob("*.png"))) == 3
    assert "tether_05_frames" in (tmp_path / "tether_05.html").read_text(encoding="utf-8")
    assert str(tmp_path / "tether_05.gif") in capsys.readouterr().out


def test_a_lesson_without_animation_says_so(tmp_path, capsys):
    assert tetherfmu(["tutorial", "01", "--animate", "--out", str(tmp_path)]) == 0
    assert capsys.readouterr().err == "tether_01 has no animation\n"


def test_without_a_display_nothing_can_be_shown(tmp_path, capsys):
    import matplotlib

    matplotlib.use("Agg")
    assert tetherfmu(["tutorial", "01", "--show", "--out", str(tmp_path)]) == 2
    assert "--show needs a display" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_copies_run_where_they_are(tmp_path, capsys):
    """All examples; again only with --overwrite, which leaves other files alone."""
    place = tmp_path / "mine"
    assert tetherfmu(["tutorial", "--copy", str(place)]) == 0
    assert "tetherfmu[examples]" in capsys.readouterr().out
    assert (place / "scenes" / "circle.toml").is_file()
    assert (place / "first_flight" / "circular_flight.py").is_file()
    assert not list(place.rglob("__pycache__"))
    readme = (place / "README.md").read_text(encoding="utf-8")
    assert "docs/use/coupling.md" in readme
    assert "](../" not in readme
    mine, changed = place / "tutorial" / "mine.py", place / "tutorial" / "tether_01.py"
    mine.write_text("mine")
    changed.write_text("changed")
    assert tetherfmu(["tutorial", "--copy", str(place)]) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert changed.read_text() == "changed"
    assert tetherfmu(["tutorial", "--copy", str(place), "--overwrite"]) == 0
    assert mine.read_text() == "mine"
    done = run_python("tutorial/tether_01.py", cwd=place)
    assert LINE.match(done.stdout.strip())
    assert_is_drawn(place / "plots" / "tether_01.png")
