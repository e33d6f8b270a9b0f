"""FMUs of systems, built once for all tests that need them."""

from zlib import crc32

import pytest

from flavours import build_all


@pytest.fixture(scope="session")
def built(built_once):
    """Function of the text of a file, a number of wind points and a flavour: folder with the FMU of this system."""

    def folder_of(text, wind_points=0, flavour=""):
        def make(folder):
            (folder / "system.toml").write_text(text, encoding="utf-8")
            build_all(folder, folder / "system.toml", wind_points=wind_points)

        return built_once(f"system_{crc32(text.encode()):x}_{wind_points}", make) / flavour

    return folder_of
