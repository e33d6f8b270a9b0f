"""Wrong use of a command or an example: one line on stderr that names what is wrong and what is allowed, and its status."""

import importlib
import zipfile
from pathlib import Path

import numpy as np
import pytest

from foreign import foreign
from running import run_python, run_without, status_of
from tetherfmu import __version__
from tetherfmu.__main__ import main as tetherfmu
from tetherfmu.console.ending import DISTRIBUTIONS, remedy
from tetherfmu.console.subcommands import SUBCOMMANDS
from tetherfmu.files.toml_files import WrongUse
from tetherfmu.study.measuring.scene_fmus import fmus_in
from tetherfmu.study.measuring.store import KEPT, keeping

SCENES = {  # name of the file: (part of a sound scene, what stands there instead)
    "elevation.toml": ('"circle"', '"parked"\nelevation = 20'),
    "wrong.toml": ("initial_length", "length"),
    "name.toml": ("duration =", f"name = '{'a' * 300}'\nduration ="),
    "path.toml": ("duration =", "name = '../x'\nduration ="),
    "key.toml": ("525.0", "525.0\ndiametre = 0.01"),
    "unit.toml": ("525.0", '"5 kg"'),
    "kind.toml": ('"circle"', '"spiral"'),
    "syntax.toml": ("duration =", "duration"),
}
SOUND = """duration = 20.0
[flight]
kind = "circle"
[tether]
initial_length = 525.0
[wanted]
allowed_error = 0.02
"""
OF_SWEEPS = {
    "--outputs kite_tensio": "there is no output 'kite_tensio'; did you mean kite_tension?",
    "--from 30": "start is 30 s; it must be at least 0 s and less than the duration, 20 s",
    "--percentiles 101": "--percentiles: '101' is not possible",
    "--tether strait": "--tether: 'strait' is not possible; did you mean straight?",
    "--vary gravity=1,2 --vary gravity=3": "gravity is given twice",
    "--vary tether.diameter=1,2 --vary diameter=3": "tether.diameter and diameter are the same value, given twice",
    "--set gravity=9 --vary environment.gravity=8": "gravity and environment.gravity are the same value, given twice",
    "--set wind.velocity[1]=4": "wind.velocity[1] and wind.speed are the same value, given twice",
    "--set gravity=9 --set gravity=8": "gravity is given twice; give one of them",
    "--set gravity=9 --set environment.gravity=8": "gravity and environment.gravity are the same value, given twice",
    "--set tether.diametre=3": "unknown key tether.diametre; did you mean diameter?",
}
WRONG = {  # what is typed, what must be said
    "nonsense": ("'nonsense'", "build, fly, check"),
    "buidl": "there is no command 'buidl'; did you mean build?",
    "build dynamc": "no tether is called dynamc; did you mean dynamic?",
    "build --platforms linux,windows": "'linux'; did you mean x86_64-linux or aarch64-linux?",
    "build --platforms win64": "'win64'; did you mean x86_64-windows?",
    "build --segmets 3": "there is no option --segmets; did you mean --segments?",
    "build --material steele": "'steele' is not possible; did you mean steel?",
    "build --scene elevation.toml": ("flight.elevation is 20; it must be", 'did you mean "20 deg"?'),
    "build --scene wrong.toml": "unknown key tether.length; did you mean initial_length?",
    "build --scene name.toml": ("name is 'aaaaaaaaaaaaaaaaaaaa'... (300 characters)", "1 to 100 characters"),
    "build --scene path.toml": ("name is '../x'", "none of them one of"),
    "fly --wind 9": "--wind: expected 3 arguments, --wind WX WY WZ",
    "fly none.csv --set diametr=0.004": "'diametr=0.004' is not possible; did you mean diameter?",
    "fly --start quasi": "'quasi' is not possible; did you mean quasi_steady?",
    "replay text.txt --lead tenson": "'tenson' is not possible; did you mean tension?",
    "import text.txt": ("text.txt: is neither", "KiteUtils.jl", "MoorDyn v2"),
    "import none.txt": ("FILE", "no file none.txt"),
    "build elastic": ("tetherfmu build", "elastic", "straight (TetherStraight)"),
    "build ''": ("NAME", "straight (TetherStraight)"),
    "build --platforms nonsense": ("--platforms", "'nonsense'", "x86_64-linux", "all"),
    "build --platforms x86_64-linux,": ("--platforms", "''", "x86_64-linux"),
    "build --platforms ''": ("--platforms", "''", "x86_64-linux"),
    "build --segments 1e3": ("--segments", "'1e3'", "whole number, at least 1 and at most 300"),
    "build --segments 0": ("--segments", "'0'", "at least 1"),
    "build --segments 301": ("--segments", "'301'", "at most 300"),
    "build --segments ''": ("--segments", "''", "whole number"),
    "build --segments": ("--segments", "expected one argument"),
    "build --shape-points 1": ("--shape-points", "'1'", "0, or from 2 to 1001"),
    "build --shape-points -5": ("--shape-points", "'-5'", "0, or from 2 to 1001"),
    "build --diameter 0": ("--diameter", "'0'", "at least 0.0001 m and at most 5 m"),
    "build --diameter 4mm": ("--diameter", "'4mm'", "a number", "at most 5 m"),
    "build --diameter inf": ("--diameter", "'inf'", "at most 5 m"),
    "build --diameter nan": ("--diameter", "'nan'", "at most 5 m"),
    "build --material rope": ("--material", "'rope'", "steel", "dyneema_sk75"),
    "build --diameter 0.01 --material ''": ("--material", "''", "steel"),
    "build --material steel --diameter 5mm": ("--diameter", "'5mm'", "a number"),
    "build --out text.txt": ("--out", "'text.txt'", "is a file"),
    "build --out text.txt/deeper/out": ("--out", "'text.txt/deeper/out'", "text.txt is a file"),
    "build --out ''": ("--out", "''", "is not a folder"),
    "build --fmi 3": "--fmi 3 requires --native",
    "build --fmi 2.0": ("--fmi", "'2.0' is not possible"),
    "build --set density=970 --set density=724": "density is given twice; give one of them",
    "build --set kite_position=1,2,3 --set kite_position[1]=4": ("kite_position and kite_position[1]", "given twice"),
    "fly --set density=970 --set density=724": "density is given twice; give one of them",
    "fly circle --set density=970 --set tether.density=724": ("density and tether.density", "given twice"),
    "advise circle --set density=970 --set tether.density=724": ("density and tether.density", "given twice"),
    "replay text.txt --set kite.area=1 --set kite.area=2": "kite.area is given twice",
    "build --diameter 0.01 --set diameter=0.008": "--diameter and --set diameter are both given",
    "build --header": ("--header", "requires --native"),
    "build --sources": "--sources requires --native",
    "build --sources --system none.toml": "--sources requires --native",
    "build --native --fmi 1": ("--fmi", "2, 3"),
    "build --colour": ("tetherfmu build", "there is no option --colour"),
    "build --scene none.toml": ("none.toml", "cannot be read"),
    "build --scene key.toml": ("key.toml", "tether.diametre", "did you mean diameter?"),
    "build --scene ''": "cannot be read",
    "build straight --scene key.toml": ("--scene", "NAME"),
    "build --diameter 0.01 --scene key.toml": ("--scene", "--diameter"),
    "build --material steel --scene key.toml": ("--scene", "--material"),
    "fly --fmu text.txt": ("text.txt", "not a readable FMU"),
    "fly --fmu empty.fmu": ("empty.fmu", "not a readable FMU"),
    "fly --fmu folder": ("--fmu", "'folder'", "is a folder"),
    "fly --fmu none.fmu": ("--fmu", "none.fmu", "no file"),
    "fly --fmu ''": ("--fmu", "''"),
    "fly --fmu no_shape.fmu --fmus folder": ("--fmu is the one FMU that is flown", "excludes --tether and --fmus"),
    "fly --fmus text.txt": ("--fmus", "'text.txt'", "is a file"),
    "fly --html --duration 0.1 --fmu no_shape.fmu": ("no_shape.fmu", "output shape", "--shape-points 21"),
    "fly --fmu other.fmu": ("other.fmu", "no variable kite_position", "tetherfmu build"),
    "fly --fmu fmi3.fmu": ("fmi3.fmu", "not a readable FMU"),
    "fly --fmu exchange.fmu": ("exchange.fmu", "co-simulation by FMI 2.0"),
    "fly --fmu no_library.fmu": ("no_library.fmu cannot be loaded", "tetherfmu check no_library.fmu"),
    "fly --rate 1000 --fmu no_shape.fmu": ("0.00628319 s", "communication step of 0.02 s"),
    "fly --tether elastic": ("--tether", "elastic", "straight", "all"),
    "fly --wind a b c": ("--wind", "'a'", "finite number"),
    "fly --wind 1 2": ("--wind", "expected 3 arguments"),
    "fly --wind nan 0 0": ("--wind", "'nan'", "finite number"),
    "fly --step nan": ("--step", "'nan'", "at most 1000 s"),
    "fly --step 0": ("--step", "'0'", "at least 1e-06 s"),
    "fly --step ''": ("--step", "''", "a number"),
    "fly --length -5": ("--length", "'-5'", "at least 0.001 m"),
    "fly --rate fast": ("--rate", "'fast'", "rad/s"),
    "fly --duration inf": ("--duration", "'inf'", "at most 1e+06 s"),
    "fly --duration 0.001 --fmu no_shape.fmu": ("0.001 s", "communication step of 0.02 s"),
    "fly --start upside_down": ("--start", "'upside_down'", "quasi_steady"),
    "fly --out text.txt": ("--out", "'text.txt'", "is a file"),
    "web --out text.txt": ("tetherfmu web", "--out", "'text.txt'", "is a file"),
    "web --port 8000": "--port requires --serve",
    "web --serve --port 0": ("--port", "'0'", "whole number, at least 1 and at most 65535"),
    "web --out ''": ("--out", "''", "is not a folder"),
    "tutorial 99": ("tetherfmu tutorial", "'99'", "01, 02, 03, 03b"),
    "tutorial ''": ("LESSON", "''", "quasi_steady_scaling, all"),
    "tutorial 01 --out text.txt": ("--out", "'text.txt'", "is a file"),
    "tutorial --out new": ("which LESSON", "01, 02"),
    "tutorial --show": "which LESSON",
    "tutorial --copy text.txt": ("--copy", "'text.txt'", "is a file"),
    "tutorial --copy mine": ("mine/README.md", "--overwrite"),
    "tutorial 01 --copy new": ("--copy", "LESSON"),
    "tutorial 01 --overwrite": ("--overwrite", "--copy DIR"),
    "check": ("tetherfmu check", "FILE.fmu"),
    "check none.fmu": ("FILE.fmu", "no file none.fmu"),
    "check folder": ("FILE.fmu", "'folder'", "is a folder"),
    "check ''": ("FILE.fmu", "''"),
    "make_release --out folder": ("--out", "folder", "not empty", "new folder"),
    "make_release --out text.txt": ("--out", "'text.txt'", "is a file"),
    "advise": ("tetherfmu advise", "SCENE"),
    "advise none.toml": ("none.toml", "cannot be read"),
    "advise folder": ("folder", "cannot be read"),
    "advise ''": "cannot be read",
    "advise --fast text.txt": ("text.txt", "not a TOML file"),
    "advise --fast key.toml": ("key.toml", "tether.diametre", "did you mean diameter?"),
    "advise --fast unit.toml": ("unit.toml", "tether.initial_length", "'5 kg'"),
    "advise --fast kind.toml": ("kind.toml", "flight.kind", "'spiral'", "circle"),
    "advise --fast syntax.toml": ("syntax.toml", "not a TOML file"),
    "tradeoff key.toml --processes 0": ("--processes", "'0'", "whole number, at least 1"),
    "tradeoff key.toml --dask nonsense": ("--dask", "'nonsense'", "tcp://127.0.0.1:8786"),
    "tradeoff key.toml --dask ''": ("--dask", "''", "tcp://127.0.0.1:8786"),
    "tradeoff key.toml --out text.txt": ("--out", "'text.txt'", "is a file"),
    "tradeoff key.toml": ("key.toml", "tether.diametre"),
    "make_stability --dask nonsense": ("--dask", "'nonsense'", "tcp://127.0.0.1:8786"),
    "make_stability --points many": ("make_stability.py", "--points", "'many'", "whole number"),
    "make_stability --seed -1": ("--seed", "'-1'", "at least 0"),
    "make_stability --slack-ratio 2": ("--slack-ratio", "'2'", "at most 1"),
    "make_stability --before none.jsonl": ("--before", "none.jsonl"),
    "make_stability --point 1.5": ("--point", "'1.5'", "whole number"),
    "make_stability --results folder": ("--results", "'folder'", "is a folder"),
    "make_benchmarks --fmus text.txt": ("make_benchmarks.py", "--fmus", "'text.txt'"),
    "make_benchmarks --figure folder": ("--figure", "'folder'", "is a folder"),
    "make_benchmarks --figure diagram.docx": ("--figure", "'diagram.docx'", ".svg"),
    "at_rest.catenary --out text.txt": ("--out", "'text.txt'", "is a file"),
    "at_rest.catenary 7": "unrecognized arguments: 7",
    "at_rest.forces_over_wind_and_slack --out ''": ("--out", "''", "is not a folder"),
    "at_rest.catenary --fmu text.txt": ("text.txt", "not a readable FMU"),
    "at_rest.catenary --fmu none.fmu": ("--fmu", "none.fmu", "no file"),
    "at_rest.forces_over_wind_and_slack --wind 3": "there is no option --wind; there are --out, --fmu, --help",
    "at_rest.forces_over_wind_and_slack --fmu text.txt": ("text.txt", "not a readable FMU"),
    "build --examples --scene key.toml": ("--scene", "--examples"),
    "power_system.pumping_cycle --cycles 0": ("--cycles", "'0'", "whole number, at least 1"),
    "power_system.pumping_cycle --step 1": ("--step", "'1'", "at most 0.1 s"),
    "power_system.pumping_cycle --wind nan": ("--wind", "'nan'", "m/s"),
    "power_system.pumping_cycle --master newton": ("--master", "'newton'", "gauss_seidel"),
    "power_system.winch_inside --out text.txt": ("--out", "'text.txt'", "is a file"),
    "cranes.hoisting 7": "unrecognized arguments: 7",
    "cranes.set_down --out text.txt": ("--out", "'text.txt'", "is a file"),
    "ground.landing 7": "unrecognized arguments: 7",
    "cranes.constant_tension --out ''": ("--out", "''", "is not a folder"),
    "fly landing_hook --set series.tipp.velocity=[0,0,1]": "unknown key series.tipp; did you mean tip?",
    "fly landing_hook --set series.tip.velocity=[0,0,1]": "series.tip has velocity and elevation; it must have one of",
    "fly landing_hook --set series.hoist.winch_force=3": "key series.hoist.winch_force; known are release, reel_out_speed",
    "fly landing_hook --set series.load.load=[[0,1]]": "series.load.load: row 1 has 1; it must be three numbers, rows",
    "fly landing_hook --set series.hook.position=[0,0,1]": "unknown key series.hook.position; known are load",
    "fly landing_hook --set lines.hoist.winch_control=force": "series.hoist.reel_out_speed; known are release, winch_force",
    "fly landing_crane --set series.kite_velocity=[0,0,1]": "series.kite_velocity moves the kite, which is a free end",
    "fly landing_crane --set series.reel_out_sped=1": "unknown key series.reel_out_sped; did you mean reel_out_speed?",
    "fly parked --set series.kite_load=[0,0,1]": "series.kite_load is a force on a free end; flight.kind must be 'free_end'",
    "fly parked --set series.winch_length=3 --set series.winch_force=3": "series has winch_force and winch_length; only one",
    "fly parked --set series.release=[[1,true]] --tether straight": "--tether is straight; parked lets its tether go",
    "fly eight_on_a_wimch": "did you mean eight_on_a_winch?",
    "fly none.toml": "none.toml: cannot be read (No such file or directory)",
    "fly parked --wind 8 0 0": "--wind is not for a scene: --set 'wind.velocity=[WX, WY, WZ]'",
    "fly parked --start straight": "--start is not for a scene",
    "fly parked --set wind.sped=3": "a scene has no wind.sped; did you mean wind.speed?",
    "fly parked --set segments=0": "--set: segments is 0.0; it must be at least 1",
    "fly parked --set end_velocities=1": "--set: end_velocities follows from the scene",
    "fly parked --step 30": "the flight of 24 s is shorter than a communication step of 30 s",
    "fly slewing_crane --tether straight": "the free end of slewing_crane is moved by TetherDynamicFree only",
    "fly hoist --tether straight": "--tether is straight; the lines of a system are dynamic",
    "fly hoist --wind 8 0 0 --set wind.speed=3": "--wind and --set wind are both given; give one of them",
    "fly hoist --duration 1e6": "the flight of 1e+06 s has 50000000 communication steps; it may have 1000000 at most",
    "fly hoist --length 3": "--length is not for a system: --set lines.NAME.initial_length=L",
    "fly hoist --set lines.beam.diametre=3": "unknown key lines.beam.diametre; did you mean diameter?",
    "fly hoist --set lines.rope_left.winch_control=force": "lines.rope_left.winch_control is force, and nothing gives that",
    "fly logged --duration 30": "duration is 30.0; it must be at most 20 s",
    "fly hoist --duration 0.6 --csv none/table.csv": "there is no folder none",
    "fly hoist --duration 0.6 --outputs power": "--outputs chooses columns of --csv; it requires --csv",
    "fly hoist --duration 0.6 --csv t.csv --outputs tension_form": "has no tension_form; did you mean tension_from?",
    "fly hoist --duration 0.6 --from 3": "--from is 3 s; it must be at most the end of the flight, 0.6 s",
    "fly hoist --from -1": "'-1' is not possible; it must be a number, at least 0 s",
    "build straight --outputs kite_fors": "outputs: this FMU has no 'kite_fors' among its outputs; did you mean kite_force?",
    "build straight --outputs kite_force[1]": "kite_force[1] is an element of kite_force; name the whole vector",
    "build straight --inputs none --outputs none --parameters none": "an FMU needs inputs, outputs or parameters",
    "build straight --inputs diameter": "inputs: this FMU has no 'diameter' among its inputs",
    "build straight --set diametr=4": "there is no input or parameter 'diametr' to set; did you mean diameter?",
    "build straight --set segments=2.5": "segments is 2.5; it must be a whole number",
    "build straight --set initial_length=-3": "initial_length is -3.0; it must be at least 0.01 m and at most 100000 m",
    "build straight --set wind_velocity=8": "wind_velocity is '8'; it must be 3 numbers",
    "build straight --set wind_profile=99": "wind_profile is 99; it must be one of 1 (uniform), ",
    "build straight --set wind_profile=3 --set surface_roughness=7": "the FMU would refuse its start values: ",
    "build straight --set winch_control=force --set winch_force=-500 --inputs motion": "the first step of 0.02 s with its",
    "build straight --set reel_out_speed=-1e5 --inputs wind": "none of its inputs changes that",
    "advise hoist --set wanted.allowed_eror=0.1": "unknown key wanted.allowed_eror; did you mean allowed_error?",
    "advise hoist --set wanted.fixed=true": "unknown key wanted.fixed",
    "advise hoist --set duration=0": "duration is 0; it must be at least 0.5 s",
    "advise hoist --set lines.rope_left.winch_control=force": "rope_left.winch_control is force, and nothing gives that",
    "advise hoist --set loads.winch_left=[0,0,1]": "loads.winch_left is given, and winch_left is not a free point",
    "advise hoist --set loads.left=3": "loads.left is 3; it must be three numbers [x, y, z] in N",
    "advise hoyst": "there is no file and no scene 'hoyst'; did you mean hoist?",
    **{f"sweep circle --vary wind.speed=5,6 {options}": says for options, says in OF_SWEEPS.items()},
}


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """Folder with files and FMUs that cannot be used."""
    place = tmp_path_factory.mktemp("wrong")
    (place / "text.txt").write_text("no archive\n")
    (place / "folder").mkdir()
    (place / "dist").mkdir()  # where FMUs go: it may be made, no file
    (place / "folder" / "file").touch()
    (place / "mine").mkdir()
    (place / "mine" / "README.md").touch()
    zipfile.ZipFile(place / "empty.fmu", "w").close()
    for name, (sound, wrong) in SCENES.items():
        assert sound in SOUND
        (place / name).write_text(SOUND.replace(sound, wrong))
    foreign(place / "other.fmu", output="shape[1,1]")
    foreign(place / "fmi3.fmu", fmi="3.0")
    foreign(place / "exchange.fmu", kind="ModelExchange")
    assert tetherfmu(["build", "straight", "--shape-points", "0", "--out", str(place)]) == 0
    (place / "TetherStraight.fmu").rename(place / "no_shape.fmu")
    assert tetherfmu(["build", "straight", "--shape-points", "2", "--out", str(place)]) == 0
    with zipfile.ZipFile(place / "TetherStraight.fmu") as sound, zipfile.ZipFile(place / "no_library.fmu", "w") as archive:
        for name in sound.namelist():
            if not name.startswith("binaries/"):
                archive.writestr(name, sound.read(name))
    return place


