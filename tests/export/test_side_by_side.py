"""Several FMUs in one process: the same from two folders, a folder that vanishes, two versions of the package."""

import gzip
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from isolation import in_own_process
from runtime.host import Host, every_flavour, of_every_flavour
from tetherfmu.export.archive import SLAVES
from tetherfmu.libraries import ready
from tetherfmu.libraries.ahead_of_time import CODE
from tetherfmu.runtime.kernel_library import this_platform

ROOT = Path(__file__).resolve().parents[2]


def forces(host):
    host.step(0.02)
    return host.all_outputs()


@of_every_flavour("fmu")
@in_own_process
def test_the_same_fmu_from_two_folders(fmu_folder, fmu):
    first, second = (Host(fmu_folder / f"{fmu}.fmu", own_folder=True).start() for _ in range(2))
    assert first.folder != second.folder
    assert forces(first) == forces(second)


@of_every_flavour("fmu")
@in_own_process
def test_the_folder_may_vanish(fmu_folder, fmu):
    """Running instances go on, also after a reset. (A new one needs the folder: PythonFMU's library reads it.)"""
    twin = Host(fmu_folder / f"{fmu}.fmu").start()
    host = Host(fmu_folder / f"{fmu}.fmu", own_folder=True).start()
    shutil.rmtree(host.folder)
    expected = forces(twin)
    assert forces(host) == expected
    host.fmu.reset()
    host.time = 0.0
    host.start()
    assert forces(host) == expected


@every_flavour
@in_own_process
def test_all_variants_in_one_process(fmu_folder):
    alone = {fmu: forces(Host(fmu_folder / f"{fmu}.fmu").start()) for fmu in SLAVES}
    hosts = {fmu: Host(fmu_folder / f"{fmu}.fmu").start() for fmu in SLAVES}
    assert {fmu: forces(host) for fmu, host in hosts.items()} == alone
    assert len({tuple(outputs) for outputs in alone.values()}) == len(SLAVES)


@in_own_process
def test_both_flavours_in_one_process(fmu_folder, native_folder):
    folders = (fmu_folder, native_folder, fmu_folder)
    hosts = [Host(folder / "TetherDynamic.fmu", own_folder=True).start() for folder in folders]
    assert forces(hosts[0]) == forces(hosts[1]) == forces(hosts[2])


@pytest.fixture(scope="session")
def other_version(built_once):
    """TetherStraight of a version in which it is a catenary."""
    return built_once("other_version", build_other_version) / "TetherStraight.fmu"


KEEP = f"""
import gzip, sys
from tetherfmu.libraries import ready
place = ready.place(ready.cache_folder(), "straight")
place.mkdir(parents=True)
(place / "{CODE}").write_bytes(gzip.compress(sys.stdin.buffer.read()))
"""


def build_other_version(folder):
    """From an edited copy of the sources, to which numba's code of the catenary is given: numba takes ten seconds."""
    shutil.copytree(ROOT / "fmu_sources", folder / "fmu_sources", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "LICENSE", folder)
    with (folder / "fmu_sources" / "tetherfmu" / "kernels" / "variants" / "straight.py").open("a") as file:
        file.write("EDITED = 1\n")
    catenary = ready.folders(["catenary"], [this_platform()])["catenary"] / CODE
    code = gzip.decompress(catenary.read_bytes()).replace(b"catenary", b"straight")
    options = {
        "env": {**os.environ, "PYTHONPATH": str(folder / "fmu_sources")},
        "cwd": folder,
        "check": True,
        "timeout": 900,
    }
    subprocess.run([sys.executable, "-c", KEEP], input=code, **options)
    command = [sys.executable, ROOT / "build_fmus.py", "TetherStraight", "--out", folder, "--platforms", this_platform()]
    subprocess.run(command, **options)


@pytest.mark.parametrize("other_first", [True, False])
@in_own_process
def test_two_versions_each_run_their_own_code(fmu_folder, other_version, other_first):
    paths = [fmu_folder / "TetherStraight.fmu", other_version]
    hosts = [Host(path).start() for path in (reversed(paths) if other_first else paths)]
    ours, others = reversed(hosts) if other_first else hosts
    expected = forces(Host(fmu_folder / "TetherCatenary.fmu").start())
    assert forces(others) == expected
    assert forces(ours) != expected
