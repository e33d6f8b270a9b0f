"""A finished FMU needs Python and nothing else: no numba, no numpy of its own, no installed package."""

import re
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from tetherfmu.export.archive import SLAVES, build
from tetherfmu.export.build_options import BuildOptions
from tetherfmu.fmi.resources import KERNELS_FOLDER
from tetherfmu.libraries.ahead_of_time import TARGETS
from tetherfmu.runtime.kernel_library import PYTHONFMU, file_name, load, this_platform
from tetherfmu.runtime.variants import VARIANTS

LARGEST = 2_000_000  # bytes of an FMU


def contents(path):
    """Platforms that an FMU has kernels for."""
    with zipfile.ZipFile(path) as archive:
        names = [Path(entry).name for entry in archive.namelist() if f"/{KERNELS_FOLDER}/" in entry]
    return [each for each in TARGETS if any(f"-{each}." in name for name in names)]


def test_runs_where_other_packages_are_forbidden(fmu_folder):
    command = [sys.executable, str(Path(__file__).parent / "alone.py"), str(fmu_folder)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert sorted(line.split(":")[0] for line in done.stdout.splitlines()) == sorted(SLAVES)


@pytest.mark.parametrize("name", list(SLAVES))
def test_carries_its_kernels_and_no_cache(fmu_folder, name):
    path = fmu_folder / f"{name}.fmu"
    assert path.stat().st_size < LARGEST
    assert contents(path) == [this_platform()]
    with zipfile.ZipFile(path) as archive:
        names = archive.namelist()
        scripts = [entry for entry in names if re.fullmatch(r"resources/tether_\w+_[0-9a-f]{12}\.py", entry)]
        assert len(scripts) == 1
        packages = {entry.split("/")[1] for entry in names if "/slave.py" in entry}
        assert [re.fullmatch(r"tetherfmu_[0-9a-f]{12}", package) is not None for package in packages] == [True]
        assert not any("__pycache__" in entry for entry in names)


def test_a_platform_without_kernels_is_told_with_the_remedy(tmp_path):
    for variant in VARIANTS:
        (tmp_path / file_name(variant, "riscv64-linux")).touch()
    with pytest.raises(OSError, match=r"tetherfmu build --platforms") as refusal:
        load(tmp_path, "dynamic")
    assert "only for riscv64-linux;" in str(refusal.value)


def test_libraries_of_pythonfmu_are_those_of_the_kernels(tmp_path):
    """What cannot run for want of kernels is left out; without any nothing is built."""
    for number, platforms in enumerate((("x86_64-windows",), ("x86_64-linux", "aarch64-linux"), tuple(PYTHONFMU))):
        with zipfile.ZipFile(build("TetherStraight", tmp_path / str(number), BuildOptions(platforms=platforms))) as archive:
            libraries = [entry for entry in archive.namelist() if entry.startswith("binaries/")]
        assert [str(Path(entry).parent) + "/" for entry in libraries] == [
            folder for platform, folder in PYTHONFMU.items() if platform in platforms
        ]
    with pytest.raises(RuntimeError, match=r"not for aarch64-darwin; build a native FMU: tetherfmu build --native"):
        build("TetherStraight", tmp_path, BuildOptions(platforms=("aarch64-darwin",)))


def test_all_platforms_link(tmp_path):
    """Linux and Windows on x86, and (linked, never run here) Linux on ARM and macOS on both."""
    assert contents(build("TetherStraight", tmp_path, BuildOptions(platforms=tuple(TARGETS)))) == list(TARGETS)
