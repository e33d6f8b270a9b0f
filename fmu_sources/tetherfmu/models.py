"""The Python API: tethers without FMI. Five verbs: initialize, step, fly, get_state, set_state."""

from collections import namedtuple
from dataclasses import fields
from time import perf_counter
from typing import NamedTuple

import numpy as np

from tetherfmu.libraries import ready
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.instance import OUTPUTS_AT, Instance
from tetherfmu.runtime.parameters import Environment, Solver, Tether
from tetherfmu.runtime.variables import KITE_AT_START
from tetherfmu.runtime.variants import WITHOUT_NODES, effective

from . import energy

Outputs = namedtuple(
    "Outputs",
    "ground_force kite_force ground_tension kite_tension max_tension tether_length ground_elevation ground_azimuth "
    "slack_segments kite_end_mass kite_stiffness kite_damping wave_time sag shape",
)
Outputs.__doc__ = "Outputs of a tether (docs/interface.md), SI units; forces are arrays of 3, `shape` has one row per point."

_NOTHING = (0.0, 0.0, 0.0)
_INPUT_STARTS = (at.KITE_VELOCITY, at.GROUND_POSITION, at.GROUND_VELOCITY, at.REEL_OUT_SPEED, at.WIND_VELOCITY, at.KITE_LOAD)


class Flown(NamedTuple):
    """What a flight of many communication steps gave: one row for each step that was kept."""

    outputs: np.ndarray  # (rows, outputs_size), as `layout.py` has them
    peak: np.ndarray  # (rows,), largest |kite_force| since the row before [N]
    positions: np.ndarray  # (rows, segments + 1, 3), of the nodes [m]
    seconds: float = 0.0  # wall time of all steps [s]

    @property
    def kite_force(self):
        """Force on the kite [N], array (rows, 3)."""
        return self.outputs[:, at.KITE_FORCE : at.KITE_FORCE + 3]

    @property
    def ground_force(self):
        """Force on the ground station [N], array (rows, 3)."""
        return self.outputs[:, at.GROUND_FORCE : at.GROUND_FORCE + 3]

    @property
    def shape(self):
        """Points of the tether [m], array (rows, points, 3)."""
        points = (self.outputs.shape[1] - at.SHAPE) // 3
        return self.outputs[:, at.SHAPE :].reshape(len(self.outputs), points, 3)


class StepRefused(ValueError):
    """A step or an initialization that cannot be done; the tether keeps the state of before."""


def _checked(point_masses, segments):
    """Pairs (node, mass) of a dict of point masses; ValueError if a node or a mass [kg] does not exist."""
    masses = dict(point_masses or {})
    for node, mass in masses.items():
        if node not in range(segments + 1) or not (mass >= 0.0 and np.isfinite(mass)):
            raise ValueError(
                f"point_masses has {mass!r} kg at node {node!r}; it must be at least 0 kg at a node from 0 to {segments}"
            )
    return masses.items()


