"""The FMI shell: one base slave for every tether. The only module that knows PythonFMU.

What it must never do (docs/fmi.md): let an exception escape, except the guarded one that stops a wrong initialization; log
while it is being made; pass a `%` to the log unescaped.
"""

import sys
from array import array
from contextlib import suppress
from math import isfinite, nan
from pathlib import Path

from pythonfmu import Fmi2Slave
from pythonfmu.default_experiment import DefaultExperiment
from pythonfmu.enums import Fmi2Status

from . import __version__, layout, refusals, saved_state, status, variables
from .instance import OUTPUTS_AT, Instance, zeros
from .kernel_library import load
from .model_description import complete
from .parameters import LOOSEST_TOLERANCE, check_series
from .resources import KERNELS_FOLDER, options_in
from .saved_state import BEFORE, INITIALIZING, STEPPING, TERMINATED, SavedState
from .variants import FREE, effective, library_of
from .workarounds import free_interpreter_once, hold, leave_search_path

_KITE_END = slice(layout.KITE_POSITION, layout.KITE_VELOCITY + 3)  # of a free kite: outputs, at the places of inputs


class TetherSlave(Fmi2Slave):
    """A tether as a PythonFMU slave. A variant is a subclass that sets `variant` and `description`."""

    variant = None
    author = "TetherFMU developers"
    license = "MIT"
    version = __version__

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        if "visible" in kwargs:  # made by PythonFMU's library, not by its builder
            leave_search_path(self.resources)
            free_interpreter_once(self.resources)
        options = options_in(self.resources)
        step = options["step"]
        self.default_experiment = DefaultExperiment(start_time=0.0, stop_time=10.0, step_size=step, tolerance=1e-4)
        self._about = options["about"]
        self._table = variables.table_of(self.variant, options)
        self._parameter_names = variables.names_of(self._table, variables.PARAMETER)
        self._instance = Instance(self._kernels(), options["shape_points"], room=len(self._parameter_names))
        self._make_values()
        self._phase = BEFORE
        self._importer_tolerance = 0.0
        self._time = nan
        self._warned_of_time = False
        self._refusal = None

    def _kernels(self):
        """Load the compiled library now: the folder of the FMU may vanish later. A failure is reported at the start."""
        self._no_kernels = None
        try:
            return load(Path(self.resources or ".") / KERNELS_FOLDER, library_of(self.variant))
        except OSError as error:
            self._no_kernels = str(error)
            return None

    def _make_values(self):
        """One array of all values: inputs, outputs, parameters. The value reference of a variable is its place there."""
        first = {"input": 0, "output": 0, "parameter": self._instance.parameters_at}
        self._references = [first[variable.causality] + variable.place for variable in self._table]
        self._values = self._instance.values
        pairs = list(zip(self._references, self._table, strict=True))
        for reference, variable in pairs:
            if variable.start is not None:
                self._values[reference] = variable.start
        self._reals = frozenset(reference for reference, variable in pairs if variable.kind == "Real")
        self._integers = frozenset(self._references) - self._reals
        self._inputs = frozenset(reference for reference, variable in pairs if variable.causality == "input")
        self._outputs = frozenset(reference for reference, variable in pairs if variable.causality == "output")

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
            problem = refusals.TOLERANCE_NOT_USED.format(tolerance=tolerance, largest=LOOSEST_TOLERANCE)
            self._say(problem, Fmi2Status.warning)

    def enter_initialization_mode(self):
        """From here on outputs are calculated on demand."""
        self._change_phase(BEFORE, INITIALIZING, refusals.CANNOT_BE_ENTERED)

    def exit_initialization_mode(self):
        """Check the parameters and find the first shape; the only place where an exception leaves the slave."""
        if self._phase != INITIALIZING:
            self._refuse(refusals.CANNOT_BE_LEFT.format(phase=refusals.PHASES[self._phase]))
            return
        problem = self._refusal or self._start()
        if problem:
            self._say(problem, Fmi2Status.error)
            hold(self, type(self), self.log_queue)
            raise ValueError(problem.replace("%", "%%"))
        self._phase = STEPPING
        self._warn()

    def do_step(self, current_time, step_size):
        """One communication step. False (fmi2Discard), a message and the state of before if it cannot be done."""
        problem = self._refusal or self._problem_of_time(current_time, step_size) or self._instance.advance(step_size)
        if problem:
            self._refusal = None
            self._say(problem, Fmi2Status.discard)
            return False
        self._read_free_kite()
        self._time = current_time + step_size
        self._warn()
        return True

    def terminate(self):
        """No step can follow, but values can still be read; an instance holds memory only."""
        self._change_phase(STEPPING, TERMINATED, refusals.CANNOT_BE_TERMINATED)

    def _change_phase(self, before, after, refusal):
        if self._phase == before:
            self._phase = after
        else:
            self._refuse(refusal.format(phase=refusals.PHASES[self._phase]))

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

    def get_string(self, vrs):
        """There are no String variables."""
        return [str(value) for value in self._get(vrs, frozenset())]

    def set_boolean(self, vrs, values):
        """There are no Boolean variables, and no String variables."""
        self._set_parameters(vrs, values, frozenset())

    set_string = set_boolean

    def _get(self, vrs, allowed):
        if not allowed.issuperset(vrs):
            unknown = [reference for reference in vrs if reference not in allowed]
            self._refuse(refusals.CANNOT_BE_READ.format(reference=unknown[0]))
            return [0.0 if reference in unknown else self._values[reference] for reference in vrs]
        if self._phase == INITIALIZING and not self._outputs.isdisjoint(vrs):
            problem = self._start()
            if problem:
                self._say(problem, Fmi2Status.warning)
        store = self._values
        return [store[reference] for reference in vrs]

    def _set_parameters(self, vrs, values, allowed):
        for reference, value in zip(vrs, values, strict=True):
            if reference not in allowed or reference in self._outputs:
                self._refuse(refusals.CANNOT_BE_SET.format(reference=reference, value=repr(value)))
            elif reference >= self._instance.parameters_at and self._phase >= STEPPING:
                name = self._parameter_names[reference - self._instance.parameters_at]
                self._refuse(refusals.IS_FIXED.format(name=name, value=value))
            else:
                self._values[reference] = value

    # --- the tether

    def _start(self):
        """Check the parameters, find the first shape. Returns what is wrong, or None."""
        if self._no_kernels:
            return self._no_kernels
        try:
            self._instance.set_up(*self._records(self._values), tolerance=self._importer_tolerance)
        except (ValueError, OverflowError) as error:
            return str(error)
        if self.variant not in FREE:
            return self._instance.start()
        before = self._values[_KITE_END]
        first = self._instance.parameters_at + self._parameter_names.index("initial_kite_position[1]")
        self._values[_KITE_END] = self._values[first : first + len(before)]
        problem = self._instance.start()
        if problem:
            self._values[_KITE_END] = before
        return problem

    def _read_free_kite(self):
        """Outputs of a free kite end, after a step or when a state was set."""
        if self.variant in FREE:
            self._values[_KITE_END] = self._instance.kite_end()

    def _problem_of_time(self, time, step):
        """Why no step can be done now, or None; a communication point where no step ended is reported once."""
        if self._phase != STEPPING:
            return refusals.NO_STEP_NOW.format(phase=refusals.PHASES[self._phase])
        if time == self._time:
            return None
        if not isfinite(time):
            return refusals.TIME_NOT_FINITE.format(time=time)
        if abs(time - self._time) > 1e-3 * abs(step) + 1e-9 * abs(time) and not self._warned_of_time:
            self._warned_of_time = True
            self._say(refusals.TIME_JUMPS.format(time=time, end=self._time), Fmi2Status.warning)
        return None

    def _records(self, values):
        """What `Instance.set_up` wants, from an array of all values; ValueError if one is out of range."""
        numbers = values[self._instance.parameters_at :]
        tether, environment, solver, *kites = variables.records(self.variant, self._table, numbers)
        masses = [(tether.segments, kite.kite_mass) for kite in kites]
        return (effective(tether, self.variant),), environment, solver, masses, (False, bool(kites))

    # --- state

    def _get_fmu_state(self):
        """The whole state as bytes."""
        instance = self._instance
        state = instance.state if self._phase >= STEPPING else array("d")
        facts = self.variant, self._phase, instance.segments, self._importer_tolerance, self._time
        return saved_state.to_bytes(SavedState(*facts, self._values, state))

    def _set_fmu_state(self, blob):
        """Go back to a state, bit for bit. A foreign or damaged one is refused at the next step."""
        before, values = self._get_fmu_state(), self._values[:]
        try:
            self._take(saved_state.from_bytes(blob, self.variant, len(self._values)))
        except ValueError as problem:
            self._take(saved_state.from_bytes(before, self.variant, len(self._values)))
            self._values[:] = values  # also outputs that cannot be computed from what has been set since
            self._refuse(refusals.STATE_REFUSED.format(problem=problem))
            return
        self._refusal = None

    def _take(self, saved):
        """Be as in a `SavedState`; ValueError, half done, if its numbers cannot be used.

        Its outputs are not taken but computed: they follow from the state array.
        """
        for reference, variable in zip(self._references, self._table, strict=True):
            value = saved.values[reference]
            if variable.kind != "Real" and reference not in self._outputs and not abs(value) <= layout.LARGEST_INTEGER:
                problem = refusals.NO_INTEGER.format(name=variable.name, value=value)
                raise ValueError(refusals.STATE_WRONG_PARAMETER.format(problem=problem))
        records = self._records_of_state(saved) if saved.phase >= STEPPING else None
        self._phase, self._importer_tolerance, self._time = saved.phase, saved.tolerance, saved.time
        instance = self._instance
        self._values[:OUTPUTS_AT] = saved.values[:OUTPUTS_AT]
        self._values[OUTPUTS_AT : instance.parameters_at] = zeros(instance.parameters_at - OUTPUTS_AT)
        if self.variant in FREE:
            self._values[_KITE_END] = zeros(_KITE_END.stop - _KITE_END.start)
        self._values[instance.parameters_at :] = saved.values[instance.parameters_at :]
        if records:
            instance.set_up(*records, tolerance=saved.tolerance)
            instance.take(saved.state)
            if instance.observe() != status.OK:
                raise ValueError(refusals.STATE_IMPOSSIBLE)
            self._read_free_kite()

    def _records_of_state(self, saved):
        """Records of the parameters in a saved state; ValueError if they cannot be used with its state array."""
        if self._no_kernels:
            raise ValueError(f"cannot be used: {self._no_kernels}")
        try:
            records = self._records(saved.values)
            check_series(records[0])
        except (ValueError, OverflowError) as error:
            raise ValueError(refusals.STATE_WRONG_PARAMETER.format(problem=error)) from None
        if records[0][0].segments != saved.segments:
            raise ValueError(refusals.STATE_DAMAGED)
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

    def _warn(self):
        """Say what is implausible, each once since the start."""
        for sentence in self._instance.warnings():
            self._say(sentence, Fmi2Status.warning)

    def _say(self, message, level):
        """Log a message; also on stderr, because PythonFMU drops every message unless the importer turns logging on."""
        text = f"{self.instance_name}: {message}"
        self.log(text.replace("%", "%%"), level)
        if sys.stderr is not None:
            with suppress(OSError, ValueError):  # a host may have closed it
                print(text, file=sys.stderr)
