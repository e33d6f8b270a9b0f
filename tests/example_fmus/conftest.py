"""The FMUs of the examples, built once."""

import pytest


@pytest.fixture(scope="session")
def example_folder(built_once):
    """Folder with all FMUs of the examples."""
    from tetherfmu.export import example_fmus

    def build(folder):
        for name in example_fmus.SLAVES:
            example_fmus.build(name, folder)

    return built_once("example_fmus", build)
