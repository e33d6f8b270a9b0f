"""Read a WebAssembly file: its types, imports, functions, exports and data, and the instructions of a function.

Source: WebAssembly Core Specification, 2.0, chapter 5, "Binary Format"; features absent from LLVM's kernels are refused.
"""

import struct
from io import BytesIO
from typing import NamedTuple

TYPES = {0x7F: "i32", 0x7E: "i64", 0x7D: "f32", 0x7C: "f64"}
EMPTY = 0x40  # block without a result
FUNCTION, TABLE, MEMORY, GLOBAL = range(4)  # kinds of imports and exports
NO_OPERAND, INDEX, BLOCK, PLACE, BRANCHES = "", "index", "block", "place", "branches"
# instructions with operands, by their code; those without are all others
OPERANDS = {
    **dict.fromkeys((0x02, 0x03, 0x04), BLOCK),
    **dict.fromkeys((0x0C, 0x0D, 0x10, 0x20, 0x21, 0x22, 0x23, 0x24), INDEX),
    **dict.fromkeys(range(0x28, 0x3F), PLACE),
    0x0E: BRANCHES,
    0x41: "i32",
    0x42: "i64",
    0x44: "f64",
}
PREFIX = 0xFC  # of instructions with a second number
MEMORIES = {10: 2, 11: 1}  # bytes that follow memory.copy and memory.fill: the number of the only memory


class Signature(NamedTuple):
    """Types of a function."""

    arguments: tuple
    results: tuple


class Function(NamedTuple):
    """One function of the file."""

    signature: Signature
    variables: tuple  # types of local variables
    body: list  # of (code, operand); the operand of loads and stores is (offset, alignment) in bytes


class File(NamedTuple):
    """Contents of a WebAssembly file."""

    imports: list  # (name, Signature) of functions, in their order
    functions: list  # `Function`; numbered after the imports
    exports: dict  # name: number of a function
    constants: dict  # name: value of an exported global
    globals: list  # first values
    data: list  # (address, bytes)


class Reader(BytesIO):
    """Bytes that are read one after the other."""

    def byte(self):
        """One byte."""
        return self.read(1)[0]

    def _groups(self):
        """Number of groups of 7 bits (LEB128), its bits, and the sign bit of the last group."""
        number, shift = 0, 0
        while True:
            byte = self.byte()
            number |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80:
                return number, shift, byte & 0x40

    def whole(self):
        """An unsigned number (LEB128)."""
        return self._groups()[0]

    def signed(self):
        """A signed number (LEB128)."""
        number, bits, is_negative = self._groups()
        return number - (1 << bits) if is_negative else number

    def name(self):
        """A name in UTF-8."""
        return self.read(self.whole()).decode("utf-8")

    def types(self):
        """A list of types."""
        return tuple(TYPES[self.byte()] for _ in range(self.whole()))

    def constant(self):
        """Value of a constant expression of an address."""
        assert self.byte() == 0x41, "an address that is no constant"
        value = self.signed()
        assert self.byte() == 0x0B
        return value


def read(content):
    """`File` of the bytes of a WebAssembly file."""
    assert content[:8] == b"\0asm\1\0\0\0", "no WebAssembly file"
    whole, sections = Reader(content[8:]), {}
    while number := whole.read(1):
        sections[number[0]] = Reader(whole.read(whole.whole()))
    signatures = [_signature(each) for each in _items(sections[1])]
    imports = [(name, signatures[kind]) for name, kind in map(_import, _items(sections[2])) if kind is not None]
    kinds = [each.whole() for each in _items(sections[3])]
    first = [_global(each) for each in _items(sections[6])]
    listed = [(each.name(), each.byte(), each.whole()) for each in _items(sections[7])]
    functions = [_function(each, signatures[kind]) for each, kind in zip(_items(sections[10]), kinds, strict=True)]
    exports = {name: number for name, kind, number in listed if kind == FUNCTION}
    constants = {name: first[number] for name, kind, number in listed if kind == GLOBAL}
    data = [_data(each) for each in _items(sections[11])] if 11 in sections else []
    return File(imports, functions, exports, constants, first, data)


def _items(section):
    """The section, once for each of its items, which the caller reads."""
    for _ in range(section.whole()):
        yield section


def _signature(reader):
    assert reader.byte() == 0x60
    return Signature(reader.types(), reader.types())


def _import(reader):
    """Name, and number of the signature of a function; None for the memory."""
    reader.name()
    name, kind = reader.name(), reader.byte()
    if kind == FUNCTION:
        return name, reader.whole()
    assert kind == MEMORY, f"import of kind {kind}"
    limits = reader.byte()
    reader.whole()
    if limits & 1:
        reader.whole()
    return name, None


def _global(reader):
    assert TYPES[reader.byte()] == "i32"
    reader.byte()
    return reader.constant()


def _data(reader):
    assert reader.whole() == 0, "data for no fixed address"
    address = reader.constant()
    return address, reader.read(reader.whole())


def _function(reader, signature):
    reader, variables = Reader(reader.read(reader.whole())), []
    for _ in range(reader.whole()):
        count = reader.whole()
        variables += count * [TYPES[reader.byte()]]
    body = []
    while code := reader.read(1):
        body.append(_instruction(code[0], reader))
    return Function(signature, tuple(variables), body)


def _instruction(code, reader):
    """An instruction and its operand, which the reader comes to."""
    if code == PREFIX:
        second = reader.whole()
        reader.read(MEMORIES.get(second, 0))
        return (PREFIX, second), None
    kind = OPERANDS.get(code, NO_OPERAND)
    if kind == INDEX:
        return code, reader.whole()
    if kind == PLACE:
        aligned = 1 << reader.whole()
        return code, (reader.whole(), aligned)
    if kind == BLOCK:
        found = reader.byte()
        assert found == EMPTY or found in TYPES, "a block with several results"
        return code, TYPES.get(found)
    if kind in ("i32", "i64"):
        return code, reader.signed()
    if kind == "f64":
        return code, struct.unpack("<d", reader.read(8))[0]
    if kind == BRANCHES:
        return code, [reader.whole() for _ in range(reader.whole() + 1)]
    return code, None
