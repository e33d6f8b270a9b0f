"""FMUs of systems, built once for all tests that need them."""

from functools import partial
from zlib import crc32

import pytest

from flavours import build_system


@pytest.fixture(scope="session")
def built(built_once):
    """Function of the text of a file, a flavour, a number of wind points: path of the FMU of this system."""

    def fmu_of(text, flavour="pythonfmu", wind_points=0, with_evidence=False):
        name = f"system_{crc32(text.encode()):x}_{flavour}_{wind_points}_{with_evidence:d}"
        make = partial(build_system, flavour=flavour, text=text, wind_points=wind_points, with_evidence=with_evidence)
        return next(built_once(name, make).glob("*.fmu"))

    return fmu_of