class TetherModel:
    """What all tethers share. Use one of the classes below.

    Parameters
    ----------
    tether : Tether
        A sequence of them is joined in series, from the ground to the kite (tethers with nodes only).
    environment, solver : Environment, Solver
    point_masses : dict
        Extra mass [kg] at a node (a knot, a control pod); nodes count from 0 at the ground (tethers with nodes only).
    shape_points : int or None
        Points of the output `shape`; None: one more than segments, so one at each node of a uniform tether.
    kernels : runtime.kernel_library.Kernels or None
        Other kernels than those of this installation (`libraries.ready`), such as those of `libraries.just_in_time`.

    Raises
    ------
    ValueError
        If a parameter is out of range; the message names it, its value and what is allowed.
    RuntimeError
        If the kernels of this installation have to be compiled and cannot.
    """

    variant = None

    def __init__(
        self,
        tether=Tether(),  # noqa: B008 (a constant record)
        environment=Environment(),  # noqa: B008
        solver=Solver(),  # noqa: B008
        *,
        point_masses=None,
        shape_points=None,
        kernels=None,
        _free_ends=(False, False),
    ):
        tethers = (tether,) if isinstance(tether, Tether) else tuple(tether)
        points = sum(each.segments for each in tethers) + 1 if shape_points is None else shape_points
        if self.variant in WITHOUT_NODES and (len(tethers) > 1 or point_masses):
            raise ValueError(f"{type(self).__name__} is one uniform line: it takes one Tether and no point_masses")
        tethers = tuple(effective(each, self.variant) for each in tethers)
        masses = _checked(point_masses, sum(each.segments for each in tethers))
        self._kernels = kernels or ready.kernels(self.variant)
        self._points = points
        self._instance = instance = Instance(self._kernels, points)
        instance.set_up(tethers, environment, solver, point_masses=masses, free_ends=_free_ends)
        self.segments = instance.segments
        arrays = instance.values, instance.parameters, instance.state, instance.before, instance.work
        values, self._parameters, self._state, self._before, self._work = map(np.frombuffer, arrays)  # views
        self._inputs, self._outputs = values[: at.INPUTS], values[OUTPUTS_AT:]
        self._each_input = np.split(self._inputs, _INPUT_STARTS)

    def initialize(
        self,
        kite_position=KITE_AT_START,
        kite_velocity=_NOTHING,
        ground_position=_NOTHING,
        ground_velocity=_NOTHING,
        reel_out_speed=0.0,
        wind_velocity=_NOTHING,
    ):
        """Start between two ends (SI units), the dynamic tether with its `initial_shape`; returns `Outputs` of the start.

        Raises StepRefused if an input is not finite or no equilibrium is found.
        """
        self._set_inputs(
            kite_position, kite_velocity, ground_position, ground_velocity, reel_out_speed, wind_velocity, _NOTHING
        )
        return self._outputs_after(self._instance.start())

    def step(
        self,
        step,
        kite_position=KITE_AT_START,
        kite_velocity=_NOTHING,
        ground_position=_NOTHING,
        ground_velocity=_NOTHING,
        reel_out_speed=0.0,
        wind_velocity=_NOTHING,
        kite_load=_NOTHING,
    ):
        """Advance by a communication step [s] with the inputs at its start (SI units); returns the `Outputs` at its end.

        `kite_load` is an external force on a free kite end. Raises StepRefused and keeps the state of before if the step
        cannot be done.
        """
        self._set_inputs(
            kite_position, kite_velocity, ground_position, ground_velocity, reel_out_speed, wind_velocity, kite_load
        )
        return self._outputs_after(self._instance.advance(step))

    def fly(self, inputs, step, every=1, peaks=True):
        """Advance by many communication steps in compiled code; equals a loop of `step`, bit for bit.

        Parameters
        ----------
        inputs : (steps, INPUTS) array
            Inputs at the start of each step (SI units), in the columns of `layout.py`.
        step : float
            Communication step [s].
        every : int
            A row is kept after every so many steps; 0 for none.
        peaks : bool
            Whether outputs are computed after each step, to find the largest |kite_force| since the row before. Without it
            they are computed where a row is kept only: `peak` is that of the row, and a step whose outputs would not be
            finite numbers is refused there only.

        Returns
        -------
        Flown

        Raises
        ------
        ValueError
            If `inputs` has another shape or `every` is negative.
        StepRefused
            If a step cannot be done; the message says which, and the tether keeps the state of before that step.
        """
        inputs = np.ascontiguousarray(inputs, dtype=float)
        if inputs.ndim != 2 or inputs.shape[1] != at.INPUTS:
            raise ValueError(f"inputs has the shape {inputs.shape}; it must be (steps, {at.INPUTS})")
        if every < 0:
            raise ValueError(f"every is {every!r}; it must be at least 0")
        size, nodes = len(self._outputs), self.segments + 1
        rows = np.zeros((len(inputs) // every + 1 if every else 1, size + 1 + 3 * nodes))  # the last one is for scratch
        arrays = self._parameters, inputs, self._state, self._before, rows, self._work
        parameters, flown, state, before, kept, work = (array.ctypes.data for array in arrays)
        how = float(step), int(every), bool(peaks)
        began = perf_counter()
        done = self._kernels.fly(
            self.segments, parameters, flown, len(inputs), *how, state, before, self._points, kept, work
        )
        seconds = perf_counter() - began
        if len(inputs):
            self._inputs[:] = inputs[min(done, len(inputs) - 1)]
        if done < len(inputs):
            problem = self._instance.advance(step)  # which is refused again, now with its sentence
            raise StepRefused(f"step {done + 1} of {len(inputs)}: {problem}")
        rows = rows[:-1]
        positions = rows[:, size + 1 :].reshape(len(rows), nodes, 3)
        return Flown(np.ascontiguousarray(rows[:, :size]), rows[:, size].copy(), positions, seconds)

    def get_state(self):
        """Copy of the whole state, one flat array; see `layout.py`."""
        return self._state.copy()

    def set_state(self, state):
        """Go back to a state of `get_state`, bit for bit; ValueError if it belongs to another number of segments."""
        state = np.asarray(state, dtype=float)
        if state.shape != self._state.shape:
            raise ValueError(f"state has the shape {state.shape}; it must be {self._state.shape}")
        self._state[:] = state

    def outputs(self):
        """`Outputs` that belong to the present state."""
        self._instance.observe()
        return self._outputs_after(None)

    def energy(self, reel_out_speed=None, wind_velocity=None, kite_load=None):
        """Energies and powers of the present state, an `energy.Energy`; tethers with nodes only.

        `reel_out_speed` [m/s], `wind_velocity` [m/s] and `kite_load` [N] are those of the last step where they are None. The
        powers explain the change of the energy of the dynamic tether; `energy.EnergyAudit` adds them up along a run.
        """
        if self.variant in WITHOUT_NODES:
            raise ValueError(f"{type(self).__name__} has no nodes, so no energy of its own motion")
        state, inputs, energies = self._state, self._inputs.copy(), np.zeros(len(fields(energy.Energy)))
        inputs[at.REEL_OUT_SPEED] = state[at.REELING] if reel_out_speed is None else reel_out_speed
        inputs[at.WIND_VELOCITY : at.WIND_VELOCITY + 3] = (
            state[at.WIND : at.WIND + 3] if wind_velocity is None else wind_velocity
        )
        if kite_load is not None:
            inputs[at.KITE_LOAD : at.KITE_LOAD + 3] = kite_load
        arrays = self._parameters, state, inputs, energies, self._work
        self._kernels.account(self.segments, *(array.ctypes.data for array in arrays))
        return energy.Energy(*energies.tolist())

    def _outputs_after(self, problem):
        """`Outputs` after a start or a step; StepRefused if there was a problem."""
        if problem:
            raise StepRefused(problem)
        values = self._outputs.copy()
        return Outputs(
            values[at.GROUND_FORCE : at.KITE_FORCE],
            values[at.KITE_FORCE : at.GROUND_TENSION],
            *values[at.GROUND_TENSION : at.SLACK_SEGMENTS].tolist(),
            int(values[at.SLACK_SEGMENTS]),
            *values[at.SLACK_SEGMENTS + 1 : at.SHAPE].tolist(),
            values[at.SHAPE :].reshape(-1, 3),
        )

    @property
    def positions(self):
        """Node positions [m], array (segments + 1, 3)."""
        return self._state[at.STATE_HEADER :].reshape(2, -1, 3)[0].copy()

    @property
    def velocities(self):
        """Node velocities [m/s], array (segments + 1, 3)."""
        return self._state[at.STATE_HEADER :].reshape(2, -1, 3)[1].copy()

    @property
    def counters(self):
        """Work since the start: dict of accepted steps, rejected steps, and Newton iterations for shapes."""
        places = {"steps": at.STEPS, "rejections": at.REJECTIONS, "iterations": at.ITERATIONS}
        return {name: int(self._state[place]) for name, place in places.items()}

    def _set_inputs(self, *inputs):
        """Set all inputs, in the order of `layout.py`."""
        for place, value in zip(self._each_input, inputs, strict=True):
            place[:] = value


class TetherDynamic(TetherModel):
    """Lumped masses joined by non-linear spring-damper segments, with drag and reel-out; both ends driven or free.

    Parameters
    ----------
    free_ends : (bool, bool)
        Whether the ground end and the kite end move freely after the start, instead of following the inputs.

    The other parameters are those of `TetherModel`.
    """

    variant = "dynamic"

    def __init__(self, *arguments, free_ends=(False, False), **options):
        super().__init__(*arguments, **options, _free_ends=free_ends)


class TetherQuasiSteady(TetherModel):
    """The chain of the dynamic tether in instantaneous equilibrium, turning with the kite; parameters as `TetherModel`."""

    variant = "quasi_steady"


class TetherCatenary(TetherModel):
    """Elastic catenary under weight plus mean drag, in closed form; parameters as `TetherModel`."""

    variant = "catenary"


class TetherStraight(TetherModel):
    """Straight elastic line with weight and drag shared between its ends; parameters as `TetherModel`."""

    variant = "straight"
