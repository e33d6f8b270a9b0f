"""Common base of all tethers of the Python API: initialize, step, fly, get_state, set_state, properties."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Unpack
from warnings import warn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetherfmu.libraries import ready
from tetherfmu.records import arguments
from tetherfmu.records.problems import PlausibilityWarning
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.inputs import KITE_AT_START, ZERO
from tetherfmu.runtime.instance import Instance
from tetherfmu.runtime.kernel_library import Kernels
from tetherfmu.runtime.parameters import Environment, FreeKite, Ground, Solver, Tether, Winch
from tetherfmu.runtime.variants import BY_NAME, library_of
from tetherfmu.wiring.lines import record_of
from tetherfmu.wiring.packing import pack_records
from tetherfmu.wiring.variables import line_of_tether

from . import energy, given_inputs, state_arrays
from .given_inputs import Inputs
from .results import Flown, Outputs, flown_of, outputs_of
from .running import Running


class TetherModel(Running):
    """Common base of all tethers. Use one of the classes in `python.models`.

    TypeError if a record has another type, or a quantity does not exist.  ValueError names a parameter that is out of
    range, its value and the allowed range.  RuntimeError if the kernels must be compiled and cannot be.

    Parameters
    ----------
    tether : Tether
        A sequence of them is joined in series, from the ground to the kite (tethers with nodes only). The winch changes the
        length of the first; the others keep theirs.
    environment : Environment
    solver : Solver
    winch : Winch
    ground : Ground
    point_masses : dict
        Extra mass [kg] at a node (a knot, a control pod); nodes count from 0 at the ground (tethers with nodes only). A mass
        between the ends is fixed to the rope: the winch changes only the length up to the first one.
    shape_points : int or None
        Points of the output `shape`; None: one more than segments, so one at each node of a uniform tether.
    wind_points : int
        Points at which the wind is given (`wind_at`), at least 2, at equal unstretched lengths from the ground to the kite;
        in between it is linear. `wind_velocity` and the wind profile are then not used. 0: none.
    kernels : runtime.kernel_library.Kernels or None
        Other kernels than those of this installation (`libraries.ready`), such as those of `libraries.just_in_time`.
    **quantities
        A quantity of `Tether`, `Environment`, `Solver`, `Winch` or `Ground`, by its name, replaces the record's, as in
        ``TetherDynamic(initial_length=525.0, segments=30, wind_profile="power_law")``.
    """

    variant: str = ""
    _free_ends: tuple[bool, bool] = (False, False)
    _kite: FreeKite | None = None
    _made = ("_variant", "_instance", "_parameters", "_state", "_inputs", "_outputs", "_receiver")

    def __init__(
        self,
        tether: Tether | Sequence[Tether] = Tether(),  # noqa: B008 (a constant record)
        environment: Environment = Environment(),  # noqa: B008
        solver: Solver = Solver(),  # noqa: B008
        winch: Winch = Winch(),  # noqa: B008
        ground: Ground = Ground(),  # noqa: B008
        *,
        point_masses: Mapping[int, float] | None = None,
        shape_points: int | None = None,
        wind_points: int = 0,
        kernels: Kernels | None = None,
        **quantities: float | str,
    ):
        name, variant = type(self).__name__, BY_NAME[self.variant]
        tethers = arguments.tethers_of(name, tether)
        kinds = {Environment: environment, Solver: solver, Winch: winch, Ground: ground}
        records = [record_of(name, record, kind) for kind, record in kinds.items()]
        tethers, *records = arguments.with_quantities(name, quantities, tethers, *records)
        records[2].check_effect()
        if not variant.has_nodes and (len(tethers) > 1 or point_masses):
            raise ValueError(f"{name} is one uniform line: it accepts one Tether and no point_masses")
        segments = sum(each.segments for each in tethers)
        masses = arguments.checked_masses(point_masses, segments)
        if self._kite and self._kite.kite_mass:
            masses[segments] = masses.get(segments, 0.0) + self._kite.kite_mass
        points = segments + 1 if shape_points is None else arguments.whole("shape_points", shape_points)
        for sentence in (*arguments.doubts(*tethers, *records), *arguments.idle_breaking(variant, tethers)):
            warn(sentence, PlausibilityWarning, stacklevel=2 if type(self).__init__ is TetherModel.__init__ else 3)
        self._kernels, self._points = kernels, points
        self.wind_points: int = arguments.wind_points(wind_points)
        arguments.check_wind(records[0], self.wind_points)
        self._records = tethers, *records
        self._more = {"point_masses": tuple(masses.items()), "free_ends": self._free_ends}
        self._more["kite_start"] = self._kite.kite_start if self._kite else 0
        self._make()

    def _make(self):
        """Allocate the arrays and the maps into them."""
        self._variant = BY_NAME[self.variant]
        kernels = self._kernels or ready.kernels(library_of(self.variant))
        self._instance = instance = Instance(kernels, (line_of_tether(self._points, self.wind_points),))
        self.segments, parameters = pack_records(kernels, *self._records, **self._more)
        instance.set_up((self.segments,), parameters)
        values, self._parameters, self._state = map(np.frombuffer, (instance.values, instance.parameters, instance.state))
        self._inputs, self._outputs = np.split(values, (instance.outputs_at,))
        name, profile = type(self).__name__, self._records[1].wind_profile
        self._receiver = given_inputs.Receiver(
            name, self._variant, instance, self._inputs, memoryview(instance.values), profile, self.wind_points
        )

    def __repr__(self) -> str:
        """Short description, and whether it runs."""
        length = self._state[at.LENGTH] if self._runs else self._parameters[at.INITIAL_LENGTH]
        parts = [f"{self.segments} segments"] if self._variant.has_nodes else []
        parts += [f"{length:g} m unstretched", "running" if self._runs else "not initialized"]
        return f"<{type(self).__name__}: {', '.join(parts)}>"

    def initialize(
        self,
        kite_position: ArrayLike = KITE_AT_START,
        kite_velocity: ArrayLike = ZERO,
        ground_position: ArrayLike = ZERO,
        ground_velocity: ArrayLike = ZERO,
        *,
        slack: float | None = None,
        positions: ArrayLike | None = None,
        velocities: ArrayLike | None = None,
        **inputs: Unpack[Inputs],
    ) -> Outputs:
        """Start between two ends, the dynamic tether with its `initial_shape`; returns the `Outputs` of the start.

        StepRefused if an input is not finite or no equilibrium is found, ValueError if an argument has another shape or is
        out of range; the tether is then as it was before.

        Parameters
        ----------
        kite_position, ground_position : (3,) array
            Ends of the tether [m]; see `kite_at` for elevation, azimuth and distance.
        kite_velocity, ground_velocity : (3,) array
            Their velocities [m/s].
        slack : float or None
            The unstretched length is (1 + slack) times the distance of the ends, instead of `initial_length`; -0.01 for a
            tether that is stretched by about 1 %.
        positions, velocities : (segments + 1, 3) arrays or None
            Nodes [m] and their velocities [m/s] (at rest if not given) instead of the `initial_shape` (dynamic tether only).
            The first and the last node are the ends, whose inputs are then not given.
        **inputs
            Other `Inputs`; 0 by default.
        """
        if positions is not None and not self._variant.has_waves:
            raise ValueError(f"{type(self).__name__} is always in equilibrium: it accepts no node positions")
        nodes = arguments.motion_of_nodes(positions, velocities, self.segments)
        if nodes is not None:
            (ground_position, *_, kite_position), (ground_velocity, *_, kite_velocity) = nodes
        parameters = self._parameters.copy()
        with self._all_or_nothing():
            ends = {"kite_position": kite_position, "kite_velocity": kite_velocity}
            ends |= {"ground_position": ground_position, "ground_velocity": ground_velocity}
            given_inputs.put(self._receiver, given_inputs.starts(self.wind_points) | ends | inputs, at_start=True)
            if slack is not None:
                chord = np.subtract(kite_position, ground_position, dtype=float)
                self._parameters[at.INITIAL_LENGTH] = arguments.length_with(slack, chord, parameters[at.LEAST_LENGTH])
            if nodes is not None:
                self._parameters[at.INITIAL_SHAPE], self._parameters[at.KITE_START] = at.STRAIGHT, at.START_GIVEN
            self._refuse(self._instance.start())
        for place in (at.INITIAL_LENGTH, at.INITIAL_SHAPE, at.KITE_START):
            self._parameters[place] = parameters[place]
        self._runs = True
        if nodes is not None:
            self._motion()[:] = nodes
            self._instance.take_outputs()
        self._warn()
        return self._present()

    def step(
        self,
        step: float,
        kite_position: ArrayLike | None = None,
        kite_velocity: ArrayLike | None = None,
        ground_position: ArrayLike | None = None,
        ground_velocity: ArrayLike | None = None,
        *,
        tether_length: float | None = None,
        **inputs: Unpack[Inputs],
    ) -> Outputs:
        """Advance by a communication step with the inputs at its start, to the `Outputs` at its end.

        An omitted input keeps its value.  StepRefused if the step cannot be done, ValueError if an argument has
        another shape; the tether then keeps the state and the inputs of before.

        Parameters
        ----------
        step : float
            Communication step [s].
        kite_position, kite_velocity, ground_position, ground_velocity
            As for `initialize`.
        tether_length : float
            Unstretched length [m] at the end of the step, whatever it was before, for the tethers without waves (all but the
            dynamic one). `reel_out_speed` still says how fast material moves along the tether.
        **inputs
            Other `Inputs`.
        """
        ends = {"kite_position": kite_position, "kite_velocity": kite_velocity}
        ends |= {"ground_position": ground_position, "ground_velocity": ground_velocity}
        return self._step(step, tether_length, ends | inputs)

    def _step(self, step, tether_length, given):
        """Implementation of `step`; given : inputs by name."""
        self._check_started()
        length = self._state[at.LENGTH]
        try:
            with self._all_or_nothing():
                given_inputs.put(self._receiver, given)
                self._advance(arguments.number("step", step, "s"), tether_length)
        except ValueError:
            self._state[at.LENGTH] = length
            raise
        self._warn(deeper=1)
        return self._present()

    def _advance(self, step, tether_length):
        """Do a communication step [s] with the present inputs, to this length [m] at its end unless it is None."""
        continuation = self._parameters[at.INPUT_CONTINUATION]
        if tether_length is not None:
            by_speed = self._parameters[at.WINCH_CONTROL] == at.WINCH_BY_SPEED
            length = arguments.tether_length(tether_length, self._variant.has_waves, by_speed)
            self._state[at.LENGTH] = length - self._inputs[at.REEL_OUT_SPEED] * step
            self._parameters[at.INPUT_CONTINUATION] = at.HELD
        self._refuse(self._instance.advance(step))
        self._parameters[at.INPUT_CONTINUATION] = continuation

    def fly(
        self,
        inputs: ArrayLike,
        step: float | ArrayLike,
        every: int = 1,
        peaks: bool = True,
        *,
        outputs: bool = True,
        on_refusal: str = "raise",
        node_winds: ArrayLike | None = None,
        wind_at: ArrayLike | None = None,
    ) -> Flown:
        """Advance by many communication steps in compiled code, a `Flown`; equals a loop of `step`, bit for bit.

        ValueError if `inputs` has another shape, `every` is not a whole number of at least 0, or `on_refusal` is something
        else.  StepRefused says which step cannot be done; the tether keeps the state and the inputs of the step before.

        Parameters
        ----------
        inputs : (steps, INPUTS) array
            Inputs at the start of each step, in the columns of `layout.py`; `inputs_along` makes them from paths.
        step : float or (steps,) array
            Communication step [s], or that of each row (some 10 us more for a step).
        every : int
            A row is kept after every so many steps; 0 for none.
        peaks : bool
            Whether outputs are computed after each step, to find the largest ``norm(kite_force)`` since the row before.
            Without it they are computed where a row is kept only: `peak` is that of the row, and a step whose outputs would
            not be finite numbers is refused there only.
        outputs : bool
            Whether the rows have outputs. Without them they have the node positions only, whatever `peaks` says, and no step
            is refused for its outputs: a sixth less time for a dynamic tether with 5 segments.
        on_refusal : "raise", "stop" or "skip"
            What to do when a step cannot be done: raise StepRefused, whose `flown` has the previous rows; return them; or
            skip the step, with NaN in its row if it has one, and continue from the previous state with the inputs of the
            next step (outputs are then computed after each step). `Flown.refusals` says where and why.
        node_winds : (steps, segments + 1, 3) array or None
            Wind [m/s] at each node in each step, instead of the wind in `inputs` (tethers with nodes only).
        wind_at : (steps, wind_points, 3) array or None
            Wind [m/s] at the wind points of a tether that has them, which then ignores the wind in `inputs`; None: that of
            before in all steps.
        """
        self._check_started()
        inputs = given_inputs.rows(self._receiver, inputs, wind_at)
        step = arguments.steps("step", step, len(inputs)) if np.ndim(step) else arguments.number("step", step, "s")
        winds = given_inputs.node_winds(self._receiver, node_winds, len(inputs))
        when = (at.ALWAYS if peaks else at.AT_ROWS) if outputs else at.NEVER
        return self._fly(inputs, step, every, when, on_refusal, flown_of, winds)

    def get_state(self) -> NDArray[np.float64]:
        """Copy of the whole state, one flat array: the state of `layout.py`, the inputs, and what tether it belongs to.

        StepRefused before `initialize`.
        """
        self._check_started()
        return state_arrays.joined(self.variant, self._instance)

    def set_state(self, state: ArrayLike) -> None:
        """Go back to a state of `get_state`, of this tether or one that equals it, bit for bit.

        Environment and solver stay those of this object, but a wind that was given at each node is part of the state.
        ValueError, and nothing changes, if it is not a state of such a tether.
        """
        state_arrays.take(self.variant, self._instance, state)
        if self._parameters[at.WIND_PROFILE] != at.AT_NODES:
            self._parameters[at.WIND_PROFILE] = self._records[1].wind_profile
        self._runs = True

    def outputs(self) -> Outputs:
        """`Outputs` that belong to the present state; StepRefused before `initialize`."""
        self._check_started()
        self._instance.take_outputs()
        return self._present()

    def energy(self, **inputs: Unpack[Inputs]) -> energy.Energy:
        """Energies and powers of the present state, an `energy.Energy`; tethers with nodes only.

        inputs : of `energy.WITH_POWER`; by default those of the last step. The powers explain
        the change of the energy of the dynamic tether; `energy.EnergyAudit` adds them up along a run.
        """
        return self._account(**inputs)[0]

    @property
    def positions(self) -> NDArray[np.float64]:
        """Node positions [m], array (segments + 1, 3)."""
        return self._motion()[0].copy()

    @property
    def velocities(self) -> NDArray[np.float64]:
        """Node velocities [m/s], array (segments + 1, 3); of a `TetherQuasiSteady` those of its rotation with the kite."""
        if self._variant.has_nodes and not self._variant.has_waves:
            return self._account()[2]
        return self._motion()[1].copy()

    @property
    def segment_lengths(self) -> NDArray[np.float64]:
        """Distances of neighbouring nodes [m], array (segments,)."""
        return np.linalg.norm(np.diff(self._motion()[0], axis=0), axis=1)

    @property
    def segment_tensions(self) -> NDArray[np.float64]:
        """Tensions of the segments [N], array (segments,), negative where one is slack; tethers with nodes only."""
        return self._account()[1]

    @property
    def most_factorizations(self) -> int:
        """Bound on the factorizations for one fixed step, each of an iteration; 0 with adaptive steps, which have none."""
        return super().most_factorizations if self._variant.has_waves else 0

    def _account(self, **given):
        """`Energy`, tensions [N] and velocities [m/s] of the present state, see `energy.account`."""
        if not self._variant.has_nodes:
            raise ValueError(f"{type(self).__name__} has no nodes, so no energy and no tensions of segments")
        self._check_started()
        return energy.account(self._instance, **given)

    def _present(self):
        """Latest `Outputs`."""
        return outputs_of(self._outputs.copy())
