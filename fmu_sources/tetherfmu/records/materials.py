"""Tethers of common materials: density and stiffness of a rope from its diameter, with their sources.

Ropes differ: with the data sheet of yours, set `density`, `axial_stiffness` and `axial_damping` of `Tether` yourself. Both
numbers refer to the full circle of the nominal diameter, so they are below those of the bare fibre or wire.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi

from tetherfmu.runtime.naming import meant_or_all
from tetherfmu.runtime.parameters import Tether, allowed_by, changed


@dataclass(frozen=True)
class Material:
    """A kind of rope."""

    density: float  # mass per length over the area of the nominal diameter [kg/m3]
    modulus: float  # axial stiffness E A over the same area [Pa]
    source: str


_KITE_TETHER = (
    "settings of KiteModels.jl: rho_tether 724 kg/m3, e_tether 55 GPa (M. B. Ruppert, measured on a kite tether); the fact "
    "sheet CIS YA100 of DSM gives 109 to 132 GPa for the fibre, the same for SK75 and SK78"
)
_PER_SQUARE = 4.0 / pi  # area of a circle: d^2 / _PER_SQUARE
_ORCAFLEX = "OrcaFlex manual, line types, rope/wire: mass {} d^2 kg/m, EA = {} d^2 N, d nominal diameter [m]"
MATERIALS = {
    "dyneema_sk75": Material(724.0, 55e9, _KITE_TETHER),
    "dyneema_sk78": Material(724.0, 55e9, _KITE_TETHER),
    "steel": Material(3989.7 * _PER_SQUARE, 4.04e10 * _PER_SQUARE, _ORCAFLEX.format("3989.7", "4.04e10") + " (wire core)"),
    "polyester": Material(797.8 * _PER_SQUARE, 1.09e9 * _PER_SQUARE, _ORCAFLEX.format("797.8", "1.09e9")),
}


def tether_of(material: str, diameter: float, **more: float | str) -> Tether:
    """A `Tether` of a material with a nominal diameter [m].

    material : "dyneema_sk75", "dyneema_sk78", "steel" or "polyester"; `MATERIALS` has the numbers and their sources.  more :
    other quantities of `Tether`. Damping: the relaxation time axial_damping/axial_stiffness of the default tether, 0.77 ms.
    ValueError if the material does not exist or a quantity is out of range.

    >>> tether = tether_of("steel", 0.01, initial_length=100.0)
    >>> round(tether.mass_per_length, 5), round(tether.axial_stiffness)
    (0.39897, 4040000)
    """
    if material not in tuple(MATERIALS):
        raise ValueError(f"material is {material!r}{meant_or_all(str(material), MATERIALS, 'it must be one of {}')}")
    found = MATERIALS[material]
    default = Tether()
    with allowed_by(diameter):
        stiffness = found.modulus * pi / 4.0 * diameter**2
        damping = stiffness * default.axial_damping / default.axial_stiffness
        values = {"density": found.density, "axial_stiffness": stiffness, "axial_damping": damping}
        tether = Tether(diameter=diameter, **values)
    return changed(tether, more)
