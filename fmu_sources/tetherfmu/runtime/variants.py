"""The variants of the tether: the features of each, the inputs it ignores, and the spellings of its name."""

from dataclasses import dataclass, field, replace

from .dependencies import AIR, GROUND, POSITIONS, STRETCH, WHERE_KITE_RESTS
from .naming import meant


@dataclass(frozen=True)
class Variant:
    """One variant of the tether; its outputs and dependencies list differences from the dynamic tether."""

    name: str  # of its module in `kernels.variants`, or of no module if it uses the library of another
    description: str  # of the FMU
    has_nodes: bool
    has_waves: bool  # if not, it is in equilibrium at each instant
    colour: str  # in all pictures, see `console.colours`
    # largest deviation from the reference of the evidence set, relative to the largest value: solver error at its
    # default tolerance; without integration, only the digits of the files
    evidence_deviation: float
    evidence_tolerance: float | None = None  # relative tolerance of that run; None for the default
    library: str = ""  # the variant with its compiled library; "" for its own
    kite_is_free: bool = False
    has_kink: bool = True  # of the forces, where `slack_segments` changes
    ignored: dict = field(default_factory=dict)  # parameters without effect, and why
    meanings: dict = field(default_factory=dict)  # of outputs
    depends_on: dict = field(default_factory=dict)  # of outputs or their components, see `dependencies`


_IGNORED_WITHOUT_WAVES = {
    **dict.fromkeys(("axial_damping", "slack_damping_ratio", "damping_law"), "this tether has no waves"),
    "breaking_force": "this tether cannot break: it has no inertia",
    "initial_shape": "this tether is in equilibrium from the start",
}
_IGNORED_WITHOUT_NODES = {
    **_IGNORED_WITHOUT_WAVES,
    "slack_stiffness_ratio": "this tether is never compressed",
    "segments": "this tether has no nodes",
}
_IGNORED_BY_A_STRAIGHT_LINE = {
    **_IGNORED_WITHOUT_NODES,
    **dict.fromkeys(GROUND, "this tether ignores the ground: it never hangs below its ends"),
}
_IGNORED_BY_A_CATENARY = {**_IGNORED_WITHOUT_NODES, "ground_sink": "the ground is rigid under this tether"}
_NO_WAVES = {
    "kite_damping": "axial damping of the tether at the kite end: 0, this tether has none",
    "solver_steps": "internal steps of a force-controlled drum since the start; otherwise 0",
    "solver_rejections": "rejected internal steps of such a drum since the start",
    "solver_iteration_limit": "bound on the iterations of fixed steps: 0, this tether has no waves",
    "fallback_steps": "fixed steps since the start that fell back to backward Euler: 0, this tether has no waves",
}
_ONE_LINE = {
    **_NO_WAVES,
    "ground_tension": "tension at the ground end",
    "kite_tension": "tension at the kite end",
    "max_tension": "larger end tension",
    "peak_tension": "largest end tension since the last communication point",
    "slack_segments": "1 if the kite is closer than the unstretched length, else 0",
    "kite_end_mass": "tether mass lumped at the kite end: 0, the mass of this tether is not lumped",
}
_WEIGHT = "tension and half of the weight along the chord; negative at the lower end of a slack tether"
# of descriptions
_DRIVEN = "In: position and velocity of the kite (and of the ground end), wind, reel-out speed. "
_DRIVEN += "Out: force of the tether on kite and ground."

