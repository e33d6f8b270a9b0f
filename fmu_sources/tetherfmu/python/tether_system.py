"""`TetherSystem`: lines between points, moved in one step."""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetherfmu.files import system_files as files
from tetherfmu.records import arguments
from tetherfmu.records.checked_systems import checked_system
from tetherfmu.records.problems import StepRefused
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.naming import prefixed
from tetherfmu.runtime.parameters import Environment, Ground, Solver
from tetherfmu.runtime.status import OK
from tetherfmu.wiring.lines import Line, Point
from tetherfmu.wiring.portions import joined
from tetherfmu.wiring.system import System
from tetherfmu.wiring.winches import SharedWinch

from .energy import account
from .results import outputs_of
from .running import Running
from .system_arrays import Arrays
from .system_inputs import SystemInputs, Vectors, check_dicts, completed, put, starts
from .system_results import SystemEnergy, SystemFlown, SystemOutputs, points_of
from .turned_lines import energies_of, without_drum
from .whole_lines import along, energy_of, portions_in, whole_outputs


class TetherSystem(Running):
    """Tethers that meet in points, in one system of equations: bridles, several kites on one tether, drones with one load.

    The start of a line is the ground end of a single tether, its end the kite end; all of them share air, gravity, ground
    and solver. Points are driven by inputs as the ends of a `TetherDynamic`, or free: a mass, moved by its lines, its weight
    and a load, as the kite of a `TetherDynamicFree`.

    TypeError or ValueError if a record has another type or the records do not fit together.  RuntimeError if the kernels
    must be compiled and cannot be.

    Parameters
    ----------
    points : sequence of Point
    lines : sequence of Line
    environment : Environment
    solver : Solver
    ground : Ground
    winches : sequence of SharedWinch
        Winches that hold several lines.
    wind_points : int
        Points of each line at which the wind is given (`wind_at`), at least 2, at equal unstretched lengths from its start
        to its end; in between it is linear. `wind_velocity` and the wind profile are then not used. 0: none.

    Examples
    --------
    Two kites on one main tether:

    >>> from tetherfmu import Tether
    >>> points = [
    ...     Point("winch", (0.0, 0.0, 0.0)),
    ...     Point("knot", (0.0, 0.0, 100.0), mass=2.0),
    ...     Point("left", (-40.0, 0.0, 130.0)),
    ...     Point("right", (40.0, 0.0, 130.0)),
    ... ]
    >>> arm = Tether(segments=4, initial_length=50.0)
    >>> main = Line("main", "winch", "knot", Tether(segments=8, initial_length=99.9))
    >>> system = TetherSystem(points, [main, Line("a", "knot", "left", arm), Line("b", "knot", "right", arm)])
    >>> start = system.initialize()
    >>> for _ in range(10):
    ...     outputs = system.step(0.02)
    >>> outputs.points["knot"].position.shape, outputs.lines["main"].shape.shape
    ((3,), (9, 3))
    >>> system
    <TetherSystem: 4 points (1 free), 3 lines, 16 segments, running>
    """

    _made = ("_instance", "_arrays")

    def __init__(
        self,
        points: Sequence[Point],
        lines: Sequence[Line],
        environment: Environment = Environment(),  # noqa: B008 (a constant record)
        solver: Solver = Solver(),  # noqa: B008
        ground: Ground = Ground(),  # noqa: B008
        *,
        winches: Sequence[SharedWinch] = (),
        wind_points: int = 0,
    ):
        self._take(System(type(self).__name__, points, lines, environment, solver, ground, winches, wind_points))

    def _take(self, system):
        """Adopt the properties of a `System`."""
        self._system = system = checked_system(system)
        self.points, self.lines, self.winches = system.points, system.lines, system.winches
        self.wind_points: int = system.wind_points
        self._make()

    @classmethod
    def of(cls, system: System, **changes) -> TetherSystem:
        """System that a record describes, as a file gives it, with other values of its fields; errors as above."""
        made = object.__new__(cls)
        made._take(replace(system, **changes))
        return made

    def _make(self):
        """Make the arrays."""
        self._arrays = Arrays(self._system)
        self._instance = self._arrays.instance

    @classmethod
    def from_file(cls, path: str | Path) -> TetherSystem:
        """System of a TOML file; ValueError says in one line what is wrong: file, key, value and what is allowed.

        docs/use/systems.md has the keys.
        """
        found = files.load(path)
        with prefixed(f"{path}: "):
            return cls.of(found)

    @contextmanager
    def _all_or_nothing(self):
        """Also restore winch inputs on refusal."""
        told = self._arrays.turned.told
        try:
            with super()._all_or_nothing():
                yield
        except ValueError:
            self._arrays.turned.told = told
            raise

    def __repr__(self) -> str:
        """Short description, and whether it runs."""
        parts = [f"{len(self.points)} points ({len(self._instance.free)} free)", f"{len(self.lines)} lines"]
        parts += [f"{self._instance.segments} segments", "running" if self._runs else "not initialized"]
        return f"<TetherSystem: {', '.join(parts)}>"

    def initialize(
        self,
        wind_velocity: ArrayLike | Vectors = (0.0, 0.0, 0.0),
        *,
        positions: Vectors | None = None,
        velocities: Vectors | None = None,
        loads: Vectors | None = None,
        **inputs: Unpack[SystemInputs],
    ) -> SystemOutputs:
        """Start with the points where their records say, each line with the `initial_shape` between them: `SystemOutputs`.

        Free points without a position start where they are in equilibrium with all lines at rest.  StepRefused if an input
        is not finite or no equilibrium of a line, or of the free points, is found, ValueError if a name does not exist, or
        a value has another shape; the system is then as it was before.

        Parameters
        ----------
        wind_velocity : (3,) array, or dict of str to (segments + 1, 3) array
            Wind [m/s] at `wind_reference_height`; or at each node of lines, by name, and no wind at the others.
        positions, velocities : dict of str to (3,) array
            Other positions [m] and velocities [m/s] of points than those of their records; a position None of a free point
            is found.
        loads : dict of str to (3,) array
            External force [N] on free points; 0 where none is given.
        **inputs
            Other `SystemInputs`; by default reel-out speeds are those of the lines' records, all others 0.
        """
        check_dicts({"positions": positions, "velocities": velocities, "loads": loads, **inputs})
        positions = {**{each.name: each.position for each in self.points}, **(positions or {})}
        wanted = [name for name, position in positions.items() if position is None]
        if not set(wanted) <= set(self._instance.free):
            raise ValueError(f"{next(iter(set(wanted) - set(self._instance.free)))} is not a free point: give its position")
        with self._all_or_nothing():
            moving = {"velocities": {each.name: each.velocity for each in self.points}}
            moving |= starts(self._system)
            given = completed({"wind_velocity": wind_velocity, "velocities": velocities, "loads": loads, **inputs}, moving)
            given["positions"] = {name: position for name, position in positions.items() if position is not None}
            self._arrays.turned.told = put(given, self._arrays, at_start=True)
            self._arrays.seek(wanted)
            self._refuse(self._instance.start())
        self._runs = True
        self._warn()
        return self._present()

    def step(
        self,
        step: float,
        positions: Vectors | None = None,
        velocities: Vectors | None = None,
        loads: Vectors | None = None,
        **inputs: Unpack[SystemInputs],
    ) -> SystemOutputs:
        """Advance by a communication step with the inputs at its start, to the `SystemOutputs` at its end.

        An omitted input keeps its value.  StepRefused if the step cannot be done, ValueError if a name does not
        exist or a value has another shape; the system then keeps the state and the inputs of before.

        Parameters
        ----------
        step : float
            Communication step [s].
        positions, velocities : dict of str to (3,) array
            Of driven points, by name [m], [m/s].
        loads : dict of str to (3,) array
            External force on free points [N] at the start of the step, which continues as a `kite_load` does.
        **inputs
            Other `SystemInputs`.
        """
        self._check_started()
        with self._all_or_nothing():
            given = {"positions": positions, "velocities": velocities, "loads": loads, **inputs}
            self._arrays.turned.told = put(given, self._arrays)
            self._refuse(self._instance.advance(arguments.number("step", step, "s")))
        self._warn()
        return self._present()

    def fly(
        self,
        steps: int,
        step: float,
        positions: Vectors | None = None,
        velocities: Vectors | None = None,
        loads: Vectors | None = None,
        *,
        every: int = 1,
        on_refusal: str = "raise",
        **inputs: Unpack[SystemInputs],
    ) -> SystemFlown:
        """Advance by many communication steps in compiled code, a `SystemFlown`; equals a loop of `step`, bit for bit.

        StepRefused says which step cannot be done, and its `flown` has the rows before; the system is in the state before
        that step.  ValueError if a name does not exist or a value has another shape; nothing is changed.

        Parameters
        ----------
        steps : int
            How many.
        step : float
            Communication step [s].
        positions, velocities, loads, **inputs
            As for `step`, each constant or with one row for each step: (steps, 3) arrays, (steps,) of a winch.
        every : int
            A row is kept after every so many steps; 0 for none.
        on_refusal : "raise", "stop" or "skip"
            What to do when a step cannot be done, see `TetherModel.fly`.
        """
        self._check_started()
        steps, every = arguments.whole("steps", steps), arguments.whole("every", every)
        step = arguments.number("step", step, "s")
        rows = np.repeat(self._arrays.inputs[None, :], steps, axis=0)
        given = {"positions": positions, "velocities": velocities, "loads": loads, **inputs}
        told = put(given, self._arrays, rows)
        when = at.AT_ROWS if every else at.NEVER
        try:
            return self._fly(np.ascontiguousarray(rows), step, every, when, on_refusal, self._flown)
        finally:
            done = np.flatnonzero(np.all(rows == self._arrays.inputs, axis=1))
            if len(done):
                self._arrays.turned.told = told[done[-1]]

    def get_state(self) -> NDArray[np.float64]:
        """Copy of the whole state, one flat array: topology, states of all lines, inputs, parameters.

        StepRefused before `initialize`.
        """
        self._check_started()
        arrays = self._arrays
        return np.concatenate(
            [arrays.topology(), arrays.state, arrays.inputs, self._instance.parameters, arrays.turned.told]
        )

    def set_state(self, state: ArrayLike) -> None:
        """Go back to a state of `get_state`, of this system or one that equals it, bit for bit.

        ValueError, and nothing changes, if it is not a state of such a system.
        """
        arrays = self._arrays
        state = np.asarray(state, dtype=float)
        ours = self._instance.parameters
        sizes = [len(each) for each in (arrays.topology(), arrays.state, arrays.inputs, ours, arrays.turned.told)]
        if state.shape != (sum(sizes),):
            raise ValueError(f"state has the shape {state.shape}; it must be {(sum(sizes),)}")
        topology, own, inputs, parameters, told = np.split(state, np.cumsum(sizes)[:-1])
        is_same = np.array_equal(*map(arrays.without_winds, (parameters, ours)))
        if not (np.array_equal(topology, arrays.topology()) and is_same):
            raise ValueError("state belongs to another system: its points, lines, environment or solver differ")
        if not np.all(np.isfinite(state)):
            raise ValueError("state has a number that is not finite")
        with prefixed("state "):
            self._instance.take(array("d", own))
        arrays.inputs[:], ours[:], arrays.turned.told = inputs, array("d", parameters), told
        self._runs = True

    def outputs(self) -> SystemOutputs:
        """`SystemOutputs` that belong to the present state; StepRefused before `initialize`."""
        self._check_started()
        if self._instance.take_outputs() != OK:
            raise StepRefused("the outputs that belong to this state are not finite numbers")
        return self._present()

    def _present(self):
        """Latest `SystemOutputs`."""
        values = self._arrays.outputs_by_line(np.array(self._instance.values[self._instance.outputs_at :]))
        portions = self._arrays.lines
        motion = [self._motion(k) for k in range(len(portions))]
        lines = {line.name: outputs_of(whole_outputs(line, values)) for line in self.lines}
        most = next(iter(lines.values())).solver_iteration_limit  # of all lines the same
        points = points_of(self.points, portions, motion, values)
        found = {line.name: portions_in(line, values) for line in self.lines if line.through}
        return SystemOutputs(points, lines, most, self._arrays.turned.outputs(values), found)

    def energy(self) -> SystemEnergy:
        """Energies and powers of the present state, with the inputs of the last step; StepRefused before `initialize`."""
        self._check_started()
        count = range(len(self._arrays.lines))
        parts = joined(self.lines, (account(self._instance, k)[0] for k in count))
        states = joined(self.lines, (self._instance.state_of(k) for k in count))
        first = {line.name: (energies[0], own[0]) for line, energies, own in zip(self.lines, parts, states, strict=True)}
        winches = energies_of(self.winches, *({name: each[i] for name, each in first.items()} for i in range(2)))
        found, sheaves = {}, {}
        for line, energies, own in zip(self.lines, parts, states, strict=True):
            found[line.name], of_sheaves = energy_of(line, energies, own)
            if self._system.holding(line.name):
                found[line.name] = without_drum(found[line.name])
            if of_sheaves is not None:
                sheaves[line.name] = of_sheaves
        points, inputs, vectors = self._present().points, self._arrays.inputs, self._arrays.vectors
        powers = {name: float(inputs[vectors[f"{name}.load"][0]] @ points[name].velocity) for name in self._system.free}
        return SystemEnergy(found, powers, sheaves, winches)

    @property
    def positions(self) -> dict[str, NDArray[np.float64]]:
        """Node positions of each line [m], arrays (segments + 1, 3); of a line over sheaves those of all its portions."""
        return self._nodes(0)

    @property
    def velocities(self) -> dict[str, NDArray[np.float64]]:
        """Node velocities of each line [m/s], arrays as `positions`."""
        return self._nodes(1)

    def _nodes(self, which):
        """Positions [m] (0) or velocities [m/s] (1) of the nodes of each line."""
        motion = [self._motion(k)[which] for k in range(len(self._arrays.lines))]
        return {line.name: along(each) for line, each in zip(self.lines, joined(self.lines, motion), strict=True)}

    def _flown(self, rows, seconds, refusals, time):
        """`SystemFlown` of the rows of `compiled_flight.fly` at these times [s]."""
        outputs = np.zeros((len(rows.motion[0]), len(self._instance.values) - self._instance.outputs_at))
        values = self._arrays.outputs_by_line(outputs if rows.outputs is None else rows.outputs)
        motion = joined(self.lines, [each[:, 0] for each in rows.motion])
        positions = {line.name: along(each) for line, each in zip(self.lines, motion, strict=True)}
        points = points_of(self.points, self._arrays.lines, rows.motion, values)
        winches = self._arrays.turned.outputs(values)
        found = {line.name: portions_in(line, values) for line in self.lines if line.through}
        whole = {line.name: whole_outputs(line, values) for line in self.lines}
        return SystemFlown(points, whole, positions, seconds, refusals, time, winches, found)
