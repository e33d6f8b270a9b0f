"""The FMI shell: one base slave for every tether. The only module that knows PythonFMU.

What it must never do (docs/fmi.md): let an exception escape, except the guarded one that stops a wrong initialization; log
while it is being made; pass a `%` to the log unescaped.
"""

import ctypes
import json
import os
import struct
import sys
import zlib
from array import array
from contextlib import suppress
from functools import lru_cache
from math import isfinite, nan
from pathlib import Path

from pythonfmu import Fmi2Slave
from pythonfmu.default_experiment import DefaultExperiment
from pythonfmu.enums import Fmi2Status

from . import __version__, status, variables
from . import layout as at
from .kernel_library import load
from .model_description import complete
from .parameters import DEFAULT_TOLERANCE, LOOSEST_TOLERANCE, check_series, effective, pack
from .quantities import checked

OPTIONS_FILE = "options.json"
KERNELS_FOLDER = "kernels"
DEFAULT_OPTIONS = {"segments": 20, "shape_points": 21, "about": "", "step": 0.02}

# a saved state: header, facts, all FMI values, and the state array once the tether is initialized
_HEADER = struct.Struct("<8sII")  # magic with version, length and checksum of what follows
_FACTS = struct.Struct("<16sIIdd")  # variant, phase, segments, the importer's tolerance, time
_MAGIC = b"tether02"
_BEFORE, _INITIALIZING, _STEPPING, _TERMINATED = range(4)
_PHASES = ("before the initialization", "in initialization mode", "after the initialization", "after the termination")


def hold_globals(module_globals):
    """Keep the globals of the launcher script alive: PythonFMU gives one of their references away per instance."""
    ctypes.pythonapi.Py_IncRef(ctypes.py_object(module_globals))


@lru_cache
def _options(resources):
    """Build options in the resources of an FMU, read once: its folder may vanish while instances live."""
    file = Path(resources or ".") / OPTIONS_FILE
    return DEFAULT_OPTIONS | (json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {})


@lru_cache
def _free_interpreter_once(resources):
    """Let a Linux process end cleanly with PythonFMU's library loaded.

    At the exit the library frees its interpreter state in a static destructor and then again in its unload function. An exit
    handler registered now runs before both and takes the state away. glibc never unloads the library, because it has unique
    symbols; `RTLD_NODELETE` says so for others, so that the handler stays valid.
    """
    if sys.platform != "linux":
        return
    for path in Path(resources).parent.glob("binaries/linux64/*.so"):
        with suppress(OSError, AttributeError):  # not loaded from there, or a C library of another kind
            library = ctypes.CDLL(str(path), mode=os.RTLD_NOW | os.RTLD_NOLOAD | os.RTLD_NODELETE)
            handler = ctypes.cast(library.finalizePythonInterpreter, ctypes.c_void_p)
            ctypes.CDLL(None).__cxa_atexit(handler, None, None)


