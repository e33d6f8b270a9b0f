"""Kernels in a WebAssembly engine, as `kernel_library.Kernels` that a `TetherModel` flies with.

Their arrays lie in the memory of the engine: each call copies those of the caller there and back.
"""

import ctypes
import ctypes.util

import wasmtime

from tetherfmu.kernels.packing import count_of_quantities
from tetherfmu.libraries.webassembly import IMPORTS
from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places
from tetherfmu.runtime.kernel_library import Kernels

PAGE = 65536
LIBRARY = ctypes.CDLL(ctypes.util.find_library("m"))


class Engine:
    """One WebAssembly file with its memory, and functions of mathematics of the C library."""

    def __init__(self, path):
        engine = wasmtime.Engine()
        self.store = wasmtime.Store(engine)
        module = wasmtime.Module.from_file(engine, str(path))
        self.imported = [each.name for each in module.imports]
        self.exported = {each.name for each in module.exports}
        self.memory = wasmtime.Memory(self.store, wasmtime.MemoryType(wasmtime.Limits(200, None)))
        given = [self.memory if each.name == "memory" else self._mathematics(each) for each in module.imports]
        self.exports = wasmtime.Instance(self.store, module, given).exports(self.store)
        self.free = self.exports["__heap_base"].value(self.store) + 16

    def _mathematics(self, imported):
        """A function of the C library."""
        assert imported.name in IMPORTS
        function = getattr(LIBRARY, imported.name)
        function.restype = ctypes.c_double
        function.argtypes = [ctypes.c_double] * len(imported.type.params)
        return wasmtime.Func(self.store, imported.type, function)

    def kernels(self, variant):
        """`Kernels` of a variant."""
        found = {verb: f"{variant}_{verb}" for verb in Kernels._fields}
        calls = {verb: self._call(verb, name) for verb, name in found.items() if name in self.exported}
        return Kernels(**{**dict.fromkeys(Kernels._fields), **calls})

    def _call(self, verb, name):
        """One entry point, of numbers and addresses of the caller's arrays."""
        function = self.exports[name]

        def call(*arguments):
            sizes, given, place = self._sizes(verb, name, arguments), list(arguments), self.free
            arrays = []
            for k, size in sizes.items():
                arrays.append((arguments[k], place, 8 * size))
                self.memory.write(self.store, ctypes.string_at(arguments[k], 8 * size), place)
                given[k] = place
                place += 8 * size + 8 * (size % 2)
            result = function(self.store, *given)
            for origin, copied, length in arrays:
                ctypes.memmove(origin, bytes(self.memory.read(self.store, copied, copied + length)), length)
            return result

        return call

    def _sizes(self, verb, name, arguments):
        """Length of each array by its place among the arguments."""
        if verb == "segments":
            return {1: count_of_quantities(arguments[0], 0)}
        if verb == "pack":
            tethers, kites = arguments[:2]
            quantities = {2: count_of_quantities(tethers, kites)}
            segments = self._packed_segments(name, arguments)
            return {**quantities, 4: at.parameters_size(segments)}
        size = places.plan_size(1)
        plan = (ctypes.c_int64 * size).from_address(arguments[0])
        if verb == "complete":
            return {0: size}
        names = ("PARAMETERS", "INPUTS", "STATE", "OUTPUTS", "WORK")
        parameters, inputs, state, outputs, work = (plan[getattr(places, f"{each}_SIZE")] for each in names)
        first = {0: size, 1: parameters, 2: inputs}
        n = plan[places.PLAN_HEADER + places.SEGMENTS]
        if verb in ("initialize", "outputs"):
            return {**first, 3: state, 4: outputs, 5: work}
        if verb == "advance":
            return {**first, 4: state, 5: state, 6: outputs, 7: work}
        steps, every, when = (arguments[k] for k in (3, 5, 6))
        width = 6 * (n + 1) + (outputs + 1 if when != at.NEVER else 0)
        rows = width * (steps // every + 1 if every else 1)
        return {**first, 2: inputs * steps, 7: state, 8: state, 9: rows, 10: work}

    def _packed_segments(self, name, arguments):
        """Number of segments of these quantities."""
        tethers, _, quantities = arguments[:3]
        size = 8 * count_of_quantities(tethers, 0)
        self.memory.write(self.store, ctypes.string_at(quantities, size), self.free)
        return self.exports[name.replace("_pack", "_segments")](self.store, tethers, self.free)
