"""Instructions of a WebAssembly file in C.

Source: WebAssembly Core Specification, 2.0, sections 4.3, "Numerics", and 5.4, "Instructions".
"""

from math import isinf, isnan

from .wasm_file import PREFIX

C_TYPES = {"i32": "uint32_t", "i64": "uint64_t", "f64": "double"}
UNSIGNED = ("+", "-", "*", None, "/", None, "%", "&", "|", "^")
COMPARED = ("==", "!=", "<s", "<", ">s", ">", "<=s", "<=", ">=s", ">=")
SHORT = 8  # characters of a number in decimal digits; a longer one is written in hexadecimal ones, which are exact
BLOCK, LOOP, IF, ELSE, END, BRANCH, BRANCH_IF, BRANCHES, RETURN, CALL = 2, 3, 4, 5, 0x0B, 0x0C, 0x0D, 0x0E, 0x0F, 0x10
UNREACHABLE, DROP, SELECT, GET, SET, TEE, GET_STACK, SET_STACK = 0, 0x1A, 0x1B, 0x20, 0x21, 0x22, 0x23, 0x24
COPY, FILL = (PREFIX, 10), (PREFIX, 11)
LOADS = {  # function, type, size
    0x28: ("load_32", "i32", 4),
    0x29: ("load_64", "i64", 8),
    0x2B: ("load_f64", "f64", 8),
    0x2C: ("(uint32_t)(int8_t)load_8", "i32", 1),
    0x2D: ("load_8", "i32", 1),
    0x30: ("(uint64_t)(int8_t)load_8", "i64", 1),
    0x31: ("load_8", "i64", 1),
    0x34: ("(uint64_t)(int32_t)load_32", "i64", 4),
    0x35: ("load_32", "i64", 4),
}
STORES = {  # function, size
    0x36: ("store_32", 4),
    0x37: ("store_64", 8),
    0x39: ("store_f64", 8),
    0x3A: ("store_8", 1),
    0x3C: ("store_8", 1),
    0x3E: ("store_32", 4),
}
CONSTANTS = {0x41: "i32", 0x42: "i64", 0x44: "f64"}


def _operations():
    """For instructions from numbers to a number: type of the result, template; by code."""
    found = {0x45: ("i32", "(uint32_t)({0} == 0)"), 0x50: ("i32", "(uint32_t)({0} == 0)")}
    for kind, compared, arithmetic in (("i32", 0x46, 0x6A), ("i64", 0x51, 0x7C)):
        bits = kind[1:]
        for place, sign in enumerate(COMPARED):
            a, b = (f"(int{bits}_t){{{k}}}" if sign.endswith("s") else f"{{{k}}}" for k in range(2))
            found[compared + place] = "i32", f"(uint32_t)({a} {sign.rstrip('s')} {b})"
        for place, sign in enumerate(UNSIGNED):
            if sign:
                found[arithmetic + place] = kind, f"({{0}} {sign} {{1}})"
        for place, sign in ((3, "/"), (5, "%")):
            found[arithmetic + place] = kind, f"(uint{bits}_t)((int{bits}_t){{0}} {sign} (int{bits}_t){{1}})"
        shift = f"({{1}} & {int(bits) - 1}u)"
        found[arithmetic + 10] = kind, f"({{0}} << {shift})"
        found[arithmetic + 11] = kind, f"shifted_{bits}({{0}}, {{1}})"
        found[arithmetic + 12] = kind, f"({{0}} >> {shift})"
    for place, sign in enumerate(("==", "!=", "<", ">", "<=", ">=")):
        found[0x61 + place] = "i32", f"(uint32_t)({{0}} {sign} {{1}})"
    for place, sign in enumerate("+-*/"):
        found[0xA0 + place] = "f64", f"({{0}} {sign} {{1}})"
    for code, name in ((0x99, "fabs"), (0x9B, "ceil"), (0x9C, "floor"), (0x9D, "trunc"), (0x9F, "sqrt")):
        found[code] = "f64", f"{name}({{0}})"
    return {
        **found,
        0x9A: ("f64", "(-{0})"),
        0xA6: ("f64", "copysign({0}, {1})"),
        0xA7: ("i32", "(uint32_t){0}"),
        0xAC: ("i64", "(uint64_t)(int64_t)(int32_t){0}"),
        0xAD: ("i64", "(uint64_t){0}"),
        0xB7: ("f64", "(double)(int32_t){0}"),
        0xB8: ("f64", "(double){0}"),
        0xB9: ("f64", "(double)(int64_t){0}"),
        0xBA: ("f64", "(double){0}"),
        0xBD: ("i64", "bits_of({0})"),
        0xBF: ("f64", "number_of({0})"),
        0x9E: ("f64", "rint({0})"),
        0xC0: ("i32", "(uint32_t)(int32_t)(int8_t){0}"),
        0xC2: ("i64", "(uint64_t)(int64_t)(int8_t){0}"),
        0xC4: ("i64", "(uint64_t)(int64_t)(int32_t){0}"),
        (PREFIX, 6): ("i64", "truncated({0})"),
    }


OPERATIONS = _operations()


def number(kind, value):
    """A constant in C."""
    if kind == "i32":
        return f"{value % 2**32}u"
    if kind == "i64":
        return f"{value % 2**64}ull"
    if isnan(value):
        return "NAN"
    if isinf(value):
        return "INFINITY" if value > 0 else "(-INFINITY)"
    text = repr(value) if len(repr(value)) <= SHORT else value.hex()
    return f"({text})" if text.startswith("-") else text
