"""Libraries for macOS, which no test here can run, are for their processor and ask for no newer system than macOS 11."""

import struct

import pytest

from tetherfmu.libraries import ready
from tetherfmu.runtime.kernel_library import file_name
from tetherfmu.runtime.variants import VARIANTS

# Apple's mach-o/loader.h and mach/machine.h
MAGIC, DYNAMIC_LIBRARY, BUILD_VERSION, MACOS = 0xFEEDFACF, 6, 0x32, 1
PROCESSORS = {"x86_64-darwin": 0x01000007, "aarch64-darwin": 0x0100000C}

pytestmark = pytest.mark.release


@pytest.mark.parametrize("platform", list(PROCESSORS))
@pytest.mark.parametrize("variant", VARIANTS)
def test_processor_and_oldest_system(variant, platform):
    library = ready.folders([variant], [platform])[variant] / file_name(variant, platform)
    content = library.read_bytes()
    magic, processor, _, kind, count = struct.unpack_from("<5I", content)
    assert (magic, processor, kind) == (MAGIC, PROCESSORS[platform], DYNAMIC_LIBRARY)
    place, oldest = 32, []
    for _ in range(count):
        command, size = struct.unpack_from("<2I", content, place)
        if command == BUILD_VERSION:
            system, version = struct.unpack_from("<2I", content, place + 8)
            oldest.append((system, version >> 16, version >> 8 & 0xFF))
        place += size
    assert oldest == [(MACOS, 11, 0)]
