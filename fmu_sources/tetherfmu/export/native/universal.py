"""Universal libraries of macOS: one file with a library for each processor, of which the system takes the one that fits."""

import struct

MAGIC, PAGE_BITS = 0xCAFEBABE, 14  # Apple's mach-o/fat.h; libraries begin at multiples of 16 kB, the larger page


def universal(libraries):
    """Bytes of the universal library of libraries (bytes) for one processor each, which stay as they are and signed."""
    page = 1 << PAGE_BITS
    head, body = struct.pack(">2I", MAGIC, len(libraries)), b""
    for library in libraries:
        body += b"\0" * (-len(body) % page)
        head += struct.pack(">5I", *struct.unpack_from("<2I", library, 4), page + len(body), len(library), PAGE_BITS)
        body += library
    return head.ljust(page, b"\0") + body
