"""The FMI shell that all slaves share: table of variables, phases, messages. The only module that uses PythonFMU.

It must never (docs/contributors/fmus.md): let an exception escape, except the guarded one that stops a wrong
initialization; log during its construction; pass a `%` to the log unescaped.
"""

import sys
from contextlib import suppress
from math import isfinite, nan

from pythonfmu import Fmi2Slave
from pythonfmu.default_experiment import DefaultExperiment
from pythonfmu.enums import Fmi2Status

from ..runtime import __version__, refusals
from ..runtime.parameters import DEFAULT_TOLERANCE
from ..runtime.saved_state import BEFORE, INITIALIZING, STEPPING, TERMINATED
from ..wiring.variables import CALCULATED, INPUT
from .model_description import complete
from .workarounds import free_interpreter_once, hold, leave_search_path

NO_INTEGER = -(2**31)  # read value of an Integer variable without a value, like NaN for a Real one
WARNING, DISCARD, ERROR = Fmi2Status.warning, Fmi2Status.discard, Fmi2Status.error


class BaseSlave(Fmi2Slave):
    """A PythonFMU slave with a table of variables and one array of all their values.

    A subclass calls `declare` when it is created, and has
    start() : check the parameters, compute the first outputs; returns the problem, or None.
    advance(step) : one communication step [s]; returns the problem, with no change, or None.
    state_to_bytes(), state_from_bytes(blob) : the whole state, bit for bit, and back; ValueError, with no change, for
    invalid bytes.
    """

    author = "TetherFMU developers"
    license = "MIT"
    version = __version__

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        if "visible" in kwargs:  # made by PythonFMU's library, not by its builder
            leave_search_path(self.resources)
            free_interpreter_once(self.resources)
        self.phase = BEFORE
        self.time = nan
        self._warned_of_time = False
        self._refusal = None

    def declare(self, table, values, options):
        """Take a table of `variables.Variable`, the array of values, where their start values are put, and build options."""
        usual = {"start_time": 0.0, "stop_time": options["stop"], "step_size": options["step"]}
        self.default_experiment = DefaultExperiment(**usual, tolerance=DEFAULT_TOLERANCE)
        self.table, self.values = table, values
        self._by_reference = {variable.place: variable for variable in table}
        for reference, variable in self._by_reference.items():
            if variable.start is not None:
                values[reference] = variable.start
        self._reals = self._all(lambda variable: variable.kind == "Real")
        self._booleans = self._all(lambda variable: variable.kind == "Boolean")
        self._integers = frozenset(self._by_reference) - self._reals - self._booleans
        self._inputs = self._all(lambda variable: variable.causality == INPUT)
        self.output_places = self._all(lambda variable: variable.causality in CALCULATED)

    def _all(self, chosen):
        return frozenset(reference for reference, variable in self._by_reference.items() if chosen(variable))

    constants = ()  # triples as in `wiring.Wiring`

    def warnings(self):
        """Sentences on implausible behaviour, each once since the start."""
        return ()

    # --- model description

    def to_xml(self, model_options=None):
        """Model description of PythonFMU, completed with units, limits, enumerations and dependencies."""
        options = {"canGetAndSetFMUstate": True, "canSerializeFMUstate": True, **(model_options or {})}
        root = super().to_xml(options)
        root.set("generationTool", f"TetherFMU {__version__} with {root.get('generationTool')}")
        complete(root, self.table, self.constants)
        return root

    # --- life cycle

    def setup_experiment(self, start_time, stop_time, tolerance):
        """Refuse invalid or late settings; subclasses handle a tolerance."""
        if self.phase != BEFORE:
            self.refuse(refusals.CANNOT_BE_SET_UP.format(phase=refusals.PHASES[self.phase]))
        elif not isfinite(start_time):
            self.refuse(refusals.START_NOT_FINITE.format(start=start_time))
        elif stop_time is not None and not stop_time >= start_time:
            self.refuse(refusals.STOP_BEFORE_START.format(stop=stop_time, start=start_time))
        elif tolerance is not None:
            self.take_tolerance(tolerance)

    def take_tolerance(self, tolerance):
        """Remember the importer's tolerance; no-op if it has no use."""

    def enter_initialization_mode(self):
        """From here on outputs are calculated on demand."""
        self._change_phase(BEFORE, INITIALIZING, refusals.CANNOT_BE_ENTERED)

    def exit_initialization_mode(self):
        """Check the parameters and compute the first outputs; the only place where an exception leaves the slave."""
        if self.phase != INITIALIZING:
            self.refuse(refusals.CANNOT_BE_LEFT.format(phase=refusals.PHASES[self.phase]))
            return
        problem = self._refusal or self.start()
        if problem:
            self.say(problem, ERROR)
            hold(self, type(self), self.log_queue)
            raise ValueError(problem.replace("%", "%%"))
        self.phase = STEPPING
        self._warn()

    def do_step(self, current_time, step_size):
        """One communication step. False (fmi2Discard), a message and the previous state if it cannot be done."""
        problem = self._refusal or self._problem_of_time(current_time, step_size)
        if not problem and (refused := self.advance(step_size)):
            problem = refusals.STEP_REFUSED.format(time=current_time, problem=refused)
        if problem:
            self._refusal = None
            self.say(problem, DISCARD)
            return False
        self.time = current_time + step_size
        self._warn()
        return True

    def terminate(self):
        """No step can follow, but values can still be read; an instance owns memory only."""
        self._change_phase(STEPPING, TERMINATED, refusals.CANNOT_BE_TERMINATED)

    def _change_phase(self, before, after, refusal):
        if self.phase == before:
            self.phase = after
        else:
            self.refuse(refusal.format(phase=refusals.PHASES[self.phase]))

    def _problem_of_time(self, time, step):
        """Why no step can be done now, or None; a communication point where no step ended is reported once."""
        if self.phase != STEPPING:
            return refusals.NO_STEP_NOW.format(phase=refusals.PHASES[self.phase])
        if time == self.time:
            return None
        if not isfinite(time):
            return refusals.TIME_NOT_FINITE.format(time=time)
        allowed = refusals.JUMP_OF_STEP * abs(step) + refusals.JUMP_OF_TIME * abs(time)
        if abs(time - self.time) > allowed and not self._warned_of_time:
            self._warned_of_time = True
            self.say(refusals.TIME_JUMPS.format(time=time, end=self.time), WARNING)
        return None

    # --- values

    def get_real(self, vrs):
        """Values of Real variables."""
        return self._get(vrs, self._reals)

    def set_real(self, vrs, values):
        """Store values of Real variables; they are checked when they are used."""
        if self._inputs.issuperset(vrs) and self.phase != TERMINATED:
            store = self.values
            for reference, value in zip(vrs, values, strict=True):
                store[reference] = value
        else:
            self._set_parameters(vrs, values, self._reals)

    def get_integer(self, vrs):
        """Values of Integer and Enumeration variables."""
        return [int(value) if isfinite(value) else NO_INTEGER for value in self._get(vrs, self._integers)]

    def set_integer(self, vrs, values):
        """Store values of Integer and Enumeration parameters; they are checked when initialization ends."""
        self._set_parameters(vrs, values, self._integers)

    def get_boolean(self, vrs):
        """Values of Boolean variables."""
        return [value == value and value != 0.0 for value in self._get(vrs, self._booleans)]

    def get_string(self, vrs):
        """There are no String variables: empty texts, since PythonFMU's library cannot pass NULL on."""
        return ["" for _ in self._get(vrs, frozenset())]

    def set_boolean(self, vrs, values):
        """Store values of Boolean inputs."""
        self._set_parameters(vrs, [float(bool(value)) for value in values], self._booleans)

    def set_string(self, vrs, values):
        """There are no String variables."""
        self._set_parameters(vrs, values, frozenset())

    def _get(self, vrs, allowed):
        """Values of allowed references, NaN on failure: PythonFMU's library has no status for importers."""
        if not allowed.issuperset(vrs):
            unknown = next(reference for reference in vrs if reference not in allowed)
            self.refuse(refusals.CANNOT_BE_READ.format(reference=unknown, name=self.name_of(unknown)))
            return [nan] * len(vrs)
        if self.phase == INITIALIZING and not self.output_places.isdisjoint(vrs):
            problem = self.start()
            if problem:
                self.say(problem, ERROR)
                return [nan] * len(vrs)
        store = self.values
        return [store[reference] for reference in vrs]

    def _set_parameters(self, vrs, values, allowed):
        for reference, value in zip(vrs, values, strict=True):
            if reference not in allowed or reference in self.output_places:
                name = self.name_of(reference)
                self.refuse(refusals.CANNOT_BE_SET.format(reference=reference, name=name, value=repr(value)))
            elif reference not in self._inputs and self.phase >= STEPPING:
                self.refuse(refusals.IS_FIXED.format(name=self.name_of(reference), value=value))
            elif self.phase == TERMINATED:
                self.refuse(refusals.NOT_AFTER_THE_END.format(name=self.name_of(reference), value=value))
            else:
                self.values[reference] = value

    def name_of(self, reference):
        """Name of the variable of a value reference, for messages."""
        known = self._by_reference.get(reference)
        return known.name if known else refusals.UNKNOWN_VARIABLE

    # --- state

    def _get_fmu_state(self):
        """The whole state as bytes."""
        return self.state_to_bytes()

    def _set_fmu_state(self, blob):
        """Go back to a state, bit for bit. A foreign or damaged one is refused at the next step."""
        try:
            self.state_from_bytes(blob)
        except ValueError as problem:
            self.refuse(refusals.STATE_REFUSED.format(problem=problem))
            return
        self._refusal = None

    @staticmethod
    def _fmu_state_to_bytes(state):
        return state

    @staticmethod
    def _fmu_state_from_bytes(state):
        return bytes(state)

    # --- messages

    def refuse(self, message):
        """Remember why the next step cannot be done, and log it now."""
        self._refusal = message
        self.say(message, ERROR)

    def _warn(self):
        for sentence in self.warnings():
            self.say(sentence, WARNING)

    def say(self, message, level):
        """Log a message; also on stderr, because PythonFMU drops every message unless the importer turns logging on."""
        text = f"{self.instance_name}: {message}"
        self.log(text.replace("%", "%%"), level)
        if sys.stderr is not None:
            with suppress(OSError, ValueError):  # a host may have closed it
                print(text, file=sys.stderr)