STRAIGHT = Variant(
    "straight",
    "Straight elastic line with weight and drag shared between its ends: tension of a taut tether at almost no cost. "
    f"{_DRIVEN}",
    has_nodes=False,
    has_waves=False,
    colour="orange",
    evidence_deviation=1e-6,
    ignored=_IGNORED_BY_A_STRAIGHT_LINE,
    meanings={
        **_ONE_LINE,
        "grounded_length": "unstretched length that touches the ground: 0, this tether ignores it",
        "ground_tension": f"force along the tether at the ground end: {_WEIGHT}",
        "kite_tension": f"force along the tether at the kite end: {_WEIGHT}",
        "kite_end_mass": "tether mass lumped at the kite end: half of the tether",
        "solver_iterations": "Newton iterations since the start: 0, this tether needs none",
        "sag": "largest distance of the tether from its chord: 0, this tether is straight",
    },
    depends_on={
        **dict.fromkeys(("ground_force", "kite_force"), (*STRETCH, *AIR)),
        **dict.fromkeys(("ground_tension", "kite_tension", "max_tension", "peak_tension"), STRETCH),
        **dict.fromkeys(("tether_length", "kite_end_mass", "kite_stiffness", "slack_segments"), STRETCH),
        "ground_elevation": POSITIONS,
        "ground_azimuth": tuple(f"{end}[{i}]" for end in POSITIONS for i in (1, 2)),
        "kite_damping": (),
        "grounded_length": (),
        "wave_time": STRETCH,
        "sag": (),
        "shape": tuple(f"{end}[*]" for end in POSITIONS),
    },
)
CATENARY = Variant(
    "catenary",
    "Elastic catenary under weight plus mean drag, in closed form: sag and end forces at rest or in slow flight. "
    f"On the ground full friction holds it, from the end that hangs higher. {_DRIVEN}",
    has_nodes=False,
    has_waves=False,
    colour="green",
    evidence_deviation=1e-6,
    has_kink=False,
    ignored=_IGNORED_BY_A_CATENARY,
    meanings=_ONE_LINE,
    depends_on={"kite_damping": (), "kite_end_mass": ()},
)
QUASI_STEADY = Variant(
    "quasi_steady",
    "Quasi-steady segmented tether: in instantaneous equilibrium under weight, drag, elasticity and the inertia of "
    f"turning with the kite; no waves. On the ground friction acts on nodes that slide. {_DRIVEN}",
    has_nodes=True,
    has_waves=False,
    colour="blue",
    evidence_deviation=1e-6,
    ignored=_IGNORED_WITHOUT_WAVES,
    meanings=_NO_WAVES,
    depends_on={"kite_damping": ()},
)
DYNAMIC = Variant(
    "dynamic",
    "Dynamic segmented tether between two driven ends: lumped masses, spring-damper segments, drag, reel-out. "
    f"On the ground it starts without friction. {_DRIVEN}",
    has_nodes=True,
    has_waves=True,
    colour="vermillion",
    evidence_deviation=5e-3,
)
DYNAMIC_FREE = replace(
    DYNAMIC,
    name="dynamic_free",
    description=(
        "Dynamic segmented tether with a free kite end, a point mass that moves under the tether, its weight and a load: "
        "lumped masses, spring-damper segments, drag, reel-out. "
        "In: load on the kite, position and velocity of the ground end, wind, reel-out speed. "
        "Out: position and velocity of the kite, force of the tether on kite and ground."
    ),
    library="dynamic",
    kite_is_free=True,
    colour="purple",
    evidence_tolerance=1e-7,  # a free kite remembers each snap of a tether of one segment
    depends_on={"kite_position": WHERE_KITE_RESTS, "kite_velocity": ("kite_velocity[*]", "kite_start")},
)

TABLE = (STRAIGHT, CATENARY, QUASI_STEADY, DYNAMIC, DYNAMIC_FREE)  # from coarse to fine
BY_NAME = {each.name: each for each in TABLE}
EVERY_VARIANT = tuple(BY_NAME)
VARIANTS = tuple(each.name for each in TABLE if not each.kite_is_free)  # with driven ends; each has a library


def class_name(variant):
    """Name of the FMU of a variant, and of its classes: "TetherQuasiSteady" of "quasi_steady"."""
    return "Tether" + "".join(word.capitalize() for word in variant.split("_"))


def library_of(variant):
    """The variant with the compiled library of a variant: itself, or its driven counterpart."""
    return BY_NAME[variant].library or variant


def variant_of(text, variants=EVERY_VARIANT, others=""):
    """The variant that a text names, as "quasi_steady", "quasi-steady" or "TetherQuasiSteady"; ValueError if none.

    others : other choices, in words.
    """
    letters = "".join(character for character in text.lower() if character not in "_- ").removeprefix("tether")
    for variant in variants:
        if letters == variant.replace("_", ""):
            return variant
    allowed = ", ".join(f"{variant} ({class_name(variant)})" for variant in variants)
    raise ValueError(f"no tether is called {text}{meant(letters, variants) or f'; choose from {allowed}{others}'}")
