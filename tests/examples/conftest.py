"""Fixtures of the examples."""

import pytest


@pytest.fixture(scope="session")
def folder(fmu_folder, example_folder, tmp_path_factory):
    """Folder with the FMUs of both kinds."""
    both = tmp_path_factory.mktemp("both")
    for each in (*fmu_folder.glob("*.fmu"), *example_folder.glob("*.fmu")):
        (both / each.name).symlink_to(each)
    return both
