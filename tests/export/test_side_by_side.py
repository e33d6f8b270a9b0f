"""Several FMUs in one process: the same from two folders, a folder that vanishes, two versions of the package."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from isolation import in_own_process
from runtime.host import Host, every_flavour, of_every_flavour
from tetherfmu.export.archive import SLAVES
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
    """TetherStraight of a version whose tether weighs twice as much, built from a changed copy of the sources."""
    return built_once("other_version", build_other_version) / "TetherStraight.fmu"


def build_other_version(folder):
    shutil.copytree(ROOT / "fmu_sources", folder / "fmu_sources", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "LICENSE", folder)
    weight = "scale({} * property_of(line, 0, at.LINE_DENSITY)"  # at each end of the straight line
    half, whole = weight.format(0.5), weight.format(1.0)
    variants = (folder / "fmu_sources" / "tetherfmu" / "kernels" / "variants").glob("*.py")
    (lines,) = [path for path in variants if half in path.read_text(encoding="utf-8")]
    lines.write_text(lines.read_text(encoding="utf-8").replace(half, whole), encoding="utf-8")
    command = [sys.executable, ROOT / "build_fmus.py", "TetherStraight", "--out", folder, "--platforms", this_platform()]
    environment = {**os.environ, "PYTHONPATH": str(folder / "fmu_sources")}
    subprocess.run(command, env=environment, cwd=folder, check=True, timeout=900)


@pytest.mark.parametrize("other_first", [True, False])
@in_own_process
def test_two_versions_each_run_their_own_code(fmu_folder, other_version, other_first):
    paths = [fmu_folder / "TetherStraight.fmu", other_version]
    hosts = [Host(path) for path in (reversed(paths) if other_first else paths)]
    for host in hosts:
        host.start(kite_position=(500.0, 0.0, 0.0))
    ours, others = reversed(hosts) if other_first else hosts
    # the tether is slack: half of the weight at each end, nothing else
    assert others.get("kite_force[3]") == pytest.approx(2.0 * ours.get("kite_force[3]"), rel=1e-12)
    assert ours.get("kite_force[3]") < -1.0
