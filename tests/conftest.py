"""Shared fixtures, and what is compiled once for all workers of a run.

The kernels' disk cache is named by the sources (`compilation.py`), so it is never stale.
"""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

LONGEST_BUILD = 600.0  # seconds
JUST_IN_TIME = """
from tetherfmu.compiled import kernels
from tetherfmu.runtime.variants import VARIANTS

for variant in VARIANTS:
    kernels(variant)
"""


def compile_all():
    """Fill the caches of the kernels, just in time and ahead of time, side by side; returns at once if they are full."""
    from tetherfmu.export.ahead_of_time import libraries
    from tetherfmu.export.archive import DEFAULT_PLATFORMS, kernels_folder
    from tetherfmu.runtime.variants import VARIANTS

    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    with subprocess.Popen([sys.executable, "-c", JUST_IN_TIME], env=environment):
        libraries(kernels_folder(), DEFAULT_PLATFORMS, VARIANTS)


def pytest_configure(config):
    """Compile before the workers of a whole run start, or each would do it; a run of some tests compiles what they need."""
    whole = config.args_source is config.ArgsSource.TESTPATHS and not config.option.collectonly
    if whole and not hasattr(config, "workerinput"):
        try:
            compile_all()
        except RuntimeError as error:
            pytest.exit(str(error), returncode=1)


@pytest.fixture(scope="session")
def fmu_folder(built_once):
    """Folder with all FMUs, built once per test run."""
    from build_fmus import main

    def build(folder):
        assert main(["--out", str(folder)]) == 0

    return built_once("fmus", build)


@pytest.fixture(scope="session")
def built_once(tmp_path_factory):
    """Function of (name, make): a folder that all workers share, which make(folder) fills in the first one that asks."""
    shared = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        shared = shared.parent

    def once(name, make):
        folder, finished = shared / name, shared / f"{name}.finished"
        try:
            folder.mkdir()
        except FileExistsError:
            deadline = time.monotonic() + LONGEST_BUILD
            while not finished.exists():
                assert time.monotonic() < deadline, f"another worker has not finished {folder}"
                time.sleep(0.1)
        else:
            try:
                make(folder)
            finally:
                finished.touch()  # also after a failure, which the other workers see by what is missing
        return folder

    return once
