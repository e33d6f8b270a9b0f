"""The kernels in a WebAssembly engine give the numbers of the native library, to the last bit.

The engine calls the functions of mathematics of the same C library; all else is arithmetic in the same order.
"""

import ctypes
import ctypes.util
import os

import numpy as np
import pytest
import wasmtime

from libraries.test_same_bits import circle_inputs
from scenes import CIRCLE_TETHER, circle
from tetherfmu.kernels.packing import count_of_quantities
from tetherfmu.libraries.webassembly import IMPORTS, browser_file
from tetherfmu.python import models
from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places
from tetherfmu.runtime.inputs import by_name
from tetherfmu.runtime.kernel_library import Kernels
from tetherfmu.runtime.variants import VARIANTS, class_name

pytestmark = pytest.mark.skipif(os.name == "nt", reason="the engine is given the functions of mathematics of a POSIX system")
STEP, STEPS = 0.02, 60
SIZE = 400_000  # bytes
PAGE = 65536
LIBRARY = ctypes.CDLL(ctypes.util.find_library("m"))


class Engine:
    """One WebAssembly file with its memory, and functions of mathematics of the C library.

    Arrays lie in the memory of the engine: each call copies those of the caller there and back.
    """

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


@pytest.fixture(scope="module")
def engine():
    return Engine(browser_file())


def test_size_and_names(engine):
    """Small, and nothing is asked for but a memory and mathematics."""
    assert browser_file().stat().st_size < SIZE
    assert set(engine.imported) <= {"memory", *IMPORTS}
    assert {f"{variant}_{verb}" for variant in VARIANTS for verb in ("pack", "advance", "outputs")} <= engine.exported


def reeling():
    """A circle with reel-out in gusts."""
    return circle_inputs(STEP)[:STEPS], {}


def approaching():
    """As `reeling`, but the tether is taut at first, and the kite comes closer until it is slack."""
    inputs, _ = reeling()
    speed = 20.0
    fallen = speed * STEP * np.arange(STEPS)[:, np.newaxis]
    radial = inputs[:, at.KITE_POSITION : at.KITE_POSITION + 3].copy()
    radial /= np.linalg.norm(radial, axis=1)[:, np.newaxis]
    inputs[:, at.KITE_POSITION : at.KITE_POSITION + 3] -= fallen * radial
    inputs[:, at.KITE_VELOCITY : at.KITE_VELOCITY + 3] -= speed * radial
    return inputs, {"initial_length": 495.0, "initial_shape": "static_equilibrium"}


def lying():
    """A long tether, a part of which lies on the ground."""
    inputs, _ = reeling()
    return inputs, {"initial_length": 620.0, "ground_contact": "flat", "ground_height": -1.0}


def pulling():
    """A drum under force control."""
    inputs, _ = reeling()
    inputs[:, at.REEL_OUT_SPEED], inputs[:, at.WINCH_FORCE] = 0.0, 5000.0
    return inputs, {"initial_length": 495.0, "winch_control": "force", "winch_mass": 500.0, "winch_damping": 20.0}


def flown(model, inputs):
    """Outputs of each step, array (steps, numbers), and a dict of those at the end."""
    columns, found = by_name(inputs), []
    for k in range(len(inputs)):
        told = {name: np.squeeze(column[k])[()] for name, column in columns.items() if np.any(column[k])}
        outputs = model.step(STEP, **told)._asdict()
        found.append(np.concatenate([np.ravel(each) for each in outputs.values()]))
    return np.array(found), outputs


@pytest.mark.parametrize("scene", [reeling, approaching, lying, pulling])
@pytest.mark.parametrize("variant", VARIANTS)
def test_same_bits(engine, variant, scene):
    """Outputs of all steps, and the state at the end."""
    inputs, quantities = scene()
    quantities = {"initial_length": CIRCLE_TETHER.initial_length, **quantities}
    flights, states = [], []
    for kernels in (None, engine.kernels(variant)):
        model = getattr(models, class_name(variant))(kernels=kernels, **quantities)
        model.initialize(*circle(0.0), wind_velocity=(8.0, 1.0, 0.0))
        flights.append(flown(model, inputs))
        states.append(model.get_state())
    (native, last), (other, _) = flights
    assert len(native) == STEPS
    if scene is approaching and variant != "quasi_steady":  # which hangs, taut
        assert last["slack_segments"] > 0
    assert (last["grounded_length"] > 0.0) == (scene is lying and variant != "straight")
    assert native.tobytes() == other.tobytes()
    assert states[0].tobytes() == states[1].tobytes()
