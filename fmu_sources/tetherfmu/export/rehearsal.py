"""The slave of an FMU in this process, before it is packed: its start values are checked as the FMU checks them."""

import re
from warnings import warn

from tetherfmu.fmi.resources import DEFAULT_OPTIONS
from tetherfmu.fmi.slave import TetherSlave
from tetherfmu.libraries import ready
from tetherfmu.records.problems import PlausibilityWarning
from tetherfmu.wiring.selection import own_name
from tetherfmu.wiring.variables import INPUT


class Rehearsal(TetherSlave):
    """The slave of a variant (None for a system) with these build options, and the kernels of this machine."""

    description = ""

    def __init__(self, variant, options):
        self.variant, self._given = variant, DEFAULT_OPTIONS | options
        super().__init__(instance_name="start")

    def options(self):
        """Build options."""
        return self._given

    def can_be_helped(self, problem):
        """Whether the FMU has an input that a refused step is about, or any input if the sentence names none."""
        tables = self._wiring.table, self._wiring.shown
        full, own = ({own_name(each.name) for each in table if each.causality == INPUT} for table in tables)
        return bool((full & set(re.findall(r"\w+", problem)) or full) & own)

    def _kernels(self):
        self._no_kernels = None
        return ready.kernels(self._wiring.library)


def check_start(variant, options):
    """ValueError unless the FMU with these build options starts with its start values and can do a step.

    variant : None for a system.  Doubts are a `PlausibilityWarning`, including a step that other inputs may permit.
    """
    slave = Rehearsal(variant, options)
    if problem := slave.start():
        raise ValueError(f"the FMU would refuse its start values: {problem}")
    doubts, step = [*slave.warnings()], slave.default_experiment.step_size
    if problem := slave.advance(step):
        refused = f"the FMU would refuse the first step of {step:g} s with its start values: {problem}"
        if not slave.can_be_helped(problem):
            raise ValueError(f"{refused}; none of its inputs changes that")
        doubts.append(refused)
    for sentence in doubts:
        warn(sentence, PlausibilityWarning, stacklevel=3)
