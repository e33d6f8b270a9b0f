"""The manual agrees with the sources: generated page, cited sections, named functions, snippets, numbers."""

import csv
import importlib
import re
import shutil
import tomllib
from pathlib import Path

import numpy as np
import pytest
import yaml
from PIL import Image

import make_fmu_table
import manual
import tetherfmu
from manual import ROOT, blocks, shown
from named_functions import MODULES, NAME, PAGES
from real_signatures import parameters_of
from running import EXAMPLES, run_code, run_python
from tetherfmu.runtime.variants import EVERY_VARIANT, VARIANTS, class_name

PACKAGE = ROOT / "fmu_sources" / "tetherfmu"


def page(name):
    """Text of a page of the manual, whatever folder it is in."""
    (path,) = manual.DOCS.glob(f"*/{name}.md")
    return path.read_text(encoding="utf-8")


README = (ROOT / "README.md").read_text(encoding="utf-8")
SECTIONS = {  # of the pages of equations: (page, section) -> text
    (name, head): text
    for name in PAGES
    for head, text in re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", page(name), re.MULTILINE | re.DOTALL)
}


def cited_sections():
    """Triples (file, page, section) of all citations of the pages of equations in the sources."""
    found = []
    for path in sorted(PACKAGE.rglob("*.py")):
        cited = re.findall(r'docs/models/(theory|numerics)\.md,\s+("[^"]+"(?: and "[^"]+")*)', path.read_text("utf-8"))
        found += [(path.name, name, section) for name, text in cited for section in re.findall(r'"([^"]+)"', text)]
    return found


@pytest.mark.parametrize("name", ["commands", "variables", "keys_of_maps", "scene_files"])
def test_pages_are_what_their_scripts_write(name):
    script = importlib.import_module(f"make_{name}")
    assert script.PAGE.read_text(encoding="utf-8") == script.page()


@pytest.mark.parametrize("name", PAGES)
def test_names_in_formulas_are_mathematics(name):
    """In text, as in `\\texttt`, MathJax 3, as on GitHub, shows the backslash of `\\_`; in `\\mathtt` it does not."""
    assert re.findall(r"\\text\w*\{[^}]*\\_[^}]*\}", page(name)) == []


@pytest.mark.parametrize(("file", "name", "section"), cited_sections())  # an empty list fails: see pyproject.toml
def test_cited_sections_exist(file, name, section):
    assert (name, section) in SECTIONS


@pytest.mark.parametrize(("name", "section"), [each for each in SECTIONS if each[1] != "Symbols"])
def test_functions_named_in_the_theory_exist(name, section):
    named = re.findall(f"`{NAME.pattern}`", SECTIONS[name, section])
    assert named
    for module, function in named:
        assert callable(getattr(importlib.import_module(MODULES[module]), function))


def test_all_public_names_are_on_the_page_of_the_python_api():
    listed = set(re.findall(r"auto\w+:: tetherfmu\.(\w+)$", page("api"), re.MULTILINE))
    assert listed == set(tetherfmu.__all__) - {"__version__"}


def test_table_of_the_readme_has_the_measured_numbers():
    assert make_fmu_table.with_table(README) == README


def test_readme_begins_with_an_animation_that_loads_fast():
    first, still = re.findall(r"\]\((docs/figures/[^)]+)\)", README)[:2]
    with Image.open(ROOT / first) as animation, Image.open(ROOT / still) as picture:
        assert animation.n_frames > 100
        assert animation.info["loop"] == 0  # for ever
        assert picture.width > 2 * animation.width  # for print
    assert (ROOT / first).stat().st_size < 1e6


def test_speeds_in_the_readme_were_measured():
    speeds = r"takes (\S+ µs) in FMPy, (\d+ times real time)\. .*? takes (\S+ to \S+ times) .*? error, (\S+ to \S+ times)"
    for fact in re.search(speeds, " ".join(README.split())).groups():
        assert fact in " ".join(page("benchmarks").split())


def test_errors_in_the_readme_were_measured():
    rows = measured_errors()
    figures = [f"{100.0 * float(rows['TetherDynamic'][scene]):.2g} %" for scene in ("figure_of_eight", "circle")]
    assert re.search(r"within (\S+ %) on a figure of eight and (\S+ %) on a slack circle", README).groups() == tuple(figures)


