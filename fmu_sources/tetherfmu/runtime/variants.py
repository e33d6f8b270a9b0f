"""The variants of the tether, and how people spell them."""

from dataclasses import replace

VARIANTS = ("straight", "catenary", "quasi_steady", "dynamic")  # with driven ends, from coarse to fine; each has a library
FREE = ("dynamic_free",)  # with a free kite end; the library is that of the driven variant
EVERY_VARIANT = (*VARIANTS, *FREE)
WITHOUT_NODES = ("straight", "catenary")
WITHOUT_WAVES = ("straight", "catenary", "quasi_steady")


def class_name(variant):
    """Name of the FMU of a variant, and of its classes: "TetherQuasiSteady" of "quasi_steady"."""
    return "Tether" + "".join(word.capitalize() for word in variant.split("_"))


def library_of(variant):
    """The variant whose compiled library serves a variant: its own, or that of the driven one."""
    return variant.removesuffix("_free")


def variant_of(text, variants=EVERY_VARIANT):
    """Which of some variants a text names, as "quasi_steady", "quasi-steady" or "TetherQuasiSteady"; ValueError if none."""
    letters = "".join(character for character in text.lower() if character not in "_- ").removeprefix("tether")
    for variant in variants:
        if letters == variant.replace("_", ""):
            return variant
    allowed = ", ".join(f"{variant} ({class_name(variant)})" for variant in variants)
    raise ValueError(f"no tether is called {text}; choose from {allowed}")


def effective(tether, variant):
    """The tether as a variant knows it: without damping where there are no waves, one segment where there are no nodes."""
    if variant in WITHOUT_WAVES:
        tether = replace(tether, axial_damping=0.0)
    if variant in WITHOUT_NODES:
        tether = replace(tether, segments=1)
    return tether
