"""A wheel is all that a user needs: it builds FMUs and flies the circle where nothing can compile."""

import os
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import zipfile
from pathlib import Path

import pytest

from tetherfmu.libraries import c_kernels, ready, webassembly
from tetherfmu.libraries.ahead_of_time import TARGETS, object_name
from tetherfmu.libraries.examples import example
from tetherfmu.runtime.kernel_library import file_name
from tetherfmu.runtime.variants import EVERY_VARIANT, class_name

ROOT = Path(__file__).resolve().parents[2]
LARGEST = 1_250_000  # bytes of a library, for both kinds of x86-64; the largest has 1 218 560, systems for Windows
SCRIPTS = "Scripts" if os.name == "nt" else "bin"
PLACES = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}  # which would come before the wheel
TURBULENT = "turbulent_circle", "turbulent_parked_kite"  # systems with a box of wind
pytestmark = pytest.mark.release
WITHOUT_COMPILER = 'import sys\nsys.modules |= dict.fromkeys(("numba", "llvmlite", "ziglang"))\n'


def done(*command, **options):
    """Run a command that must succeed; returns what it printed."""
    result = subprocess.run([*map(str, command)], capture_output=True, text=True, check=False, env=PLACES, **options)
    assert result.returncode == 0, result.stdout + result.stderr
    return result.stdout


@pytest.fixture(scope="module")
def packages(built_once):
    """Paths of the wheel and of the sdist."""

    def build(folder):
        done(sys.executable, "-m", "build", "--no-isolation", "--sdist", "--wheel", "--outdir", folder, ROOT)

    folder = built_once("packages", build)
    return next(folder.glob("*.whl")), next(folder.glob("*.tar.gz"))


@pytest.fixture(scope="module")
def clean(packages, tmp_path_factory):
    """Folder of the scripts of a new environment with the wheel; numpy and FMPy come from here, no compiler does.

    A file of numba lies beside the package, as where an extra has brought numba: it must not matter.
    """
    folder = tmp_path_factory.mktemp("clean") / "venv"
    done(sys.executable, "-m", "venv", "--without-pip", folder)
    python = folder / SCRIPTS / "python"
    done(sys.executable, "-m", "pip", "--python", python, "install", "--quiet", "--no-index", "--no-deps", packages[0])
    site = Path(done(python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))").strip())
    (site / "from_here.pth").write_text(f"{sysconfig.get_path('purelib')}\n")
    (site / "sitecustomize.py").write_text(WITHOUT_COMPILER)
    (site / "numba" / "core").mkdir(parents=True)
    (site / "numba" / "core" / "cgutils.py").touch()
    return python.parent


def test_one_wheel_has_small_libraries_for_all_platforms(packages):
    wheel, _ = packages
    assert wheel.name.endswith("-py3-none-any.whl")
    with zipfile.ZipFile(wheel) as archive:
        sizes = {Path(each.filename).name: each.file_size for each in archive.infolist() if "/compiled/" in each.filename}
    libraries = {file_name(variant, platform) for variant in ready.LIBRARIES for platform in TARGETS}
    assert sizes.keys() == {*libraries, *map(object_name, TARGETS), webassembly.FILE, c_kernels.FILE}
    assert max(sizes[name] for name in libraries) < LARGEST


def test_the_sdist_can_be_tested_and_released(packages):
    _, sdist = packages
    with tarfile.open(sdist) as archive:
        names = {name.partition("/")[2] for name in archive.getnames()}
    needed = (
        "pyproject.toml",
        "build_fmus.py",
        "LICENSE",
        "examples/first_flight/circular_flight.py",
        "tests/conftest.py",
        "docs/models/theory.md",
        "docs/make/make_release.py",
        "docs/make/stability/page.md.j2",
    )
    assert names >= {*needed, "fmu_sources/tetherfmu/fmi/slave.py"}
    assert not [name for name in names if "__pycache__" in name or "/compiled/" in name]