def measured_errors():
    """Rows of the table of errors by FMU, or by what else they are of."""
    with make_fmu_table.MEASURED.open(encoding="utf-8", newline="") as file:
        return {row.pop("fmu"): row for row in csv.DictReader(file)}


@pytest.mark.parametrize("scene", make_fmu_table.SCENES)
def test_references_of_the_readme_are_ten_times_finer_than_its_errors(scene):
    rows = measured_errors()
    own, *errors = (float(rows[name][scene]) for name in (make_fmu_table.REFERENCE, *map(class_name, VARIANTS)))
    assert 10.0 * own <= min(errors)


def test_address_of_the_project_stands_once():
    """A maintainer fills it in at one place."""
    address = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["urls"]["Repository"]
    names = ("*.md", "*.toml", "*.cff", ".zenodo.json", "docs/**/*.md", "docs/**/*.yaml", "examples/**/*.md")
    paths = {path for name in names for path in ROOT.glob(name)}
    assert sum(path.read_text(encoding="utf-8").count(address.removeprefix("https://")) for path in paths) == 1


def test_python_in_the_readme_prints_what_stands_below_it(tmp_path):
    code, printed = shown(README)
    assert ran(code, tmp_path) == printed


def test_readme_has_the_two_commands_of_the_ci():
    assert len(manual.codes(README, "sh")) == 2


def printed_by(done):
    """What a finished process printed; it must have ended cleanly."""
    assert done.returncode == 0, done.stderr
    return done.stdout


def ran(code, folder):
    """What Python code prints, in a folder where the package can be imported, and no example."""
    return printed_by(run_code(f"import sys\nsys.path.remove({str(EXAMPLES)!r})\n{code}", cwd=folder))


def ran_here(command, folder):
    """What a line of a page for a shell prints, with this Python, in a folder."""
    program, *arguments = command.split()
    is_script = arguments[0].endswith(".py")
    line = [ROOT / arguments[0], *arguments[1:]] if is_script else ["-m", Path(program).name, *arguments]
    return printed_by(run_python(*line, cwd=folder))


@pytest.mark.parametrize(("text", "prints"), [(README, 1), (page("start"), 4)], ids=["README", "start"])
def test_blocks_run_one_after_the_other(fmu_folder, tmp_path, text, prints):
    """As a reader does it in an empty folder with the FMUs; the first page after the README flies a CSV file."""
    shutil.copytree(fmu_folder, tmp_path / "dist")
    log = next(code for language, code in blocks(page("start")) if "savetxt" in code)
    ran(log, tmp_path)
    printed = []
    for language, code in blocks(text):
        if language == "toml":
            (tmp_path / "own.toml").write_text(code, encoding="utf-8")
        elif language == "csv":
            (tmp_path / "winch.csv").write_text(code, encoding="utf-8")
        elif language == "bash":
            printed += [ran_here(line, tmp_path) for line in code.splitlines()]
        elif language == "python":
            printed.append(ran(code, tmp_path))
    assert len([each for each in printed if each.strip()]) >= prints
    assert (tmp_path / "result.csv").exists() is ("write_csv" in text)


def test_the_tether_on_the_page_of_the_ground_breaks(fmu_folder, tmp_path):
    """When the catenary, which cannot break, has the tension of the `breaking_force` at its kite end."""
    code, printed = shown(page("ground"))
    shutil.copytree(fmu_folder, tmp_path / "dist")
    assert ran(code, tmp_path).splitlines()[-1] == printed.strip()
    catenary = tetherfmu.TetherCatenary()
    catenary.initialize(reel_out_speed=-0.5)
    flown = catenary.fly(tetherfmu.inputs_along(750, 0.02, kite=(300.0, 0.0, 400.0), reel_out_speed=-0.5), 0.02)
    reached = np.interp(1000.0, flown.of("kite_tension"), flown.time)
    assert float(re.search(r"([\d.]+) s", printed)[1]) == pytest.approx(reached, abs=0.05)  # s: 25 mm, 31 N of waves


