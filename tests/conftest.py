"""Shared fixtures. The kernels' disk cache is named by the sources (`compilation.py`), so it is never stale."""

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))


@pytest.fixture(scope="session")
def fmu_folder(tmp_path_factory):
    """Folder with all FMUs, built once per test run."""
    from build_fmus import main

    folder = tmp_path_factory.mktemp("fmus")
    assert main(["--out", str(folder)]) == 0
    return folder
