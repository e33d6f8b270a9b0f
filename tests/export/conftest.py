"""FMUs of systems, built once for all tests that need them."""

from zlib import crc32

import pytest

from flavours import build_system


@pytest.fixture(scope="session")
def built(built_once):
    """Function of the text of a file, a flavour and a number of wind points: path of the FMU of this system."""

    def fmu_of(text, flavour="pythonfmu", wind_points=0):
        name = f"system_{crc32(text.encode()):x}_{flavour}_{wind_points}"
        folder = built_once(name, lambda folder: build_system(folder, flavour, text, wind_points))
        return next(folder.glob("*.fmu"))

    return fmu_of
