"""Translates a function of a WebAssembly file to C statements.

The stack of the file becomes expressions: a value is written where it is used, or stored in a variable before an operand
changes. Blocks become labels.
"""

import re
from typing import NamedTuple

from . import c_operations as wasm

LONGEST = 140  # characters of an expression; a longer one is stored in a variable


class Value(NamedTuple):
    """An expression on the stack of the file."""

    text: str
    kind: str
    variables: frozenset = frozenset()  # that it reads, and that may change
    reads_memory: bool = False


class Label(NamedTuple):
    """Target of a branch."""

    name: str
    code: int  # BLOCK, LOOP or IF
    height: int  # of the stack


class Writer:
    """The text of one function."""

    def __init__(self, file, function, needs, names):
        self.file, self.function, self.needs, self.names_of_functions = file, function, needs, names
        self.kinds = (*function.signature.arguments, *function.variables)
        self.lines, self.stack, self.labels = [], [], []
        self.names, self.used = 0, set()  # names in use; labels and variables that occur

    def fresh(self, letter):
        """A name that nothing has yet."""
        self.names += 1
        return f"{letter}{self.names}"

    def push(self, text, kind, variables=frozenset(), reads_memory=False):
        """Push a value onto the stack; a long expression is stored in a variable."""
        self.stack.append(Value(text, kind, variables, reads_memory))
        if len(text) > LONGEST:
            self.name(len(self.stack) - 1)

    def name(self, place):
        """Give a value of the stack a name, so that nothing can change it."""
        value = self.stack[place]
        name = self.fresh("t")
        self.lines.append(f"const {wasm.C_TYPES[value.kind]} {name} = {value.text};")
        self.stack[place] = Value(name, value.kind)

    def keep(self, wanted):
        """Give names to those values of the stack that are wanted."""
        for place, value in enumerate(self.stack):
            if wanted(value):
                self.name(place)

    def set(self, variable, text):
        """Give a variable a value; expressions on the stack that read the old one get names first."""
        self.keep(lambda value: variable in value.variables)
        self.used.add(variable)
        if text != variable:
            self.lines.append(f"{variable} = {text};")

    def pop(self, count):
        """Take values off the stack: their expressions, the variables that they read, whether they read the memory."""
        taken = self.stack[len(self.stack) - count :]
        del self.stack[len(self.stack) - count :]
        variables = frozenset().union(*(value.variables for value in taken))
        return [value.text for value in taken], variables, any(value.reads_memory for value in taken)

    def place(self, text, operand, size):
        """Expression of a place in the memory, for a number of this many bytes."""
        offset, aligned = operand
        assert aligned == size, "a number at no multiple of its size"
        return f"m + {text} + {offset}" if offset else f"m + {text}"

    def goto(self, depth):
        """Statement that leaves this number of blocks."""
        if depth == len(self.labels):
            return self.leave()
        label = self.labels[-1 - depth]
        self.used.add(label.name)
        return f"goto {label.name};"

    def leave(self):
        """Statement that leaves the function."""
        return f"return {self.stack[-1].text};" if self.function.signature.results else "return;"

    def write(self):
        """Lines of the body."""
        dead = 0  # open blocks after an unconditional branch
        skipping = False
        for code, operand in self.function.body:
            if skipping:
                if code in (wasm.BLOCK, wasm.LOOP, wasm.IF):
                    dead += 1
                    continue
                if dead or code not in (wasm.ELSE, wasm.END):
                    dead -= code == wasm.END
                    continue
                skipping = False
            skipping = self.instruction(code, operand)
        labels = re.compile(r"(L\d+):;")
        named = (labels.fullmatch(line) for line in self.lines)
        return [line for line, label in zip(self.lines, named, strict=True) if not label or label[1] in self.used]

    def instruction(self, code, operand):
        """Write one instruction; returns whether the next one is unreachable."""
        if code in wasm.OPERATIONS:
            kind, template = wasm.OPERATIONS[code]
            texts, variables, reads = self.pop(2 if "{1}" in template else 1)
            self.push(template.format(*texts), kind, variables, reads)
        elif code in wasm.CONSTANTS:
            self.push(wasm.number(wasm.CONSTANTS[code], operand), wasm.CONSTANTS[code])
        elif code in (wasm.GET, wasm.SET, wasm.TEE):
            self.variable(code, f"l{operand}", self.kinds[operand])
        elif code in (wasm.GET_STACK, wasm.SET_STACK):
            assert operand == 0, "a second global"
            self.variable(wasm.GET if code == wasm.GET_STACK else wasm.SET, "s", "i32")
        elif code in wasm.LOADS:
            (text,), variables, _ = self.pop(1)
            function, kind, size = wasm.LOADS[code]
            self.push(f"{function}({self.place(text, operand, size)})", kind, variables, True)
        elif code in wasm.STORES:
            (address, value), *_ = self.pop(2)
            self.keep(lambda value: value.reads_memory)
            function, size = wasm.STORES[code]
            self.lines.append(f"{function}({self.place(address, operand, size)}, {value});")
        elif code in (wasm.COPY, wasm.FILL):
            self.bulk(code)
        elif code == wasm.SELECT:
            kind = self.stack[-2].kind
            (a, b, condition), variables, reads = self.pop(3)
            self.push(f"({condition} ? {a} : {b})", kind, variables, reads)
        elif code == wasm.CALL:
            self.call(operand)
        elif code == wasm.DROP:
            self.stack.pop()
        else:
            return self.control(code, operand)
        return False

    def variable(self, code, name, kind):
        """Write an instruction on a variable."""
        if code == wasm.GET:
            self.used.add(name)
            self.push(name, kind, frozenset({name}))
            return
        (text,), *_ = self.pop(1)
        self.set(name, text)
        if code == wasm.TEE:
            self.push(name, kind, frozenset({name}))

    def bulk(self, code):
        """Write an instruction on many bytes."""
        (target, source, count), *_ = self.pop(3)
        self.keep(lambda value: value.reads_memory)
        if code == wasm.FILL:
            self.lines.append(f"memset(m + {target}, (int){source}, {count});")
        else:
            self.lines.append(f"memmove(m + {target}, m + {source}, {count});")

    def call(self, called_number):
        """Write the call of a function."""
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
        self.lines.append(f"const {wasm.C_TYPES[signature.results[0]]} {name} = {text};")
        self.push(name, signature.results[0])

    def control(self, code, operand):
        """As `instruction`, for branches."""
        if code in (wasm.BLOCK, wasm.LOOP, wasm.IF):
            self.open(code, operand)
        elif code == wasm.ELSE:
            self.lines.append("} else {")
        elif code == wasm.END:
            self.close()
        elif code == wasm.BRANCH_IF:
            (condition,), *_ = self.pop(1)
            self.lines.append(f"if ({condition}) {self.goto(operand)}")
        elif code == wasm.BRANCHES:
            (chosen,), *_ = self.pop(1)
            *cases, default = map(self.goto, operand)
            self.lines += [f"switch ({chosen}) {{", *(f"case {place}: {case}" for place, case in enumerate(cases))]
            self.lines += [f"default: {default}", "}"]
        elif code in (wasm.BRANCH, wasm.RETURN):
            self.lines.append(self.goto(operand) if code == wasm.BRANCH else self.leave())
        elif code == wasm.UNREACHABLE:
            self.lines.append("return 0;" if self.function.signature.results else "return;")
        else:
            raise ValueError(f"WebAssembly's instruction {code} is not known")
        return code in (wasm.BRANCH, wasm.BRANCHES, wasm.RETURN, wasm.UNREACHABLE)

    def open(self, code, kind):
        """Begin a block."""
        assert kind is None, "a block with a result"
        condition = self.pop(1)[0][0] if code == wasm.IF else ""
        self.keep(lambda value: value.variables or value.reads_memory)  # variable values
        label = Label(self.fresh("L"), code, len(self.stack))
        self.labels.append(label)
        if code == wasm.LOOP:
            self.lines.append(f"{label.name}:;")
        if code == wasm.IF:
            self.lines.append(f"if ({condition}) {{")

    def close(self):
        """End a block, or the function."""
        if not self.labels:
            if self.stack:
                self.lines.append(self.leave())
            return
        label = self.labels.pop()
        del self.stack[label.height :]
        if label.code == wasm.IF:
            self.lines.append("}")
        if label.code != wasm.LOOP:
            self.lines.append(f"{label.name}:;")
