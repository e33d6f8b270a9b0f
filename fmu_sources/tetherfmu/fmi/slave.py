"""The slave of every tether, and of systems of them: `base_slave.BaseSlave` around an `Instance` with compiled kernels."""

from array import array
from pathlib import Path

from ..runtime import layout, refusals, saved_state, status
from ..runtime.instance import Instance, zeros
from ..runtime.kernel_library import load
from ..runtime.parameters import DEFAULT_TOLERANCE
from ..runtime.plan_layout import DRIVEN
from ..runtime.polygons import Watched
from ..runtime.quantities import NOT_WHOLE, checked, is_beyond
from ..runtime.saved_state import STEPPING, SavedState
from ..wiring.fmu import of_system, of_tether
from ..wiring.packing import pack_lines, put_holders, put_sheaves
from ..wiring.system import system_from
from .base_slave import WARNING, BaseSlave
from .resources import KERNELS_FOLDER, options_in

_KITE_END = slice(layout.KITE_POSITION, layout.KITE_VELOCITY + 3)  # inputs of the kernels, for a free kite its start


def _sheave(row, values):
    """Arguments of `put_sheaves`, from `WiredLine.sheave` and all values."""
    kind, *references = row
    defaults = (0.0, 0.0, 0.0, 1.0)
    given = zip(references, defaults, strict=False)
    return [kind, *(default if each < 0 else values[each] for each, default in given)] if kind else None


