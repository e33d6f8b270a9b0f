"""C99 of the functions of a WebAssembly file, for any little-endian processor.

The memory is an array of bytes, passed to every function, so that each instance has its own; an address is a place in it.
The stack of the file is at the start of the memory; its top is an argument, too. There are no checks: the kernels equal
those of the libraries, and access the same memory. Operations keep the order of the file, none is merged.

Source: WebAssembly Core Specification, 2.0, chapter 4, "Execution".
"""

import re
from pathlib import Path

from .c_function import Writer
from .c_operations import C_TYPES, CALL, COPY, FILL, GET_STACK, LOADS, SET_STACK, STORES
from .wasm_file import read

HEAD = Path(__file__).with_name("kernels_head.c")  # head of a file, with small functions that it may need


def text(content, names):
    """Text of a C file; content : bytes of a WebAssembly file.  names : dict of exported functions to C names.

    Exported functions have memory and stack arguments, whether they need them or not.
    """
    file = read(content)
    first = len(file.imports)
    names = {number: names[name] for name, number in file.exports.items()}
    needs = _needs(file, names)
    numbers = range(first, first + len(file.functions))
    declared = {k: _declaration(file, k, needs[k], names.get(k, f"f{k}")) for k in numbers}
    definitions = [_definition(file, k, needs, names, declared[k]) for k in numbers]
    head, *helpers = re.split(r"^(?=\n(?:/\*.*\n)?static inline)", HEAD.read_text(encoding="utf-8"), flags=re.MULTILINE)
    named = {re.search(r"(\w+)\(", each.partition("static")[2])[1]: each for each in helpers}
    helpers = [each for name, each in named.items() if any(f"{name}(" in text for text in definitions)]
    parts = [head, _memory(file), *helpers, "\n".join(f"{line};" for line in declared.values()), ""]
    return "\n".join([*parts, *definitions])


def _memory(file):
    """Initial content of the memory."""
    ((address, content),) = file.data
    lines = [", ".join(map(str, content[k : k + 32])) for k in range(0, len(content), 32)]
    return (
        f"enum {{ STACK_TOP = {file.globals[0]}, DATA_AT = {address}, FREE_AT = {file.constants['__heap_base']} }};\n"
        f"static const unsigned char DATA[{len(content)}] = {{\n" + ",\n".join(lines) + "};\n"
    )


def _needs(file, exported):
    """For each function whether it needs the memory ("m") and the stack ("s"), itself or in its callees; or as exported."""
    first = len(file.imports)
    memory = {*LOADS, *STORES, COPY, FILL}
    found = {k: [] for k in range(first)}
    for k, function in enumerate(file.functions, first):
        codes = {code for code, _ in function.body}
        found[k] = [name for name, wanted in (("m", memory), ("s", {GET_STACK})) if codes & wanted or k in exported]
    while True:
        before = str(found)
        for k, function in enumerate(file.functions, first):
            called = {name for code, number in function.body if code == CALL for name in found[number]}
            found[k] = [name for name in "ms" if name in {*found[k], *called}]
        if str(found) == before:
            return found


def _declaration(file, place, needs, name):
    """The first line of a function, without a semicolon."""
    signature = file.functions[place - len(file.imports)].signature
    given = [{"m": "unsigned char *m", "s": "uint32_t s"}[each] for each in needs]
    given += [f"{C_TYPES[kind]} l{k}" for k, kind in enumerate(signature.arguments)]
    result = C_TYPES[signature.results[0]] if signature.results else "void"
    return f"static {result} {name}({', '.join(given) or 'void'})"


def _definition(file, place, needs, names, declared):
    """Text of a function."""
    function = file.functions[place - len(file.imports)]
    writer = Writer(file, function, needs, names)
    body = writer.write()
    arguments = len(function.signature.arguments)
    variables = [
        f"{C_TYPES[kind]} l{k} = 0;" for k, kind in enumerate(writer.kinds) if k >= arguments and f"l{k}" in writer.used
    ]
    unused = [f"(void)l{k};" for k in range(arguments) if f"l{k}" not in writer.used]
    unused += [f"(void){name};" for name in needs[place] if not re.search(rf"\b{name}\b", "\n".join(body))]
    return "\n".join([declared, "{", *variables, *unused, *body, "}", ""])


def stack_size(content):
    """Maximum bytes of stack: of the deepest call chain; there is no recursion."""
    file = read(content)
    first = len(file.imports)
    deepest = dict.fromkeys(range(first), 0)

    def depth(k, below=()):
        assert k not in below, "a function calls itself"
        if k not in deepest:
            body = file.functions[k - first].body
            called = {number for code, number in body if code == CALL}
            deepest[k] = _frame(body) + max((depth(each, (*below, k)) for each in called), default=0)
        return deepest[k]

    return max(map(depth, file.exports.values()))


def _frame(body):
    """Bytes of the stack frame of a function."""
    for (one, _), (two, size), (three, _) in zip(body, body[1:], body[2:], strict=False):
        if (one, two, three) == (GET_STACK, 0x41, 0x6B):
            return size
    assert not any(code in (GET_STACK, SET_STACK) for code, _ in body), "a stack frame of another form"
    return 0