def run(name, *arguments):
    """Exit status of a command, of an example by its room and name, or of a script of `docs/make`."""
    if "." in name or name.startswith("make_"):
        return status_of(*arguments, main=importlib.import_module(name).main)
    return status_of(name, *arguments)


def words(line):
    """Arguments of a command line, of which '' is empty."""
    return ["" if word == "''" else word for word in line.split(" ")]


@pytest.mark.parametrize("line", WRONG)
def test_wrong_use_is_told_in_one_line(place, monkeypatch, capsys, line):
    """With status 2; what only shows when an FMU is loaded ends with 1."""
    monkeypatch.chdir(place)
    before = sorted(place.rglob("*"))
    assert run(*words(line)) == (1 if "no_library" in line else 2)
    said = capsys.readouterr().err
    assert len(said.splitlines()) == 1, said
    assert all(each in said for each in np.atleast_1d(WRONG[line])), said
    assert sorted(place.rglob("*")) == before


@pytest.mark.parametrize(
    ("line", "package", "extra"),
    [
        ("fly --html", "plotly", "html"),
        ("fly landing_hook --html", "plotly", "html"),
        ("fly sound.csv --length 500", "pandas", "examples"),
        ("at_rest.catenary", "matplotlib", "examples"),
        ("import sound.toml --out new.toml", "yaml", "examples"),
        ("tutorial 01", "matplotlib", "examples"),
        ("make_stability --quick", "pebble", "stability"),
        ("advise --fast key.toml", "pandas", "examples"),
        ("tradeoff sound.toml --dask tcp://127.0.0.1:1", "distributed", "cluster"),
        ("make_stability --quick --dask tcp://127.0.0.1:1", "distributed", "cluster"),
    ],
)
def test_a_missing_package_is_named_with_its_extra(place, fmu_folder, tmp_path, line, package, extra):
    (tmp_path / "dist").symlink_to(fmu_folder, target_is_directory=True)
    (tmp_path / "sound.toml").write_text(SOUND)
    name, *arguments = words(line)
    typed = ("tetherfmu.__main__", name) if name in SUBCOMMANDS else (name,)
    done = run_without(package, *typed, *arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr == f'{DISTRIBUTIONS.get(package, package)} is not installed: pip install "tetherfmu[{extra}]"\n'


def test_remedy_of_a_package_without_extra():
    assert remedy("fmpy") == "pip install fmpy"


def test_what_an_fmu_refuses_is_told_without_a_traceback(fmu_folder, tmp_path):
    """The run has failed: the FMU says why, the command that it ends."""
    options = ["--fmu", fmu_folder / "TetherDynamic.fmu", "--wind", "1e9", "0", "0", "--duration", "1"]
    done = run_python("-m", "tetherfmu", "fly", *options, cwd=tmp_path)
    assert done.returncode == 1
    assert "Traceback" not in done.stderr
    assert "wind_velocity" in done.stderr + done.stdout
    assert done.stderr.splitlines()[-1].endswith("); the FMU has said why")


def test_a_free_kite_cannot_be_flown_on_a_circle(fmu_folder, capsys, tmp_path):
    fmu = fmu_folder / "TetherDynamicFree.fmu"
    assert run("fly", "--fmu", str(fmu), "--out", str(tmp_path)) == 2
    assert f"{fmu} has a free kite end" in capsys.readouterr().err
    assert run("fly", "--tether", "dynamic-free", "--out", str(tmp_path)) == 2
    assert "no tether is called dynamic-free; did you mean dynamic?\n" in capsys.readouterr().err


def test_a_disk_that_is_full_is_told(monkeypatch, capsys, tmp_path):
    def full(*_, **__):
        raise OSError(28, "No space left on device", "dist/TetherStraight.fmu.partial")

    monkeypatch.setattr("tetherfmu.commands.build.build", full)
    assert run("build", "straight", "--out", str(tmp_path)) == 1
    assert capsys.readouterr().err == "dist/TetherStraight.fmu.partial: No space left on device\n"


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no disk that is always full")
def test_the_file_is_named_that_does_not_fit(capsys, tmp_path):
    """A full disk is an error without the name of a file."""
    forces = tmp_path / "forces.png"
    forces.symlink_to("/dev/full")
    assert run("fly", "--duration", "1", "--out", str(tmp_path)) == 1
    assert capsys.readouterr().err.endswith(f"{forces}: No space left on device\n")  # perhaps after "... is built"
    assert run("fly", "hoist", "--duration", "1", "--csv", "/dev/full", "--out", str(tmp_path / "hoist")) == 1
    assert capsys.readouterr().err.endswith("/dev/full: No space left on device\n")


def test_what_is_kept_is_said_when_a_disk_is_full():
    with pytest.raises(OSError, match=f"No space left on device; {KEPT}"), keeping():
        raise OSError(28, "No space left on device")


def test_a_release_that_fails_leaves_an_empty_folder(monkeypatch, capsys, tmp_path):
    def no_packages(folder):
        assert list(folder.iterdir())
        raise RuntimeError("no release: a reason")

    monkeypatch.setattr("make_release.build.main", lambda line: (Path(line[1]) / "made").touch() or 0)
    monkeypatch.setattr("make_release.make_packages", no_packages)
    assert run("make_release", "--out", str(tmp_path)) == 1
    assert capsys.readouterr().err == "no release: a reason\n"
    assert not list(tmp_path.iterdir())


def test_a_damaged_fmu_of_a_study_is_named(tmp_path):
    (tmp_path / "TetherStraight.fmu").write_text("no archive")
    with pytest.raises(WrongUse, match=r"TetherStraight\.fmu is not an FMU"):
        fmus_in(tmp_path)


def test_the_command_says_its_version(capsys):
    assert tetherfmu(["--version"]) == 0
    assert capsys.readouterr().out == f"tetherfmu {__version__}\n"
