"""C99 of the functions of a WebAssembly file, for any little-endian processor.

The memory is an array of bytes that every function is given, so that each instance has its own; an address is a place in it.
The stack of the file lies at the start of the memory; its top is an argument, too. Nothing is checked: the kernels are those
of the libraries, and touch no more than those do. Operations are done in the order of the file, none is merged.

Source: WebAssembly Core Specification, 2.0, chapter 4, "Execution".
"""

import re
from math import isinf, isnan
from typing import NamedTuple

from .wasm_file import PREFIX, read

C_TYPES = {"i32": "uint32_t", "i64": "uint64_t", "f64": "double"}
UNSIGNED = ("+", "-", "*", None, "/", None, "%", "&", "|", "^")
COMPARED = ("==", "!=", "<s", "<", ">s", ">", "<=s", "<=", ">=s", ">=")
LONGEST = 140  # characters of an expression; a longer one is given a name
SHORT = 8  # characters of a number in decimal digits; a longer one is written in hexadecimal ones, which are exact
BLOCK, LOOP, IF, ELSE, END, BRANCH, BRANCH_IF, BRANCHES, RETURN, CALL = 2, 3, 4, 5, 0x0B, 0x0C, 0x0D, 0x0E, 0x0F, 0x10
UNREACHABLE, DROP, SELECT, GET, SET, TEE, GET_STACK, SET_STACK = 0, 0x1A, 0x1B, 0x20, 0x21, 0x22, 0x23, 0x24
COPY, FILL = (PREFIX, 10), (PREFIX, 11)
LOADS = {  # function, type
    0x28: ("load_32", "i32"),
    0x29: ("load_64", "i64"),
    0x2B: ("load_f64", "f64"),
    0x2D: ("load_8", "i32"),
    0x31: ("load_8", "i64"),
    0x35: ("load_32", "i64"),
}
STORES = {0x36: "store_32", 0x37: "store_64", 0x39: "store_f64", 0x3A: "store_8", 0x3C: "store_8", 0x3E: "store_32"}
CONSTANTS = {0x41: "i32", 0x42: "i64", 0x44: "f64"}


def _operations():
    """Of instructions that take numbers and give one: type of the result, template; by code."""
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
        0xC0: ("i32", "(uint32_t)(int32_t)(int8_t){0}"),
        0xC4: ("i64", "(uint64_t)(int64_t)(int32_t){0}"),
        (PREFIX, 6): ("i64", "truncated({0})"),
    }


