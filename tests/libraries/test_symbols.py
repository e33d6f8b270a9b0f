"""The compiled entry points stand alone: they need the mathematical library, memset and memcpy of an old system, no more.

For macOS, where no test here can run them: they are for their processor and ask for no newer system than macOS 11.
"""

import struct

import pytest

from tetherfmu.libraries import ready
from tetherfmu.runtime.kernel_library import file_name, verbs
from tetherfmu.runtime.variants import VARIANTS

ALLOWED = {"memset", "memcpy", "sqrt", "exp", "log", "log1p", "pow", "asinh", "sinh", "atan2", "ceil", "sin", "cos"}
LINUX = "x86_64-linux"
DYNAMIC_SYMBOLS = 11  # type of a section, and the fields below: System V ABI, ELF-64 object file format


def dynamic_symbols(library):
    """Names in a shared library for Linux, whatever this machine is: those that it needs, and those that it offers."""
    content = library.read_bytes()
    (table,) = struct.unpack_from("<Q", content, 0x28)
    size, count = struct.unpack_from("<HH", content, 0x3A)
    sections = [struct.unpack_from("<IIQQQQI", content, table + k * size) for k in range(count)]
    needed, offered = set(), set()
    for _, kind, _, _, start, length, names in sections:
        for entry in range(start, start + length, 24) if kind == DYNAMIC_SYMBOLS else ():
            name, _, _, home = struct.unpack_from("<IBBH", content, entry)
            begin = sections[names][4] + name
            word = content[begin : content.index(b"\0", begin)].decode()
            (offered if home else needed).add(word)
    return needed - {""}, offered


@pytest.mark.parametrize("variant", VARIANTS)
def test_entry_points_need_the_mathematical_library_only(variant):
    folder = ready.folders([variant], [LINUX])[variant]
    needed, offered = dynamic_symbols(folder / file_name(variant, LINUX))
    assert needed <= ALLOWED
    assert offered == {f"{variant}_{verb}" for verb in verbs(variant)}


# Apple's mach-o/loader.h and mach/machine.h
MAGIC, DYNAMIC_LIBRARY, BUILD_VERSION, MACOS = 0xFEEDFACF, 6, 0x32, 1
PROCESSORS = {"x86_64-darwin": 0x01000007, "aarch64-darwin": 0x0100000C}


@pytest.mark.release
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
