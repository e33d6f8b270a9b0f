"""The benchmark runs, and the work it counts is bounded. Seconds are not tested."""

import csv
from itertools import pairwise

import pytest

from benchmark.hosted import hosted
from make_benchmarks import main
from study.scenes_of_tests import written
from tetherfmu.files.scene_files import load
from tetherfmu.study.measuring.runs import Config, fmu_of, run
from tetherfmu.study.measuring.scene_fmus import fmus_in


@pytest.fixture(scope="module")
def tables(fmu_folder, tmp_path_factory):
    """Rows of each table of a quick run without peers, as dicts, by the title of the table."""
    folder = tmp_path_factory.mktemp("benchmark")
    assert main(["--quick", "--no-peers", "--fmus", str(fmu_folder), "--out", str(folder)]) == 0
    assert (folder / "measurements" / "benchmarks.md").read_text(encoding="utf-8").startswith("# Accuracy and speed\n")
    found, columns = {}, ()
    with open(folder / "data" / "benchmarks.csv", newline="", encoding="utf-8") as file:
        for title, *cells in list(csv.reader(file))[1:]:
            if title == "table":
                columns = cells
            else:
                found.setdefault(title, []).append(dict(zip(columns, cells, strict=True)))
    return found


def work_of_kernel(tables, what):
    """Internal steps or Newton iterations per communication step, largest of all numbers of segments."""
    return max(float(row["work"]) for row in tables["Kernels"] if row["what"] == what)


def test_one_internal_step_per_communication_step(tables):
    assert work_of_kernel(tables, "dynamic step") == pytest.approx(1.0, abs=0.05)


def test_quasi_steady_follows_in_few_iterations(tables):
    warm, cold = (work_of_kernel(tables, f"quasi_steady {way}") for way in ("step (warm)", "start (cold)"))
    assert 1.0 <= warm <= 3.0
    assert warm < cold <= 12.0


def test_all_fmus_are_measured(tables):
    names = {f"Tether{kind}" for kind in ("Straight", "Catenary", "QuasiSteady", "Dynamic")}
    assert {row["FMU"] for row in tables["FMUs in FMPy"]} == names


def test_tighter_tolerance_is_closer_to_the_exact_release(tables):
    rows = [row for row in tables["Work and precision"] if row["scene"] == "release"]
    rows.sort(key=lambda row: float(row["tolerance"]), reverse=True)
    errors, steps = zip(*((float(row["error m"]), int(row["internal steps"])) for row in rows), strict=True)
    assert len(rows) > 1
    assert all(b < 0.3 * a for a, b in pairwise(errors))
    assert all(a < b < 1000 for a, b in pairwise(steps))


@pytest.mark.parametrize("config", [Config("catenary", 0, 0.0, 0.02), Config("dynamic", 6, 1e-3, 0.02)])
def test_fmu_flies_the_scene_as_the_python_api_does(fmu_folder, tmp_path, config):
    """Through FMPy, bit for bit; and its cost is measured."""
    scene = load(written(tmp_path))
    ((_, costs, force),) = hosted(fmus_in(fmu_folder)[fmu_of(scene, config)], scene, config)
    assert force == run(scene, config).flown.kite_force[-1].tolist()
    assert 0.0 < costs.sum() < scene.duration
