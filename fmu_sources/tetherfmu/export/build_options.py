"""What an FMU of a tether is built with, beside its name, its folder and its flavour."""

from dataclasses import dataclass, field

from tetherfmu.fmi.resources import DEFAULT_OPTIONS
from tetherfmu.runtime.kernel_library import this_platform


@dataclass(frozen=True)
class Purpose:
    """What an FMU for one purpose, a scene or a system, has of its own.

    Attributes
    ----------
    name : str
        It is added to the file name of the FMU.
    left_out : tuple of str
        Inputs and outputs that the FMU goes without; such inputs stay 0.
    about : str
        Sentence that is added to the description of the FMU.
    step : float
        Communication step of the default experiment [s].
    stop : float
        Stop time of the default experiment [s].
    page : str
        What its documentation page says before the tables of variables, HTML.
    """

    name: str
    left_out: tuple
    about: str
    step: float
    stop: float
    page: str


@dataclass(frozen=True)
class BuildOptions:
    """What can be chosen when an FMU of a tether is built; equal options give equal bytes.

    Attributes
    ----------
    segments : int
        Start value of the parameter `segments`.
    shape_points : int
        Points of the output `shape`; 0 leaves it out.
    platforms : tuple of str
        Names in `ahead_of_time.TARGETS` for which kernels are put in; the default is that of this machine.
    starts : tuple of pairs
        (Input or parameter, start value), where it is not the default; without a purpose parameters of `Tether` only.
    purpose : Purpose, optional
        Of an FMU that is for one scene or one system; None for all others, which have an evidence set.
    wind_points : int
        Points of the input `wind_at`, at least 2; 0 leaves it out.
    """

    segments: int = DEFAULT_OPTIONS["segments"]
    shape_points: int = DEFAULT_OPTIONS["shape_points"]
    platforms: tuple = field(default_factory=lambda: (this_platform(),))
    starts: tuple = ()
    purpose: Purpose | None = None
    wind_points: int = DEFAULT_OPTIONS["wind_points"]

    def as_dict(self):
        """What the FMU itself must know, without defaults, as `fmi.resources.options_in` reads it."""
        options = {"segments": self.segments, "shape_points": self.shape_points}
        if self.wind_points:
            options["wind_points"] = self.wind_points
        if self.starts:
            options["starts"] = [list(each) for each in self.starts]
        if self.purpose:
            own = self.purpose
            options |= {"left_out": list(own.left_out), "about": own.about, "step": own.step, "stop": own.stop}
        return options
