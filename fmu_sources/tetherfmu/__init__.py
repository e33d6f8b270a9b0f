"""Tether models for kites, cranes and drones: compiled functions on flat arrays, and shells around them.

The public names are imported when they are first used, so that a part which needs no kernels starts without them.
"""

from importlib import import_module

from .runtime import __version__
from .runtime.variants import EVERY_VARIANT, class_name

_HOMES = {
    "python.models": tuple(map(class_name, EVERY_VARIANT)),
    "python.results": ("Flown", "Outputs", "Refusal"),
    "records.paths": ("MovingEnd", "inputs_along", "kite_at"),
    "python.tether_system": ("TetherSystem",),
    "wiring.lines": ("Line", "Point"),
    "records.problems": ("PlausibilityWarning", "StepRefused"),
    "wiring.winches": ("SharedWinch",),
    "records.materials": ("MATERIALS", "tether_of"),
    "runtime.parameters": ("Tether", "Environment", "Solver", "Winch", "Ground"),
    "python.energy": ("Energy", "EnergyAudit"),
    "wind.frozen_turbulence": ("FrozenTurbulence", "MeanWind"),
    "wind.wind_boxes": ("open_box",),
}
__all__ = ["__version__", *(name for names in _HOMES.values() for name in names)]


def __getattr__(name):
    """A public name, from the module that defines it."""
    for module, names in _HOMES.items():
        if name in names:
            return getattr(import_module(f".{module}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__():
    """The public names."""
    return __all__
