"""The manual agrees with the sources: generated page, cited sections, named functions, snippets, numbers."""

import importlib
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from scenes import fly_circle
from tetherfmu.models import TetherCatenary, TetherDynamic, TetherQuasiSteady
from tetherfmu.runtime.parameters import Environment, Solver, Tether

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "fmu_sources" / "tetherfmu"
THEORY = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
README = (ROOT / "README.md").read_text(encoding="utf-8")
SECTIONS = dict(re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", THEORY, re.MULTILINE | re.DOTALL))
MODULES = {  # by the name that the theory page calls them: modules that compute
    path.stem: ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts)
    for path in [*PACKAGE.glob("[a-z]*.py"), *PACKAGE.glob("runtime/[a-z]*.py"), *PACKAGE.glob("kernels/**/[a-z]*.py")]
}
FUNCTIONS = r"`(" + "|".join(MODULES) + r")\.(\w+)`"


def cited_sections():
    """Pairs (file, section) of all citations of the theory page in the sources."""
    found = []
    for path in sorted(PACKAGE.rglob("*.py")):
        for line in re.findall(r"docs/theory\.md, (.+)", path.read_text(encoding="utf-8")):
            found += [(path.name, section) for section in re.findall(r'"([^"]+)"', line)]
    return found


def test_interface_page_is_what_the_script_writes(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs")
    script = importlib.import_module("make_interface")
    assert script.PAGE.read_text(encoding="utf-8") == script.page()


@pytest.mark.parametrize(("file", "section"), cited_sections())
def test_cited_sections_exist(file, section):
    assert section in SECTIONS


@pytest.mark.parametrize("section", [name for name in SECTIONS if name != "Symbols"])
def test_functions_named_in_the_theory_exist(section):
    named = re.findall(FUNCTIONS, SECTIONS[section])
    assert named
    for module, function in named:
        assert callable(getattr(importlib.import_module(MODULES[module]), function))


def test_readme_has_the_two_commands_of_the_ci():
    assert len(re.findall(r"^```sh$", README, re.MULTILINE)) == 2


@pytest.mark.parametrize(
    "snippet", re.findall(r"^```python\n(.*?)^```$", README, re.MULTILINE | re.DOTALL), ids=["fmpy", "python"]
)
def test_python_snippets_of_the_readme_run(fmu_folder, tmp_path, snippet):
    shutil.copytree(fmu_folder, tmp_path / "dist")
    done = subprocess.run(
        [sys.executable, "-c", snippet],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout


NUMBER = r"\| ([\d.]+) "
VALIDITY = re.findall(f"^{4 * NUMBER}{2 * (NUMBER + '% ')}\\|$", THEORY, re.MULTILINE)


@pytest.mark.parametrize("row", VALIDITY)
def test_validity_table(row):
    """Root mean square difference of kite_force from the dynamic tether; solver tolerance 1e-4 moves the last digit."""
    length, rate, wave_time, product, quasi_steady, catenary = map(float, row)
    force = {}
    for model in (TetherDynamic, TetherQuasiSteady, TetherCatenary):
        tether = model(Tether(initial_length=length), solver=Solver(initial_shape=2))
        _, outputs = fly_circle(tether, 0.02, 12.0, rate=rate)
        force[model] = np.array([each.kite_force for each in outputs])
        if model is TetherQuasiSteady:
            crossing = np.mean([each.wave_time for each in outputs])
    assert crossing == pytest.approx(wave_time, abs=0.06)
    assert rate * crossing == pytest.approx(product, abs=0.006)
    size = np.sqrt(np.mean(force[TetherDynamic] ** 2))
    for model, percent in ((TetherQuasiSteady, quasi_steady), (TetherCatenary, catenary)):
        difference = 100.0 * np.sqrt(np.mean((force[model] - force[TetherDynamic]) ** 2)) / size
        assert difference == pytest.approx(percent, abs=0.2)


def test_validity_table_is_there():
    assert len(VALIDITY) == 6


FOLDS = re.findall(rf"^{3 * NUMBER}\|$", SECTIONS["Struts"], re.MULTILINE)


@pytest.mark.parametrize("row", FOLDS)
def test_fold_table(row):
    """Largest error of the ground force and largest push, both over the weight of a segment, of 25 slack tethers."""
    ratio, error, push = map(float, row)
    errors, pushes = [], [0.0]
    for n in (5, 10, 20, 50, 100):
        for slack in (0.05, 0.1, 0.3, 0.5, 0.9):
            tether = Tether(segments=n, initial_length=500.0 / (1.0 - slack), slack_stiffness_ratio=ratio)
            model = TetherQuasiSteady(tether)
            force = model.initialize((0.0, 0.0, 500.0)).ground_force
            load = tether.mass_per_meter * 9.81
            segment = load * tether.initial_length / n
            hanging = (0.0, 0.0, -0.5 * load * (tether.initial_length - 500.0))
            errors.append(np.linalg.norm(force - hanging) / segment)
            pushes.append(-model.segment_tensions.min() / segment)
    assert max(errors) == pytest.approx(error, abs=0.006)
    assert max(pushes) == pytest.approx(push, abs=0.006)


def test_fold_table_is_there():
    assert len(FOLDS) == 5


@pytest.mark.parametrize(("part", "grows"), [(0.9, False), (1.3, True)])
def test_largest_step_of_a_coupling_by_force(part, grows):
    """A kite of 10 kg on a taut tether, moved by the force of the step before: limit h = 2 kite_damping/kite_stiffness."""
    lift, mass, length = 500.0, 10.0, 500.0
    tether = TetherDynamic(Tether(segments=1, initial_length=length, drag_coefficient=0.0), Environment(gravity=0.0))
    rest = length * (1.0 + lift / 614600.0)
    position, velocity = rest + 0.01, 0.0
    outputs = tether.initialize((0.0, 0.0, position))
    h = part * 2.0 * outputs.kite_damping / outputs.kite_stiffness
    swing = []
    for _ in range(int(5.0 / h)):
        force = outputs.kite_force[2]
        outputs = tether.step(h, (0.0, 0.0, position), (0.0, 0.0, velocity))
        acceleration = (lift + force) / mass
        position += velocity * h + 0.5 * acceleration * h * h
        velocity += acceleration * h
        swing.append(abs(position - rest))
    tenth = len(swing) // 10
    assert bool(max(swing[-tenth:]) > max(swing[:tenth])) is grows


def test_page_on_the_example_fmus_is_what_the_script_writes(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs")
    script = importlib.import_module("make_example_fmus")
    assert script.PAGE.read_text(encoding="utf-8") == script.page()