OPERATIONS = _operations()
_HELPERS = """\
static inline uint32_t load_8(const unsigned char *at)
{
    return *at;
}

static inline uint32_t load_32(const unsigned char *at)
{
    uint32_t number;
    memcpy(&number, at, sizeof number);
    return number;
}

static inline uint64_t load_64(const unsigned char *at)
{
    uint64_t number;
    memcpy(&number, at, sizeof number);
    return number;
}

static inline double load_f64(const unsigned char *at)
{
    double number;
    memcpy(&number, at, sizeof number);
    return number;
}

static inline void store_8(unsigned char *at, uint64_t number)
{
    *at = (unsigned char)number;
}

static inline void store_32(unsigned char *at, uint64_t given)
{
    uint32_t number = (uint32_t)given;
    memcpy(at, &number, sizeof number);
}

static inline void store_64(unsigned char *at, uint64_t number)
{
    memcpy(at, &number, sizeof number);
}

static inline void store_f64(unsigned char *at, double number)
{
    memcpy(at, &number, sizeof number);
}

static inline uint32_t shifted_32(uint32_t number, uint32_t by)
{
    by &= 31u;
    return number >> by | (number >> 31 && by ? ~(uint32_t)0 << (32u - by) : 0u);
}

static inline uint64_t shifted_64(uint64_t number, uint64_t by)
{
    by &= 63u;
    return number >> by | (number >> 63 && by ? ~(uint64_t)0 << (64u - by) : 0u);
}

static inline uint64_t bits_of(double number)
{
    uint64_t bits;
    memcpy(&bits, &number, sizeof bits);
    return bits;
}

static inline double number_of(uint64_t bits)
{
    double number;
    memcpy(&number, &bits, sizeof number);
    return number;
}

/* Towards zero, and to the nearest limit where it is beyond them. */
static inline uint64_t truncated(double number)
{
    if (number != number) return 0;
    if (number >= 9223372036854775808.0) return (uint64_t)INT64_MAX;
    if (number <= -9223372036854775808.0) return (uint64_t)INT64_MIN;
    return (uint64_t)(int64_t)number;
}
"""
HELPERS = [f"{each}\n}}\n" for each in _HELPERS.split("\n}\n")[:-1]]
HEAD = """\
/* The kernels as C99: made of WebAssembly by libraries/c_code.py. `m` is the memory of an instance, `s` the top of its stack;
an address is a place in the memory. */
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "the kernels are for processors that store the lowest byte first"
#endif
#if FLT_EVAL_METHOD != 0
#error "the kernels need doubles that are rounded after each operation; compile for SSE2"
#endif
/* no product and sum in one operation, which would be rounded once only */
#if defined(__clang__) || defined(_MSC_VER)
#pragma STDC FP_CONTRACT OFF
#elif defined(__GNUC__)
#pragma GCC optimize("fp-contract=off")
#endif
"""


class Value(NamedTuple):
    """An expression on the stack of the file."""

    text: str
    kind: str
    variables: frozenset = frozenset()  # that it reads, and that may change
    reads_memory: bool = False


class Label(NamedTuple):
    """Where a branch goes."""

    name: str
    code: int  # BLOCK, LOOP or IF
    height: int  # of the stack


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


