"""The slave of every tether: `base_slave.BaseSlave` around an `Instance` with its compiled kernels."""

from array import array
from pathlib import Path

from ..runtime import layout, refusals, saved_state, status, variables
from ..runtime.instance import Instance, zeros
from ..runtime.kernel_library import load
from ..runtime.packing import pack
from ..runtime.parameters import DEFAULT_TOLERANCE, diameter_in_doubt
from ..runtime.saved_state import STEPPING, SavedState
from ..runtime.variants import BY_NAME, library_of
from .base_slave import WARNING, BaseSlave
from .resources import KERNELS_FOLDER, options_in

_KITE_END = slice(layout.KITE_POSITION, layout.KITE_VELOCITY + 3)  # inputs of the kernels, for a free kite its start


class TetherSlave(BaseSlave):
    """A tether as a PythonFMU slave. A variant is a subclass that sets `variant` and `description`."""

    variant = None
    library = None  # with its kernels; None for that of the variant

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        options = options_in(self.resources)
        self._about = options["about"]
        self._importer_tolerance = 0.0
        self._doubts = ()
        self.make(options)

    def make(self, options):
        """Make the table of variables and the instance from build options."""
        self._kite_is_free = BY_NAME[self.variant].kite_is_free
        table = variables.table_of(self.variant, options)
        names = variables.names_of(table, variables.PARAMETER)
        points = options["shape_points"], options["wind_points"]
        self._instance = Instance(self._kernels(), (variables.line_of_tether(*points),), room=len(names))
        self._outputs_at, self._parameters_at = self._instance.outputs_at, self._instance.parameters_at
        self._places = {name: self._parameters_at + k for k, name in enumerate(names)}
        self._diameters = [self._places["diameter"]]
        references = variables.references(table, options["shape_points"])
        self.declare(table, self._instance.values, references, options)

    def _kernels(self):
        """Load the compiled library now: the folder of the FMU may vanish later. A failure is reported at the start."""
        self._no_kernels = None
        try:
            return load(Path(self.resources or ".") / KERNELS_FOLDER, self.library or library_of(self.variant))
        except OSError as error:
            self._no_kernels = str(error)
            return None

    def to_xml(self, model_options=None):
        """Model description, with what an FMU for one scene says about it."""
        root = super().to_xml(model_options)
        if self._about:
            root.set("description", f"{self.__class__.description} {self._about}")
        return root

    def take_tolerance(self, tolerance):
        """Remember the importer's tolerance where it is tighter than the default; warn of one that is none."""
        if not tolerance > 0.0:
            self.say(refusals.TOLERANCE_NOT_USED.format(tolerance=tolerance), WARNING)
        elif tolerance < DEFAULT_TOLERANCE:
            self._importer_tolerance = tolerance

    # --- the tether

    def start(self):
        """Check the parameters, find the first shape. Returns what is wrong, or None."""
        if self._no_kernels:
            return self._no_kernels
        try:
            self._instance.set_up(*self._packed(self.values, self._importer_tolerance))
        except ValueError as error:
            return str(error)
        doubts = [diameter_in_doubt(self.values[place]) for place in self._diameters]
        self._doubts = tuple(dict.fromkeys(filter(None, doubts)))
        return self._first_shape()

    def _first_shape(self):
        """Find it for the inputs, and where a free kite starts for its parameters. Returns what is wrong, or None."""
        if not self._kite_is_free:
            return self._instance.start()
        before = self.values[_KITE_END]
        first = self._places["initial_kite_position[1]"]
        self.values[_KITE_END] = self.values[first : first + len(before)]
        problem = self._instance.start()
        if problem:
            self.values[_KITE_END] = before
        return problem

    def advance(self, step):
        """One communication step [s]. Returns what is wrong, or None."""
        return self._instance.advance(step)

    def warnings(self):
        """Sentences on what is implausible, each once since the start."""
        doubts, self._doubts = self._doubts, ()
        return (*doubts, *self._instance.warnings()) if doubts else self._instance.warnings()

    def _packed(self, values, tolerance):
        """What `Instance.set_up` takes, from an array of all values; ValueError if one is not allowed."""
        numbers, kites = values[self._parameters_at :], int(self._kite_is_free)
        segments, parameters = pack(self._instance.kernels, numbers, kites=kites, tolerance=tolerance)
        return (segments,), parameters

    def _take_outputs(self):
        """Compute the outputs that belong to the state; returns the status."""
        return self._instance.take_outputs()

    # --- state

    def state_to_bytes(self):
        """The whole state as bytes."""
        instance = self._instance
        state = instance.state if self.phase >= STEPPING else array("d")
        facts = self.variant, self.phase, instance.segments, self._importer_tolerance, self.time
        return saved_state.to_bytes(SavedState(*facts, self.values, state))

    def state_from_bytes(self, blob):
        """Go back to a state; ValueError, with nothing changed, if it is none of this tether."""
        before, values = self.state_to_bytes(), self.values[:]
        try:
            self._take(self._saved(blob))
        except ValueError:
            self._take(self._saved(before))
            self.values[:] = values  # also outputs that cannot be computed from what has been set since
            raise

    def _saved(self, blob):
        """The `SavedState` in bytes; ValueError says what is wrong with them."""
        return saved_state.from_bytes(blob, self.variant, len(self.values), self._instance.state_size)

    def _take(self, saved):
        """Be as in a `SavedState`; ValueError, half done, if its numbers cannot be used.

        Its outputs are not taken but computed: they follow from the state array.
        """
        for reference, variable in zip(self.references, self.table, strict=True):
            value = saved.values[reference]
            if variable.kind != "Real" and reference not in self.output_places and not abs(value) <= layout.LARGEST_INTEGER:
                problem = refusals.NO_INTEGER.format(name=variable.name, value=value)
                raise ValueError(refusals.STATE_WRONG_PARAMETER.format(problem=problem))
        packed = self._packed_of_state(saved) if saved.phase >= STEPPING else None
        self.phase, self._importer_tolerance, self.time = saved.phase, saved.tolerance, saved.time
        first, end = self._outputs_at, self._parameters_at
        self.values[:first] = saved.values[:first]
        self.values[first:end] = zeros(end - first)
        self.values[end:] = saved.values[end:]
        if packed:
            self._instance.set_up(*packed)
            self._instance.take(saved.state)
            if self._take_outputs() != status.OK:
                raise ValueError(refusals.STATE_IMPOSSIBLE)

    def _packed_of_state(self, saved):
        """What `Instance.set_up` takes, from a saved state; ValueError if its state array does not belong to that."""
        if self._no_kernels:
            raise ValueError(f"cannot be used: {self._no_kernels}")
        try:
            packed = self._packed(saved.values, saved.tolerance)
        except ValueError as error:
            raise ValueError(refusals.STATE_WRONG_PARAMETER.format(problem=error)) from None
        if sum(packed[0]) != saved.segments:
            raise ValueError(refusals.STATE_DAMAGED)
        return packed