def test_builds_and_flies_the_circle_without_a_compiler(clean, tmp_path):
    place = done(clean / "python", "-c", "import tetherfmu; print(tetherfmu.__file__)", cwd=tmp_path)
    assert Path(place).is_relative_to(clean.parent)
    built = done(clean / "tetherfmu", "build", "--platforms", "all", "--examples", cwd=tmp_path).splitlines()
    tethers, examples = built[: len(EVERY_VARIANT)], built[len(EVERY_VARIANT) :]
    assert [Path(line.split()[0]).name for line in tethers] == [f"{class_name(variant)}.fmu" for variant in EVERY_VARIANT]
    assert all(line.endswith(f"for {', '.join(TARGETS)}") for line in tethers)
    systems = [f"{name}.ssp" for name in ("kite_power_system", "winch_inside", "circular_flight", *TURBULENT)]
    assert [Path(line.split()[0]).name for line in examples] == [
        *(f"{name}.fmu" for name in example("shared.example_fmus").SLAVES),
        *systems,
    ]
    flown = done(clean / "tetherfmu", "fly", cwd=tmp_path).splitlines()
    assert sum("times real time" in line for line in flown) == 1
    figures = [tmp_path / line for line in flown if line.endswith(".png")]
    assert len(figures) == 3
    assert all(figure.stat().st_size > 10_000 for figure in figures)
    assert "01  " in done(clean / "tetherfmu", "tutorial", cwd=tmp_path)
    assert "times real time" in done(clean / "tetherfmu", "tutorial", "06", cwd=tmp_path)
    assert "files are in mine" in done(clean / "tetherfmu", "tutorial", "--copy", "mine", cwd=tmp_path)
    assert (tmp_path / "mine" / "tutorial" / "tether_01.py").is_file()


def test_a_native_fmu_needs_a_compiler_to_be_built(clean, tmp_path):
    """What it is made of is in the wheel; the compiler that is missing is named in one line, with the remedy."""
    site = Path(done(clean / "python", "-c", "import tetherfmu; print(tetherfmu.__path__[0])").strip())
    assert (site / "runtime" / "native" / "instance.h").exists()
    command = [str(clean / "tetherfmu"), "build", "straight", "--native"]
    failed = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False, env=PLACES)
    assert failed.returncode == 2
    assert len(failed.stderr.splitlines()) == 1
    assert "ziglang is not installed" in failed.stderr


def test_checks_and_advises_without_a_checkout(clean, tmp_path):
    """From a folder with nothing but a scene; the FMU carries the start values that its builder was given."""
    shutil.copy(ROOT / "examples" / "scenes" / "parked.toml", tmp_path)
    done(clean / "tetherfmu", "build", "quasi-steady", "--diameter", "0.006", cwd=tmp_path)
    checked = done(clean / "tetherfmu", "check", "dist/TetherQuasiSteady.fmu", cwd=tmp_path)
    assert "evidence set: 200 steps" in checked
    assert checked.endswith("0 problems found\n")
    assert "Scene parked: " in done(clean / "tetherfmu", "advise", "--fast", "parked.toml", cwd=tmp_path)


def test_writes_the_page_for_browsers(clean, tmp_path):
    """From an empty folder, with the kernels that the wheel carries."""
    lines = done(clean / "tetherfmu", "web", cwd=tmp_path).splitlines()
    written = [Path(line.split()[0]) for line in lines]
    assert [path.name for path in written] == ["index.html", "page.js", webassembly.FILE]
    assert all((tmp_path / path).stat().st_size > 10_000 for path in written)


def test_the_wheel_says_that_it_is_typed(packages):
    with zipfile.ZipFile(packages[0]) as archive:
        assert "tetherfmu/py.typed" in archive.namelist()


def test_edited_kernels_are_never_replaced_by_those_of_the_wheel(clean, tmp_path):
    site = Path(done(clean / "python", "-c", "import tetherfmu; print(tetherfmu.__path__[0])").strip())
    source = site / "kernels" / "variants" / "straight.py"
    text = source.read_text(encoding="utf-8")
    source.write_text(text + "EDITED = 1\n", encoding="utf-8")
    try:
        start = [str(clean / "python"), "-c", "import tetherfmu; tetherfmu.TetherStraight()"]
        failed = subprocess.run(start, cwd=tmp_path, capture_output=True, text=True, check=False, env=PLACES)
    finally:
        source.write_text(text, encoding="utf-8")
    assert failed.returncode == 1
    assert "compiling the kernels failed" in failed.stderr