def test_size_of_a_saved_state(fmu_folder, tmp_path):
    """Of 20 segments, in the FMU as on the page."""
    code = f"""
from fmpy import extract, instantiate_fmu, read_model_description
path = {str(fmu_folder / "TetherDynamic.fmu")!r}
fmu = instantiate_fmu(extract(path), read_model_description(path), "CoSimulation")
fmu.setupExperiment()
fmu.enterInitializationMode()
fmu.exitInitializationMode()
print(len(fmu.serializeFMUstate(fmu.getFMUstate())))
"""
    size = int(ran(code, tmp_path).splitlines()[-1])
    assert float(re.search(r"([\d.]+) kB for 20 segments", page("fmi"))[1]) == pytest.approx(size / 1e3, abs=0.05)


def test_blocks_of_the_python_api(tmp_path):
    """A force, a system, a time and a tension from a log, a tension in turbulence."""
    _, system, log, turbulence = (ran(code, tmp_path) for code in manual.codes(page("api"), "python"))
    hoisted, passed, let_go = map(float, system.splitlines()[0].split())
    assert (hoisted, let_go) == pytest.approx((-0.4, 1.0))  # 2 s at 0.2 m/s; the beginning of step 50
    assert 0.0 < passed < 1.0  # the load swings away from the sheave on one line, 200 kg against 100
    assert float(log.split()[0]) == 20.0
    assert all(float(number) > 0.0 for text in (log, turbulence) for number in text.split())


def test_blocks_for_users_of_tethers_jl(tmp_path):
    """Settings become a scene, a line file a system, and both are used."""
    (tmp_path / "examples").symlink_to(ROOT / "examples", target_is_directory=True)
    (commands,) = manual.codes(page("from_tethers_jl"), "bash")
    for line in commands.splitlines():
        ran_here(line, tmp_path)
    assert all((tmp_path / name).exists() for name in ("settings.toml", "moored.toml"))


def test_blocks_of_cranes_and_drones(tmp_path):
    """At rest the tip carries load and wire; both versions of FMI give the same pull."""
    printed = []
    for language, code in blocks(page("cranes_and_drones")):
        if language == "bash":
            printed += [ran_here(line, tmp_path) for line in code.splitlines()]
        elif language == "python":
            printed.append(ran(code, tmp_path))
    wire, text = tetherfmu.tether_of("steel", 0.012), "".join(printed)
    hanging = (500.0 + wire.mass_per_length * 80.0) * 9.81
    found = re.search(r"tension at rest: (\d+) N, largest tension: (\d+) N", text).groups()
    assert float(found[0]) == pytest.approx(hanging, abs=1.0)  # N, no digits printed
    assert re.search(r"(\d+) N at rest, .*, and at most (\d+) N", page("cranes_and_drones")).groups() == found
    swing = re.search(r"largest swing, from below the tip: ([\d.]+) m", text)[1]
    assert f"up to {swing} m away from below the tip" in page("cranes_and_drones").replace("\n", " ")
    circling = 0.1**2 * (30.0 + 2.7) / 9.81 * 80.0  # offset [m] of a load that follows its circle: tan = w^2 r/g
    assert float(swing) > 2.5 * circling
    hoisting = float(re.search(r"hoisted by 64\.\d m, tension while hoisting: at most (\d+) N", text)[1])
    assert hanging * (1.0 + 0.25 / 9.81) < hoisting < hanging * (1.0 + 0.5 / 9.81)  # at most twice a: mass on a spring
    assert f"It prints at most {hoisting:.0f} N" in page("cranes_and_drones")
    pulls = re.search(r"largest pull on the drone: ([\d.]+) N, by FMI 3 ([\d.]+) N", text)
    assert pulls[1] == pulls[2]
    assert all((tmp_path / name).exists() for name in ("crane.png", "drone.png"))


@pytest.mark.parametrize("name", ["diameter", "density", "axial_stiffness", "axial_damping"])
def test_parameters_of_the_crane_are_those_of_its_wire(name):
    """Three digits stand in the table."""
    wire = tetherfmu.tether_of("steel", 0.012)
    damping = 2.0 * 0.01 * np.sqrt(500.0 * 80.0 * wire.axial_stiffness)  # 1 % of critical: c = 2 zeta sqrt(k m), D = c L
    number = float(re.search(rf"^\| `{name}` \| (\S+) \|$", page("cranes_and_drones"), re.MULTILINE)[1])
    assert number == pytest.approx(damping if name == "axial_damping" else getattr(wire, name), rel=1e-3)