class TetherSlave(Fmi2Slave):
    """A tether as a PythonFMU slave. A variant is a subclass that sets `variant` and `description`."""

    variant = None
    author = "TetherFMU developers"
    license = "MIT"
    version = __version__

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        if "visible" in kwargs:  # made by PythonFMU's library, not by its builder
            with suppress(ValueError):
                sys.path.remove(self.resources)  # the library puts it there for each instance and leaves it
            _free_interpreter_once(self.resources)
        options = _options(self.resources)
        step = options["step"]
        self.default_experiment = DefaultExperiment(start_time=0.0, stop_time=10.0, step_size=step, tolerance=1e-4)
        self._about = options["about"]
        self._shape_points = options["shape_points"]
        self._load_kernels()
        self._table = variables.table_of(self.variant, options)
        self._make_values()
        self._phase = _BEFORE
        self._importer_tolerance = 0.0
        self._time = nan
        self._time_was_told = False
        self._refusal = None
        self._segments = 0
        self._state = array("d")

    def _load_kernels(self):
        """Load the compiled library now, so that the folder of the FMU may vanish later; a failure is told at the start."""
        self._kernels = None
        self._no_kernels = None
        try:
            self._kernels = load(Path(self.resources or ".") / KERNELS_FOLDER, self.variant)
        except OSError as error:
            self._no_kernels = str(error)

    def _make_values(self):
        """One array of all values: inputs, outputs, parameters. The value reference of a variable is its place there."""
        self._outputs_at = at.INPUTS
        self._parameters_at = at.INPUTS + at.outputs_size(self._shape_points)
        first = {"input": 0, "output": self._outputs_at, "parameter": self._parameters_at}
        self._references = [first[variable.causality] + variable.place for variable in self._table]
        self._values = array("d", bytes(8 * (self._parameters_at + len(variables.parameter_names()))))
        for reference, variable in zip(self._references, self._table, strict=True):
            if variable.start is not None:
                self._values[reference] = variable.start
        pairs = list(zip(self._references, self._table, strict=True))
        self._reals = frozenset(reference for reference, variable in pairs if variable.kind == "Real")
        self._integers = frozenset(self._references) - self._reals
        self._inputs = frozenset(reference for reference, variable in pairs if variable.causality == "input")
        self._outputs = frozenset(reference for reference, variable in pairs if variable.causality == "output")
        self._address = self._values.buffer_info()[0]

    # --- model description

    def to_xml(self, model_options=None):
        """Model description of PythonFMU, completed with units, limits, enumerations and dependencies."""
        options = {"canGetAndSetFMUstate": True, "canSerializeFMUstate": True, **(model_options or {})}
        root = super().to_xml(options)
        root.set("generationTool", f"TetherFMU {__version__} with {root.get('generationTool')}")
        if self._about:
            root.set("description", f"{self.__class__.description} {self._about}")
        complete(root, self._table, self._references)
        return root

    # --- life cycle

    def setup_experiment(self, start_time, stop_time, tolerance):
        """Remember the importer's tolerance; one that the solver cannot use is left out with a warning."""
        if tolerance is None:
            return
        if 0.0 < tolerance <= LOOSEST_TOLERANCE:
            self._importer_tolerance = tolerance
        else:
            self._say(
                f"the importer's tolerance {tolerance} is not used; allowed is up to {LOOSEST_TOLERANCE}",
                Fmi2Status.warning,
            )

    def enter_initialization_mode(self):
        """From here on outputs are calculated on demand."""
        if self._phase == _BEFORE:
            self._phase = _INITIALIZING
        else:
            self._refuse(f"initialization mode cannot be entered {_PHASES[self._phase]}")

    def exit_initialization_mode(self):
        """Check the parameters and find the first shape; the only place where an exception leaves the slave."""
        if self._phase != _INITIALIZING:
            self._refuse(f"initialization mode cannot be left {_PHASES[self._phase]}")
            return
        problem = self._refusal or self._start()
        if problem:
            self._say(problem, Fmi2Status.error)
            for kept in (self, type(self), self.log_queue):
                ctypes.pythonapi.Py_IncRef(ctypes.py_object(kept))
            raise ValueError(problem.replace("%", "%%"))
        self._phase = _STEPPING

    def do_step(self, current_time, step_size):
        """One communication step. False (fmi2Discard), a message and the state of before if it cannot be done."""
        problem = self._refusal or self._problem_of_time(current_time, step_size) or self._advance(step_size)
        if problem:
            self._refusal = None
            self._say(problem, Fmi2Status.discard)
            return False
        self._time = current_time + step_size
        return True

    def terminate(self):
        """No step can follow, but values can still be read; an instance holds memory only."""
        if self._phase == _STEPPING:
            self._phase = _TERMINATED
        else:
            self._refuse(f"the tether cannot be terminated {_PHASES[self._phase]}")

    # --- values

    def get_real(self, vrs):
        """Values of Real variables."""
        return self._get(vrs, self._reals)

    def set_real(self, vrs, values):
        """Store values of Real variables; they are checked when they are used."""
        if self._inputs.issuperset(vrs):
            store = self._values
            for reference, value in zip(vrs, values, strict=True):
                store[reference] = value
        else:
            self._set_parameters(vrs, values, self._reals)

    def get_integer(self, vrs):
        """Values of Integer and Enumeration variables."""
        return [int(value) for value in self._get(vrs, self._integers)]

    def set_integer(self, vrs, values):
        """Store values of Integer and Enumeration parameters; they are checked when initialization ends."""
        self._set_parameters(vrs, values, self._integers)

    def get_boolean(self, vrs):
        """There are no Boolean variables."""
        return [bool(value) for value in self._get(vrs, frozenset())]

    def set_boolean(self, vrs, values):
        """There are no Boolean variables."""
        self._set_parameters(vrs, values, frozenset())

    def get_string(self, vrs):
        """There are no String variables."""
        return [str(value) for value in self._get(vrs, frozenset())]

    def set_string(self, vrs, values):
        """There are no String variables."""
        self._set_parameters(vrs, values, frozenset())

    def _get(self, vrs, allowed):
        if not allowed.issuperset(vrs):
            unknown = [reference for reference in vrs if reference not in allowed]
            self._refuse(f"value references {unknown} cannot be read: they are no variables of this type")
            return [0.0 if reference in unknown else self._values[reference] for reference in vrs]
        if self._phase == _INITIALIZING and not self._outputs.isdisjoint(vrs):
            problem = self._start()
            if problem:
                self._say(problem, Fmi2Status.warning)
        store = self._values
        return [store[reference] for reference in vrs]

    def _set_parameters(self, vrs, values, allowed):
        for reference, value in zip(vrs, values, strict=True):
            if reference not in allowed or reference in self._outputs:
                self._refuse(
                    f"value reference {reference} cannot be set to {value!r}: it is no input or parameter of this type"
                )
            elif reference >= self._parameters_at and self._phase >= _STEPPING:
                name = variables.parameter_names()[reference - self._parameters_at]
                self._refuse(f"{name} cannot be set to {value!r} now; it is fixed when the initialization ends")
            else:
                self._values[reference] = value

    # --- the tether

    def _start(self):
        """Check the parameters, make the arrays, find the first shape. Returns what is wrong, or None."""
        if self._no_kernels:
            return self._no_kernels
        try:
            self._allocate(*self._records(self._values))
        except (ValueError, OverflowError) as error:
            return str(error)
        result = self._kernels.initialize(
            self._segments, self._parameters_address, self._address, self._state_address, self._work_address
        )
        if result == status.OK:
            result = self._observe()
        return None if result == status.OK else self._sentence(result, 0.0)

    def _advance(self, step):
        """Do a communication step of `step` [s], or keep the state. Returns what is wrong, or None."""
        self._before[:] = self._state
        result = self._kernels.advance(
            self._segments, self._parameters_address, self._address, step, self._state_address, self._work_address
        )
        if result == status.OK:
            result = self._observe()
            if result == status.OK:
                return None
            problem = self._sentence(result, step)
            self._state[:] = self._before
            self._observe()
            return problem
        return self._sentence(result, step)

    def _problem_of_time(self, time, step):
        """Why no step can be done now, or None; a communication point where no step ended is told once."""
        if self._phase != _STEPPING:
            return f"a step cannot be done {_PHASES[self._phase]}"
        if time == self._time:
            return None
        if not isfinite(time):
            return f"the communication point is {time}; it must be a finite number"
        if abs(time - self._time) > 1e-3 * abs(step) + 1e-9 * abs(time) and not self._time_was_told:
            self._time_was_told = True
            self._say(
                f"the communication point is {time} s, the last step ended at {self._time} s; the tether goes on from there",
                Fmi2Status.warning,
            )
        return None

    def _records(self, values):
        """Records of the parameters in an array of all values; ValueError if one is out of range."""
        parameters = dict(zip(variables.parameter_names(), values[self._parameters_at :], strict=True))
        for variable in self._table:
            if variable.causality == "parameter":
                checked(variable.name, parameters[variable.name], variable.quantity)
                if variable.kind != "Real":
                    parameters[variable.name] = int(parameters[variable.name])
        tether, environment, solver = variables.records(parameters)
        return effective(tether, self.variant), environment, solver

    def _allocate(self, tether, environment, solver):
        """Arrays for the parameters, the state and the work; ValueError if the segments are too short."""
        self._tolerance = solver.relative_tolerance or self._importer_tolerance or DEFAULT_TOLERANCE
        self._parameters = pack((tether,), environment, solver, self._tolerance)
        if self._segments != tether.segments:
            self._state = array("d", bytes(8 * at.state_size(tether.segments)))
            self._before = array("d", self._state)
            self._work = array("d", bytes(8 * at.work_size(tether.segments)))
        self._segments = tether.segments
        self._fixed_step = solver.fixed_step
        self._parameters_address = self._parameters.buffer_info()[0]
        self._state_address = self._state.buffer_info()[0]
        self._work_address = self._work.buffer_info()[0]

    def _observe(self):
        return self._kernels.observe(
            self._segments,
            self._parameters_address,
            self._state_address,
            self._shape_points,
            self._address + 8 * self._outputs_at,
            self._work_address,
        )

    def _sentence(self, result, step):
        place = status.index(result)
        return status.sentence(
            result,
            name=variables.INPUT_NAMES.get(place, ""),
            value=self._values[place],
            step=step,
            reel_out_speed=self._values[at.REEL_OUT_SPEED],
            length=self._state[at.LENGTH],
            relative_tolerance=self._tolerance,
            fixed_step=self._fixed_step,
            budget=at.WORK_BUDGET // self._segments,
        )

    # --- state

    def _get_fmu_state(self):
        """The whole state as bytes: all FMI values and, once initialized, the state array."""
        facts = (self.variant.encode(), self._phase, self._segments, self._importer_tolerance, self._time)
        body = _FACTS.pack(*facts) + self._values.tobytes()
        if self._phase >= _STEPPING:
            body += self._state.tobytes()
        return _HEADER.pack(_MAGIC, len(body), zlib.crc32(body)) + body

    def _set_fmu_state(self, blob):
        """Go back to a state, bit for bit. A foreign or damaged one is refused at the next step."""
        try:
            phase, tolerance, time, values, state, records = self._read(blob)
        except ValueError as problem:
            self._refuse(f"the FMU state that was set {problem}; the state of before is kept")
            return
        self._importer_tolerance = tolerance
        self._time = time
        self._values[:] = values
        self._phase = phase
        self._refusal = None
        if phase >= _STEPPING:
            self._allocate(*records)
            self._state[:] = state

    def _read(self, blob):
        """Phase, tolerance, time, values, state array and records of a saved state; ValueError says what is wrong."""
        smallest = _HEADER.size + _FACTS.size
        if not isinstance(blob, bytes) or len(blob) < smallest or not blob.startswith(_MAGIC):
            raise ValueError("is no state of a tether, or of another version")
        _, length, checksum = _HEADER.unpack_from(blob)
        if length != len(blob) - _HEADER.size or zlib.crc32(blob[_HEADER.size :]) != checksum:
            raise ValueError("is damaged")
        variant, phase, segments, tolerance, time = _FACTS.unpack_from(blob, _HEADER.size)
        count = len(self._values) + (at.state_size(segments) if phase >= _STEPPING else 0)
        if variant.rstrip(b"\0") != self.variant.encode() or phase > _TERMINATED or len(blob) != smallest + 8 * count:
            raise ValueError("belongs to another tether FMU")
        numbers = array("d", blob[smallest:])
        values, state = numbers[: len(self._values)], numbers[len(self._values) :]
        return phase, tolerance, time, values, state, self._records_of_state(values, state) if phase >= _STEPPING else None

    def _records_of_state(self, values, state):
        """Records of the parameters in a saved state; ValueError if they cannot be used with its state array."""
        try:
            records = self._records(values)
            check_series(records[:1])
        except (ValueError, OverflowError) as error:
            raise ValueError(f"has a wrong parameter ({error})") from None
        if at.state_size(records[0].segments) != len(state):
            raise ValueError("is damaged")
        return records

    @staticmethod
    def _fmu_state_to_bytes(state):
        return state

    @staticmethod
    def _fmu_state_from_bytes(state):
        return bytes(state)

    # --- messages

    def _refuse(self, message):
        """Remember why the next step cannot be done, and say it now."""
        self._refusal = message
        self._say(message, Fmi2Status.error)

    def _say(self, message, level):
        """Log a message; also on stderr, because PythonFMU drops every message unless the importer turns logging on."""
        text = f"{self.instance_name}: {message}"
        self.log(text.replace("%", "%%"), level)
        if sys.stderr is not None:
            with suppress(OSError, ValueError):  # a host may have closed it
                print(text, file=sys.stderr)