class TetherSlave(BaseSlave):
    """A tether, or a system of tethers, as a PythonFMU slave. A subclass sets `variant` and `description`.

    variant : None for a system, whose points and lines are a build option.
    """

    variant = None

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        options = self.options()
        self._importer_tolerance, self._doubts, self._watch = 0.0, (), None
        if self.variant is None:
            given = options["left_out"], options["starts"]
            self._wiring = of_system(system_from(options["system"]), *given)
            self.modelName = options["system"]["name"]
        else:
            self._wiring = of_tether(self.variant, options)
        self._make_arrays(options)

    def options(self):
        """Build options."""
        return options_in(self.resources)

    def _make_arrays(self, options):
        """Make the instance, the array of all values, and for a system the maps between them."""
        wiring = self._wiring
        self._outputs_at, self._parameters_at, count = wiring.ends
        self._kite_is_free = wiring.is_direct and wiring.record.kite_is_free
        room = count - self._parameters_at if wiring.is_direct else 0
        self._instance = Instance(self._kernels(), wiring.running, wiring.free, wiring.band, room)
        self._watch_positions()
        first = self._instance.outputs_at
        found = [(reference, [first + place for place in places]) for reference, places in wiring.outputs]
        self._sums = [each for each in found if len(each[1]) > 1]
        self._alone = [(reference, places[0]) for reference, places in found if len(places) == 1]
        self._copied = [] if wiring.is_direct else [row[:2] for row in wiring.inputs]
        values = self._instance.values if wiring.is_direct else zeros(count)
        self.constants, self._doubtful = wiring.constants, wiring.doubtful
        for _, reference, value in self.constants:
            values[reference] = value
        self.declare(wiring.shown, values, options)

    def _watch_positions(self):
        """Look for polygons in the positions of a driven kite end of a tether alone, from the next step on."""
        if self._wiring.is_direct:
            self.advance = self._instance.advance  # at once: one call less in each step
            self._watch = None if self._kite_is_free else Watched(self._instance)
            if self._watch:
                self.advance = self._watch.advance

    def _about_positions(self):
        """Sentences on the detected input paths; once the detection is finished, steps skip it."""
        watch = self._watch
        if watch.is_over:
            self._watch, self.advance = None, self._instance.advance
        return watch.sentences("kite_position")

    def _kernels(self):
        """Load the compiled library now: the folder of the FMU may vanish later. A failure is reported at the start."""
        self._no_kernels = None
        try:
            return load(Path(self.resources or ".") / KERNELS_FOLDER, self._wiring.library)
        except OSError as error:
            self._no_kernels = str(error)
            return None

    def take_tolerance(self, tolerance):
        """Remember the importer's tolerance if it is tighter than the default; warn of an invalid one."""
        if not tolerance > 0.0:
            self.say(refusals.TOLERANCE_NOT_USED.format(tolerance=tolerance), WARNING)
        elif tolerance < DEFAULT_TOLERANCE:
            self._importer_tolerance = tolerance

    # --- start and steps

    def start(self):
        """Check the parameters, solve the initial shapes. Returns the problem, or None."""
        if self._no_kernels:
            return self._no_kernels
        try:
            self._set_up(self._packed(self.values, self._importer_tolerance))
        except ValueError as error:
            return str(error)
        given = ((self.values[reference], *row) for reference, *row in self._doubtful)
        self._watch_positions()
        self._doubts = tuple(said.format(value=value) for value, *bound, said in given if is_beyond(value, *bound))
        return self._first_shape()

    def _first_shape(self):
        """Solve the initial shape for the inputs, and the start of a free kite. Returns the problem, or None."""
        if not self._kite_is_free:
            self._give()
            return self._shown(self._instance.start())
        before = self.values[_KITE_END]
        first = next(
            reference for name, reference, _ in self._wiring.lines[0].quantities if name == "initial_kite_position[1]"
        )
        self.values[_KITE_END] = self.values[first : first + len(before)]
        problem = self._instance.start()
        if problem:
            self.values[_KITE_END] = before
        return problem

    def advance(self, step):
        """One communication step [s] of a system. Returns the problem, or None."""
        self._give()
        return self._shown(self._instance.advance(step))

    def warnings(self):
        """Sentences on implausible behaviour, each once since the start."""
        doubts, self._doubts = self._doubts, ()
        if self._watch:
            doubts = (*doubts, *self._about_positions())
        return (*doubts, *self._instance.warnings()) if doubts else self._instance.warnings()

    def _packed(self, values, tolerance):
        """Arguments of `_set_up`, from an array of all values; ValueError names a variable that is out of range."""
        wiring = self._wiring
        # for a single tether `pack` also names the problem
        for each in () if wiring.is_direct else wiring.table[self._parameters_at :]:
            _check(each, values[each.place])
        lines = (
            (
                each.running.name,
                [default if reference < 0 else values[reference] for _, reference, default in each.quantities],
                1,
                [point != DRIVEN for point in (each.running.start_point, each.running.end_point)],
                [0.0 if reference < 0 else values[reference] for reference in each.carried],
            )
            for each in wiring.lines
        )
        sought = [(place, int(values[reference] == layout.START_AT_REST)) for place, reference in wiring.starts]
        counts, parameters = pack_lines(self._instance.kernels, lines, tolerance, int(self._kite_is_free))
        put_sheaves(counts, parameters, [_sheave(each.sheave, values) for each in wiring.lines])
        put_holders(counts, parameters, wiring.holders)
        return counts, parameters, sought

    def _set_up(self, packed):
        """Make the arrays of the instance."""
        self._instance.set_up(*packed)

    def _give(self):
        """Put the inputs of a system into the array of the kernels."""
        given, values = self._instance.values, self.values
        for place, reference in self._copied:
            given[place] = values[reference]
        for place, *_ in self._wiring.held:
            given[place] = 0.0
        for place, reference, _, _, factor in self._wiring.held:
            given[place] += factor * values[reference]

    def _shown(self, problem):
        """Copy the outputs of a system to the values, if there is no problem; returns the problem."""
        if problem:
            return problem
        values, found, state = self.values, self._instance.values, self._instance.state
        first = self._instance.outputs_at
        for reference, place in self._alone:
            values[reference] = found[place]
        for reference, places in self._sums:
            values[reference] = sum(found[place] for place in places)
        for reference, *_ in self._wiring.turned:
            values[reference] = 0.0
        for reference, place, factor, less in self._wiring.turned:
            values[reference] += factor * (found[first + place] - (0.0 if less < 0 else values[less]))
        for reference, k, is_end, component in self._wiring.motion:
            own = self._instance.states_at[k]
            segments = self._instance.counts[k] + int(state[own + layout.LET_GO])
            what, axis = divmod(component, 3)
            node = (segments + 1) * what + segments * is_end
            values[reference] = state[own + layout.STATE_HEADER + 3 * node + axis]
        return problem

    # --- state

    def state_to_bytes(self):
        """The whole state as bytes."""
        instance = self._instance
        state = instance.state if self.phase >= STEPPING else array("d")
        facts = self._wiring.name, self.phase, instance.segments, self._importer_tolerance, self.time
        return saved_state.to_bytes(SavedState(*facts, self.values, state))

    def state_from_bytes(self, blob):
        """Restore a state; ValueError, with no change, if it belongs to another tether."""
        before, values = self.state_to_bytes(), self.values[:]
        try:
            self._take(self._saved(blob))
        except ValueError:
            self._take(self._saved(before))
            self.values[:] = values  # also outputs that later inputs do not determine
            raise

    def _saved(self, blob):
        """The `SavedState` in bytes; ValueError describes a problem with them."""
        return saved_state.from_bytes(blob, self._wiring.name, len(self.values), self._instance.state_size)

    def _take(self, saved):
        """Restore a `SavedState`; ValueError, half done, if its numbers are invalid.

        Its outputs are not used but computed: they follow from the state array.
        """
        for name, reference, expected in self.constants:
            value = saved.values[reference]
            if value != expected:
                raise ValueError(refusals.STATE_OTHER_CONSTANT.format(name=name, value=value, expected=expected))
        for variable in self._wiring.table:
            value = saved.values[variable.place]
            is_given = variable.kind != "Real" and variable.place not in self.output_places
            if is_given and not abs(value) <= layout.LARGEST_INTEGER:
                problem = refusals.NO_INTEGER.format(name=variable.name, value=value)
                raise ValueError(refusals.STATE_WRONG_PARAMETER.format(problem=problem))
        packed = self._packed_of_state(saved) if saved.phase >= STEPPING else None
        self.phase, self._importer_tolerance, self.time = saved.phase, saved.tolerance, saved.time
        first, end = self._outputs_at, self._parameters_at
        self.values[:first] = saved.values[:first]
        self.values[first:end] = zeros(end - first)
        self.values[end:] = saved.values[end:]
        if packed:
            if self._watch:
                self._watch.forget()
            self._set_up(packed)
            self._instance.take(saved.state)
            if self._shown(self._instance.take_outputs()) != status.OK:
                raise ValueError(refusals.STATE_IMPOSSIBLE)

    def _packed_of_state(self, saved):
        """Arguments of `_set_up`, from a saved state; ValueError if its state array does not belong to it."""
        if self._no_kernels:
            raise ValueError(f"cannot be used: {self._no_kernels}")
        try:
            packed = self._packed(saved.values, saved.tolerance)
        except ValueError as error:
            raise ValueError(refusals.STATE_WRONG_PARAMETER.format(problem=error)) from None
        if sum(packed[0]) != saved.segments:
            raise ValueError(refusals.STATE_DAMAGED)
        return packed


def _check(variable, value):
    """ValueError unless a value is allowed for a parameter."""
    is_whole = variable.kind != "Real" and value.is_integer()
    checked(variable.name, int(value) if is_whole else value, variable.quantity)
    if variable.kind != "Real" and not is_whole:
        raise ValueError(NOT_WHOLE.format(name=variable.name, value=value))
