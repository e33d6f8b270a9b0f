"""The slave of an FMU in this process, before it is packed: its start values are checked as the FMU checks them."""

from warnings import warn

from tetherfmu.fmi.resources import DEFAULT_OPTIONS
from tetherfmu.fmi.slave import TetherSlave
from tetherfmu.libraries import ready
from tetherfmu.results import PlausibilityWarning


class Rehearsal(TetherSlave):
    """The slave of a variant (None for a system) with these build options, and the kernels of this machine."""

    description = ""

    def __init__(self, variant, options):
        self.variant, self._given = variant, DEFAULT_OPTIONS | options
        super().__init__(instance_name="start")

    def options(self):
        """Build options."""
        return self._given

    def _kernels(self):
        self._no_kernels = None
        return ready.kernels(self._wiring.library)


def check_start(variant, options):
    """ValueError unless the FMU with these build options starts with its start values; doubts are `PlausibilityWarning`s.

    variant : None for a system.
    """
    slave = Rehearsal(variant, options)
    problem = slave.start()
    if problem:
        raise ValueError(f"the FMU would refuse its start values: {problem}")
    for sentence in slave.warnings():
        warn(sentence, PlausibilityWarning, stacklevel=3)
