"""The flat arrays of a system: an `Instance` made of records, and views of its arrays for numpy."""

import numpy as np

from tetherfmu.libraries import ready
from tetherfmu.runtime import layout as at
from tetherfmu.runtime import plan_layout as places
from tetherfmu.runtime.inputs import WIND_AT
from tetherfmu.runtime.instance import Instance
from tetherfmu.runtime.kernel_library import SYSTEM
from tetherfmu.runtime.parameters import Winch, numbers_of
from tetherfmu.wiring.fmu import carried, holders_of, inputs_of, lines_of
from tetherfmu.wiring.lines import sheave_numbers
from tetherfmu.wiring.packing import pack_lines, put_holders, put_sheaves
from tetherfmu.wiring.portions import all_portions
from tetherfmu.wiring.system_variables import GIVEN, RELEASE

from .turned_lines import Turned


def instance_of(system):
    """`Instance` of a `System`, set up; ValueError names the line if a quantity is not allowed."""
    made = Instance(ready.kernels(SYSTEM), lines_of(system), system.free, system.band)
    masses, portions = {point.name: point.mass for point in system.points} | {None: 0.0}, all_portions(system.lines)
    packed = (
        (
            each.line.name,
            numbers_of(
                each.tethers,
                system.environment,
                system.solver,
                Winch() if each.number else system.winch_of(each.line),
                system.ground,
            ),
            len(each.tethers),
            [name in system.free_names for name in (each.start, each.end)],
            [masses[name] for name in own],
        )
        for each, own in zip(portions, carried(system), strict=True)
    )
    counts, parameters = pack_lines(made.kernels, packed)
    put_sheaves(counts, parameters, [sheave_numbers(each) for each in portions])
    put_holders(counts, parameters, holders_of(system))
    made.set_up(counts, parameters)
    return made


class Arrays:
    """The `Instance` of a `System`, and views of its arrays: `inputs` and `state`, see `plan_layout.py`.

    lines : portions of its lines, in the order of the instance.  vectors : places of inputs by FMI name, without the
    index of an element, arrays (copies, numbers): all lines at a point share its motion.
    """

    def __init__(self, system):
        self.instance, self.system, self.lines = instance_of(system), system, all_portions(system.lines)
        self.turned = Turned(system)
        self.inputs = np.frombuffer(self.instance.values)[: self.instance.outputs_at]
        self.state, self.plan = np.frombuffer(self.instance.state), np.frombuffer(self.instance.plan, dtype=np.int64)
        found, sizes = {}, dict.fromkeys((*GIVEN, RELEASE), 1) | {WIND_AT.name: -1}
        for place, name, *_ in inputs_of(system):
            found.setdefault(name.partition("[")[0], []).append(place)
        for name, each in found.items():
            size = sizes.get(name.rpartition(".")[2], 3)
            found[name] = np.reshape(each, (1, -1) if size < 0 else (-1, size))
        self.vectors = found

    def put(self, inputs, name, numbers):
        """Set an FMI vector, constant or of all steps, in inputs (..., size), which are modified."""
        where = self.vectors[name]
        steps = inputs.shape[:-1] if np.size(numbers) > where.shape[1] else ()
        inputs[..., where] = np.reshape(numbers, (*steps, 1, where.shape[1]))

    def topology(self):
        """Copy of the plan without data from the kernels and sought points, and ratios of winches."""
        found = self.plan.copy()
        found[places.STATUS_LINE] = 0
        rows = found[places.PLAN_HEADER :].reshape(-1, places.LINE_NUMBERS)
        rows[:, [places.START_IS_SOUGHT, places.END_IS_SOUGHT]] = 0
        return np.concatenate([found, self.turned.ratios.ravel()])

    def winds(self):
        """Places in the parameters of all lines: pairs of the wind profile, and of the winds at nodes, a slice."""
        for k, segments in enumerate(self.instance.counts):
            first = self.plan[places.PLAN_HEADER + places.LINE_NUMBERS * k + places.PARAMETERS_AT]
            winds = first + at.node_winds_at(segments)
            yield first + at.WIND_PROFILE, slice(winds, winds + 3 * (segments + 1))

    def put_profile(self):
        """Restore the wind profile of the environment in all lines without wind points."""
        for (profile, _), line in zip(self.winds(), self.instance.lines, strict=True):
            self.instance.parameters[profile] = at.AT_NODES if line.wind_points else self.system.environment.wind_profile

    def without_winds(self, parameters):
        """Copy of the parameters of all lines without parts of their states: winds at nodes, and their flag."""
        found = np.array(parameters)
        for profile, nodes in self.winds():
            found[nodes] = 0.0
            found[profile] = self.system.environment.wind_profile if found[profile] == at.AT_NODES else found[profile]
        return found

    def seek(self, names):
        """Make the next start solve for the free points with these names, and no others."""
        rows = self.plan[places.PLAN_HEADER :].reshape(-1, places.LINE_NUMBERS)
        for row, line in zip(rows, self.lines, strict=True):
            row[[places.START_IS_SOUGHT, places.END_IS_SOUGHT]] = line.start in names, line.end in names

    def outputs_by_line(self, outputs):
        """Outputs of each portion by its name, from all outputs (..., outputs)."""
        ends = np.cumsum([line.outputs_size for line in self.instance.lines])
        return dict(zip([line.name for line in self.lines], np.split(outputs, ends[:-1], axis=-1), strict=True))