def test_each_picture_of_the_gallery_has_the_command_that_draws_it():
    drawn = re.findall(r"^!\[[^\]]+\]\(\.\./figures/(\w+)\.svg\)\n\n```text\n(.*)\n```$", page("gallery"), re.MULTILINE)
    assert len(drawn) == 13
    for name, command in drawn:
        script = ROOT / command.split()[1]
        assert command.startswith("tetherfmu fly") or f"{name}" in script.read_text(encoding="utf-8"), command


def test_each_map_of_stability_has_its_command():
    """With as many points as its row has."""
    with open(ROOT / "docs" / "data" / "stability_by_map.csv", encoding="utf-8", newline="") as file:
        rows = {(row["winch control"], row["ground"], row["points"]) for row in csv.DictReader(file)}
    found = re.findall(r"make_stability\.py( --control \w+)?( --ground)? --points (\d+)", page("developing"))
    commands = {(control.split()[-1] if control else "speed", "flat" if on else "none", n) for control, on, n in found}
    assert commands == rows


def test_pages_have_the_same_command():
    """The home page includes that of the README."""
    first, start = (manual.codes(text, "sh")[0] for text in (README, page("start")))
    assert first == start
    assert max(map(len, first.splitlines())) <= 70  # as wide as a page of code
    assert "first flight" in (ROOT / "docs" / "index.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("text", [README, *map(page, ("start", "importing", "faq"))])
def test_pages_recommend_the_same_build(text):
    said = "In a Python host such as FMPy use `tetherfmu build`. For every other host use `tetherfmu build --native`"
    assert said in " ".join(text.split())


def test_first_flight_prints_what_the_readme_shows(fmu_folder, tmp_path):
    """All but its speed; the circle is the flight that pulls with some 50 N."""
    shutil.copytree(fmu_folder, tmp_path / "dist")
    eight, circle = re.findall(r"^\.venv/bin/(tetherfmu fly .*)$", README, re.MULTILINE)
    printed = re.search(r"```text\n(TetherDynamic: .*; )\d+ times real time\n```", README)[1]
    assert ran_here(eight, tmp_path).startswith(printed)
    assert (tmp_path / "plots" / "eight" / "forces.png").exists()
    pulls = re.findall(r"(\d+\.\d) N, \|kite\| (\d+\.\d) N", ran_here(circle.replace("all", "dynamic"), tmp_path))
    assert [40.0 < float(each) < 60.0 for each in pulls[0]] == [True, True]
    assert "{} N at the ground, {} N at the kite".format(*(f"{float(each):.0f}" for each in pulls[0])) in page("start")


def test_citations_are_those_of_the_file():
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    (readme,), (start,) = (manual.codes(text, "bibtex") for text in (README, page("start")))
    assert readme == start
    fields = {name: re.sub(r"[{}]", "", value) for name, value in re.findall(r"(\w+) += \{(.*)\},", readme)}
    assert fields["author"] == cited["authors"][0]["name"]
    assert fields["year"] == str(cited["date-released"].year)
    assert {name: fields[name] for name in ("title", "version", "license")} == {
        name: cited[name] for name in ("title", "version", "license")
    }


def test_pages_on_the_example_fmus_are_what_the_script_writes(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "docs" / "make")
    for file, text in importlib.import_module("make_example_fmus").pages():
        assert file.read_text(encoding="utf-8") == text


@pytest.mark.parametrize("name", [*map(class_name, EVERY_VARIANT), "TetherSystem"])
def test_signatures_on_the_page_of_the_python_api_are_real(name):
    """All arguments by name, with types; what `step` takes is what the classes take."""
    found = getattr(tetherfmu, name)
    for called in (found, found.initialize, found.step):
        parameters = [each for each in parameters_of(called) if each.name != "quantities"]
        assert not any(each.kind in (each.VAR_POSITIONAL, each.VAR_KEYWORD) for each in parameters)
        assert all(each.annotation is not each.empty for each in parameters)
    assert {"wind_velocity", "wind_at"} <= {each.name for each in parameters_of(found.step)}
