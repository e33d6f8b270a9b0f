"""What an FMU of a tether is built with, beside its name, its folder and its flavour."""

from dataclasses import dataclass, field

from tetherfmu.fmi.resources import DEFAULT_OPTIONS
from tetherfmu.runtime.kernel_library import this_platform
from tetherfmu.runtime.variants import BY_NAME


@dataclass(frozen=True)
class Purpose:
    """What an FMU for one purpose, a scene or a system, has of its own."""

    name: str  # is added to the file name of the FMU
    left_out: tuple  # names of inputs and outputs that the FMU goes without; such inputs stay 0
    about: str  # sentence that is added to the description of the FMU
    step: float  # communication step of the default experiment [s]
    stop: float  # stop time of the default experiment [s]
    page: str  # what its documentation page says before the tables of variables, HTML


@dataclass(frozen=True)
class BuildOptions:
    """What can be chosen when an FMU of a tether is built; equal options give equal bytes."""

    segments: int = DEFAULT_OPTIONS["segments"]  # start value of the parameter `segments`
    shape_points: int = DEFAULT_OPTIONS["shape_points"]  # points of the output `shape`; 0 leaves it out
    platforms: tuple = field(default_factory=lambda: (this_platform(),))  # of `ahead_of_time.TARGETS`, with kernels for them
    # pairs (input or parameter, start value), where it is not the default; without a purpose parameters of `Tether` only
    starts: tuple = ()
    purpose: Purpose | None = None  # of an FMU for one scene or one system; all others have an evidence set
    wind_points: int = DEFAULT_OPTIONS["wind_points"]  # points of the input `wind_at`, at least 2; 0 leaves it out

    def description_of(self, variant):
        """Description of the FMU of a variant, one paragraph."""
        return " ".join([BY_NAME[variant].description, *([self.purpose.about] if self.purpose else [])])

    def as_dict(self):
        """What the FMU itself must know, without defaults, as `fmi.resources.options_in` reads it."""
        options = {"segments": self.segments, "shape_points": self.shape_points}
        if self.wind_points:
            options["wind_points"] = self.wind_points
        if self.starts:
            options["starts"] = [list(each) for each in self.starts]
        if self.purpose:
            own = self.purpose
            options |= {"left_out": list(own.left_out), "step": own.step, "stop": own.stop}
        return options