class Writer:
    """The text of one function."""

    def __init__(self, file, function, needs, names):
        self.file, self.function, self.needs, self.names_of_functions = file, function, needs, names
        self.kinds = (*function.signature.arguments, *function.variables)
        self.lines, self.stack, self.labels = [], [], []
        self.names, self.used = 0, set()  # names given; labels and variables that occur

    def fresh(self, letter):
        self.names += 1
        return f"{letter}{self.names}"

    def push(self, text, kind, variables=frozenset(), reads_memory=False):
        self.stack.append(Value(text, kind, variables, reads_memory))
        if len(text) > LONGEST:
            self.name(len(self.stack) - 1)

    def name(self, place):
        """Give a value of the stack a name, so that nothing can change it."""
        value = self.stack[place]
        name = self.fresh("t")
        self.lines.append(f"const {C_TYPES[value.kind]} {name} = {value.text};")
        self.stack[place] = Value(name, value.kind)

    def keep(self, wanted):
        """Give names to those values of the stack that are wanted."""
        for place, value in enumerate(self.stack):
            if wanted(value):
                self.name(place)

    def keep_all(self):
        self.keep(lambda value: value.variables or value.reads_memory)

    def set(self, variable, text):
        self.keep(lambda value: variable in value.variables)
        self.lines.append(f"{variable} = {text};")
        self.used.add(variable)

    def pop(self, count):
        taken = self.stack[len(self.stack) - count :]
        del self.stack[len(self.stack) - count :]
        variables = frozenset().union(*(value.variables for value in taken))
        return [value.text for value in taken], variables, any(value.reads_memory for value in taken)

    def place(self, text, offset):
        return f"m + {text} + {offset}" if offset else f"m + {text}"

    def goto(self, depth):
        if depth == len(self.labels):
            return self.leave()
        label = self.labels[-1 - depth]
        self.used.add(label.name)
        return f"goto {label.name};"

    def leave(self):
        return f"return {self.stack[-1].text};" if self.function.signature.results else "return;"

    def write(self):
        """Lines of the body."""
        dead = 0  # blocks that are open behind a branch that is always taken
        skipping = False
        for code, operand in self.function.body:
            if skipping:
                if code in (BLOCK, LOOP, IF):
                    dead += 1
                    continue
                if dead or code not in (ELSE, END):
                    dead -= code == END
                    continue
                skipping = False
            skipping = self.instruction(code, operand)
        labels = re.compile(r"(L\d+):;")
        named = (labels.fullmatch(line) for line in self.lines)
        return [line for line, label in zip(self.lines, named, strict=True) if not label or label[1] in self.used]

    def instruction(self, code, operand):
        """Write one instruction; whether what follows is never reached."""
        if code in OPERATIONS:
            kind, template = OPERATIONS[code]
            texts, variables, reads = self.pop(2 if "{1}" in template else 1)
            self.push(template.format(*texts), kind, variables, reads)
        elif code in CONSTANTS:
            self.push(number(CONSTANTS[code], operand), CONSTANTS[code])
        elif code in (GET, SET, TEE):
            self.variable(code, f"l{operand}", self.kinds[operand])
        elif code in (GET_STACK, SET_STACK):
            assert operand == 0, "a second global"
            self.variable(GET if code == GET_STACK else SET, "s", "i32")
        elif code in LOADS:
            (text,), variables, _ = self.pop(1)
            function, kind = LOADS[code]
            self.push(f"{function}({self.place(text, operand)})", kind, variables, True)
        elif code in STORES:
            (address, value), *_ = self.pop(2)
            self.keep(lambda value: value.reads_memory)
            self.lines.append(f"{STORES[code]}({self.place(address, operand)}, {value});")
        elif code in (COPY, FILL):
            self.bulk(code)
        elif code == SELECT:
            kind = self.stack[-2].kind
            (a, b, condition), variables, reads = self.pop(3)
            self.push(f"({condition} ? {a} : {b})", kind, variables, reads)
        elif code == CALL:
            self.call(operand)
        elif code == DROP:
            self.stack.pop()
        else:
            return self.control(code, operand)
        return False

    def variable(self, code, name, kind):
        if code == GET:
            self.used.add(name)
            self.push(name, kind, frozenset({name}))
            return
        (text,), *_ = self.pop(1)
        self.set(name, text)
        if code == TEE:
            self.push(name, kind, frozenset({name}))

    def bulk(self, code):
        (target, source, count), *_ = self.pop(3)
        self.keep(lambda value: value.reads_memory)
        if code == FILL:
            self.lines.append(f"memset(m + {target}, (int){source}, {count});")
        else:
            self.lines.append(f"memmove(m + {target}, m + {source}, {count});")

    def call(self, called_number):
        if called_number < len(self.file.imports):
            name, signature = self.file.imports[called_number]
            texts, variables, reads = self.pop(len(signature.arguments))
            self.push(f"{name}({', '.join(texts)})", signature.results[0], variables, reads)
            return
        signature = self.file.functions[called_number - len(self.file.imports)].signature
        texts, *_ = self.pop(len(signature.arguments))
        self.keep(lambda value: value.reads_memory)
        name = self.names_of_functions.get(called_number, f"f{called_number}")
        text = f"{name}({', '.join([*self.needs[called_number], *texts])})"
        if not signature.results:
            self.lines.append(f"{text};")
            return
        name = self.fresh("t")
        self.lines.append(f"const {C_TYPES[signature.results[0]]} {name} = {text};")
        self.push(name, signature.results[0])

    def control(self, code, operand):
        """As `instruction`, of those that lead elsewhere."""
        if code in (BLOCK, LOOP, IF):
            self.open(code, operand)
        elif code == ELSE:
            self.lines.append("} else {")
        elif code == END:
            self.close()
        elif code == BRANCH_IF:
            (condition,), *_ = self.pop(1)
            self.lines.append(f"if ({condition}) {self.goto(operand)}")
        elif code == BRANCHES:
            (chosen,), *_ = self.pop(1)
            *cases, default = map(self.goto, operand)
            self.lines += [f"switch ({chosen}) {{", *(f"case {place}: {case}" for place, case in enumerate(cases))]
            self.lines += [f"default: {default}", "}"]
        elif code in (BRANCH, RETURN):
            self.lines.append(self.goto(operand) if code == BRANCH else self.leave())
        elif code == UNREACHABLE:
            self.lines.append("return 0;" if self.function.signature.results else "return;")
        else:
            raise ValueError(f"WebAssembly's instruction {code} is not known")
        return code in (BRANCH, BRANCHES, RETURN, UNREACHABLE)

    def open(self, code, kind):
        assert kind is None, "a block with a result"
        condition = self.pop(1)[0][0] if code == IF else ""
        self.keep_all()
        label = Label(self.fresh("L"), code, len(self.stack))
        self.labels.append(label)
        if code == LOOP:
            self.lines.append(f"{label.name}:;")
        if code == IF:
            self.lines.append(f"if ({condition}) {{")

    def close(self):
        if not self.labels:
            if self.stack:
                self.lines.append(self.leave())
            return
        label = self.labels.pop()
        del self.stack[label.height :]
        if label.code == IF:
            self.lines.append("}")
        if label.code != LOOP:
            self.lines.append(f"{label.name}:;")


