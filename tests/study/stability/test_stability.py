"""The stability map: its points, its verdicts, and that it survives crashes and a kill; a small map is run for real."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from tetherfmu.study.stability import pool
from tetherfmu.study.stability.__main__ import main
from tetherfmu.study.stability.flight import Flight, fly
from tetherfmu.study.stability.points import VARIANTS, kite, point
from tetherfmu.study.stability.pool import judge_all, key, read
from tetherfmu.study.stability.report import compared
from tetherfmu.study.stability.verdict import Verdict, judge

POINTS = [point(1, number) for number in range(400)]
DEADLY = POINTS[5]


def judge_or_die(chosen):
    """Stands for a point that takes its process with it."""
    if chosen == DEADLY:
        os._exit(3)
    return Verdict("converged", 0.0, calls=1)


def test_points_keep_to_their_axes():
    for p in POINTS:
        assert 1 <= p.segments <= 300
        assert 0.0099 <= p.segment_length <= 1000.1
        assert 1.0 <= p.length <= 1e4
        assert 1e3 <= p.axial_stiffness <= 1e9
        assert p.axial_damping == 0.0 or 0.1 <= p.axial_damping <= 1e5
        assert -0.01 <= p.slack <= 0.9
        assert 1e-4 <= p.step <= 1.0
        assert (p.fixed_step > 0.0) == (p.variant == "dynamic fixed step")
        assert max(p.wind / 60.0, p.speed / 150.0, abs(p.reel_out_speed) / 20.0, p.gravity / 25.0) <= 1.0
    assert {p.variant for p in POINTS} == set(VARIANTS)
    assert point(1, 7) == POINTS[7] != point(2, 7)
    assert len({key(p) for p in POINTS}) == len(POINTS)


def test_the_kite_keeps_the_slack_and_its_speed():
    for p in POINTS[:50]:
        duration = 30.0 * p.step
        position, velocity = kite(p, duration)
        length = p.length + p.reel_out_speed * duration
        np.testing.assert_allclose(np.linalg.norm(position), length / (1.0 + p.slack), rtol=1e-12)
        ahead, behind = kite(p, duration + 1e-6 * duration)[0], kite(p, duration - 1e-6 * duration)[0]
        # central difference over 2e-6 of the flight: rounding of a position over that time
        rounding = 1e-15 * np.linalg.norm(position) / (1e-6 * duration)
        np.testing.assert_allclose(
            (ahead - behind) / (2e-6 * duration), velocity, atol=1e-6 * (1.0 + p.speed) + 3.0 * rounding
        )


def flight(**changes):
    forces = np.ones((5, 6))
    return Flight("", forces, 1.0, 10.0, 1.0, 10.0, 0, 100.0, 0.01, True)._replace(**changes)


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        ({}, {}, "converged"),
        ({}, {"forces": 1e6 * np.ones((5, 6))}, "stable"),
        ({}, {"forces": np.ones((0, 6)), "refusal": "budget spent"}, "stable"),
        ({"refusal": "budget spent"}, {}, "refused"),
        ({"finite": False}, {}, "wrong"),
        ({"peak": 10.1}, {}, "wrong"),
        ({"fastest": 10.1}, {}, "wrong"),
        ({"peak": 10.1, "refusal": "state not finite"}, {}, "wrong"),
        ({"longest": 2.1}, {}, "hanging"),
    ],
)
def test_verdicts(monkeypatch, first, second, expected):
    flights = iter((flight(**first), flight(**second)))
    monkeypatch.setattr("tetherfmu.study.stability.verdict.fly", lambda *arguments, **options: next(flights))
    assert judge(POINTS[0]).verdict == expected


def test_a_tension_beyond_the_bound_is_seen():
    """The bound is not so wide that nothing can exceed it: the taut tether of a point stretched to twice its length."""
    chosen = next(
        p for p in POINTS if p.variant == "dynamic" and p.axial_stiffness > 1e6 and p.slack > 0.0 and p.speed < 50.0
    )
    flown = fly(chosen)
    assert 0.0 < flown.bound < chosen.axial_stiffness


def test_a_point_that_kills_its_process_is_found(tmp_path):
    results = judge_all(POINTS[:12], tmp_path / "map.jsonl", 2, judge_or_die)
    assert [v.verdict for p, v in results if p == DEADLY] == ["crashed"]
    assert all(v.verdict == "converged" for p, v in results if p != DEADLY)


def test_a_point_that_hangs_is_found():
    assert pool._judge_alone(time.sleep, 0.0, 1.0) is None
    assert pool._judge_alone(time.sleep, 30.0, 1.0).verdict == "hanging"


def test_finished_points_are_not_judged_again(tmp_path):
    path = tmp_path / "map.jsonl"
    judge_all(POINTS[:4], path, 1, judge_or_die)
    first = path.read_text(encoding="utf-8")
    path.write_text(first + '{"key": "cut o', encoding="utf-8")
    judged = []
    results = judge_all(POINTS[:5], path, 1, judge_or_die, lambda found: (judged.append(pair[0]) or pair for pair in found))
    assert judged == [POINTS[4]]
    assert [p for p, _ in results] == POINTS[:5]
    assert path.read_text(encoding="utf-8").startswith(first)
    assert len(read(path)) == 5


@pytest.fixture(scope="module")
def quick_map(tmp_path_factory):
    """A run of the command with --quick that is killed when it has found something, and then run again."""
    for variant in VARIANTS:
        fly(next(p for p in POINTS if p.variant == variant and p.segments < 10))  # compiled once, not in each process
    folder = tmp_path_factory.mktemp("map")
    path = folder / "stability_1.jsonl"
    command = [sys.executable, "-m", "tetherfmu.study.stability", "--quick", "--out", str(folder), "--processes", "2"]
    process = subprocess.Popen(command, start_new_session=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while process.poll() is None and not (path.exists() and path.stat().st_size):
        time.sleep(0.02)
    os.killpg(process.pid, signal.SIGKILL)
    process.wait()
    return folder, path.read_text(encoding="utf-8"), main(command[3:])


def test_the_quick_map_goes_on_after_a_kill(quick_map):
    folder, before, status = quick_map
    after = (folder / "stability_1.jsonl").read_text(encoding="utf-8")
    assert len(before.splitlines()) >= 1
    assert after.startswith(before)
    keys = [json.loads(line)["key"] for line in after.splitlines() if line.endswith("}")]
    assert len(keys) == len(set(keys)) == 60
    assert status == 0  # nothing wrong, crashed or hanging


def test_the_quick_map_holds(quick_map):
    """The page is written, and most points are converged or stable: 60 points tell shares to a few percent only."""
    folder, _, _ = quick_map
    page = (folder / "stability.md").read_text(encoding="utf-8")
    assert page.startswith("# Stability\n")
    verdicts = [v.verdict for _, v in read(folder / "stability_1.jsonl").values()]
    assert sum(v in ("converged", "stable") for v in verdicts) >= 0.8 * len(verdicts)


def test_before_and_now_are_compared_on_the_points_of_both():
    now = [(p, Verdict("converged", 0.0)) for p in POINTS[:40]]
    before = [(p, Verdict("wrong")) for p in POINTS[20:60]] + [(POINTS[0]._replace(length=2.0), Verdict("wrong"))]
    table = compared(now, before)
    wrong, points = table.columns.index("wrong"), table.columns.index("points")
    (_, *earlier), (_, *later) = table.rows[-2:]
    assert (earlier[points - 1], earlier[wrong - 1]) == (20, 20)
    assert (later[points - 1], later[wrong - 1]) == (20, 0)
