"""Declarations of the sheaves of a system's lines: the parameters of each."""

from .quantities import Quantity

SHEAVE_QUANTITIES = {
    "sheave_mass": Quantity("kg", "inertia of the sheave as seen at the rope, J/r2; 0: of the rope only", 0.0, 1e9),
    "sheave_friction": Quantity("", "Coulomb friction of the rope on the sheave, over the present angle of wrap", 0.0, 10.0),
    "sheave_efficiency": Quantity(
        "", "tension on the side from which the rope runs over that on the other side, whatever the wrap", 1e-3, 1.0
    ),
}