def text(content, names):
    """Text of a C file; content : bytes of a WebAssembly file.  names : of the functions that it exports, dict to those in C.

    The functions that it exports take memory and stack, whether they need them or not.
    """
    file = read(content)
    first = len(file.imports)
    names = {number: names[name] for name, number in file.exports.items()}
    needs = _needs(file, names)
    numbers = range(first, first + len(file.functions))
    declared = {k: _declaration(file, k, needs[k], names.get(k, f"f{k}")) for k in numbers}
    definitions = [_definition(file, k, needs, names, declared[k]) for k in numbers]
    helpers = [each for each in HELPERS if any(f"{_name_of(each)}(" in text for text in definitions)]
    parts = [HEAD, _memory(file), *helpers, "\n".join(f"{line};" for line in declared.values()), ""]
    return "\n".join([*parts, *definitions])


def _name_of(helper):
    """Name of a function of `HELPERS`."""
    return re.search(r"(\w+)\(", helper.partition("static")[2])[1]


def _memory(file):
    """What the memory is like at first."""
    (address, content), = file.data
    lines = [", ".join(map(str, content[k : k + 32])) for k in range(0, len(content), 32)]
    return (
        f"enum {{ STACK_TOP = {file.globals[0]}, DATA_AT = {address}, FREE_AT = {file.constants['__heap_base']} }};\n"
        f"static const unsigned char DATA[{len(content)}] = {{\n" + ",\n".join(lines) + "};\n"
    )


def _needs(file, exported):
    """Of each function whether it needs the memory ("m") and the stack ("s"): itself, or what it calls; or as exported."""
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
    variables = [f"{C_TYPES[kind]} l{k} = 0;" for k, kind in enumerate(writer.kinds) if k >= arguments and f"l{k}" in writer.used]
    unused = [f"(void)l{k};" for k in range(arguments) if f"l{k}" not in writer.used]
    unused += [f"(void){name};" for name in needs[place] if not re.search(rf"\b{name}\b", "\n".join(body))]
    return "\n".join([declared, "{", *variables, *unused, *body, "}", ""])


def stack_size(content):
    """Bytes that the stack needs at most: of the deepest of all chains of calls, of which none comes back to itself."""
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
    """Bytes of the stack that a function takes for itself."""
    for (one, _), (two, size), (three, _) in zip(body, body[1:], body[2:], strict=False):
        if (one, two, three) == (GET_STACK, 0x41, 0x6B):
            return size
    assert not any(code in (GET_STACK, SET_STACK) for code, _ in body), "a stack frame of another form"
    return 0
