"""Build options of an FMU of a tether or a system, besides name, folder and flavour."""

from dataclasses import dataclass, field

from tetherfmu.files.lean import Lean
from tetherfmu.fmi.resources import DEFAULT_OPTIONS
from tetherfmu.runtime.kernel_library import this_platform
from tetherfmu.runtime.variants import BY_NAME
from tetherfmu.wiring.variables import table_of


@dataclass(frozen=True)
class Purpose:
    """Specific contents of an FMU for one purpose, a scene."""

    name: str  # is added to the file name of the FMU
    about: str  # sentence that is added to the description of the FMU
    step: float  # communication step of the default experiment [s]
    stop: float  # stop time of the default experiment [s]
    page: str  # HTML of its documentation page before the tables of variables


@dataclass(frozen=True)
class BuildOptions:
    """Options of a build; equal options yield equal bytes."""

    segments: int = DEFAULT_OPTIONS["segments"]  # start value of the parameter `segments`; a system uses its file
    # points of the output `shape`; 0 leaves it out, None is one at each node of a system
    shape_points: int | None = DEFAULT_OPTIONS["shape_points"]
    platforms: tuple = field(default_factory=lambda: (this_platform(),))  # of `ahead_of_time.TARGETS`, with kernels for them
    lean: Lean = field(default_factory=Lean)  # the variables that the FMU has, and their start values
    purpose: Purpose | None = None  # of an FMU for one scene; all others have an evidence set
    wind_points: int = DEFAULT_OPTIONS["wind_points"]  # points of the input `wind_at`, at least 2; 0 leaves it out

    def description_of(self, variant):
        """Description of the FMU of a variant, one paragraph."""
        return " ".join([BY_NAME[variant].description, *([self.purpose.about] if self.purpose else [])])

    def of_slave(self, variant):
        """Options for the FMU of a variant, without defaults, in the form that `fmi.resources.options_in` reads.

        ValueError names an unknown variable or an invalid start value.
        """
        options = {"segments": self.segments, "shape_points": self.shape_points}
        if self.wind_points:
            options["wind_points"] = self.wind_points
        options |= chosen(self.lean, table_of(variant, options))
        if self.purpose:
            options |= {"step": self.purpose.step, "stop": self.purpose.stop}
        return options


def chosen(lean, table):
    """Start values and omitted variables of a table, in the form of `BuildOptions.of_slave`."""
    found = {"starts": lean.start_values(table), "left_out": lean.left_out(table)}
    return {key: list(map(list, value)) if key == "starts" else list(value) for key, value in found.items() if value}
