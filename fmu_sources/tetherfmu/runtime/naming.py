"""Names that users give, and that do not exist: what was probably meant."""

import re
from dataclasses import fields
from functools import wraps

# what others call it, and what it may be here: of these, that which is known is meant
ELSEWHERE = {
    "alpha": "wind_exponent",
    "ba": "axial_damping",
    "c_spring": "axial_stiffness",
    "cd": "drag_coefficient",
    "cd_tether": "drag_coefficient",
    "cdn": "drag_coefficient",
    "d": "diameter",
    "d_tether": "diameter",
    "damping": "axial_damping",
    "darwin64": "x86_64-darwin",
    "dt": "step fixed_step communication_step",
    "ea": "axial_stiffness",
    "g": "gravity",
    "ground_position": "ground",
    "h_ref": "wind_reference_height",
    "kite_position": "kite",
    "l0": "initial_length",
    "l_tether": "initial_length",
    "length": "initial_length tether_length",
    "linear_density": "mass_per_length",
    "linux64": "x86_64-linux",
    "mac": "aarch64-darwin",
    "macos": "aarch64-darwin",
    "mass": "kite_mass mass_per_length",
    "mass_per_meter": "mass_per_length",
    "profile_law": "wind_profile",
    "rel_tol": "relative_tolerance",
    "rest_length": "initial_length",
    "rho": "density air_density",
    "rho_0": "air_density",
    "rho_tether": "density",
    "rtol": "relative_tolerance",
    "stiffness": "axial_stiffness",
    "unstretched_length": "initial_length tether_length",
    "v_reel_out": "reel_out_speed",
    "v_ro": "reel_out_speed",
    "v_wind": "wind_velocity",
    "win64": "x86_64-windows",
    "wind_speed": "wind_velocity",
    "z0": "surface_roughness",
}
MOST, SHORTEST = 4, 3  # names that are asked for, letters of a word that is cut short
LONGEST_NAME = 100  # characters: file systems allow some 255 for the name of a file, which has more than this in it
WORDS = re.compile("[a-z0-9]+")


def begins(word, words):
    """Whether a word is among others, or is one of them cut short."""
    return any(each == word or (len(word) >= SHORTEST and each.startswith(word)) for each in words)


def candidates(name, known):
    """Those of the known names that were probably meant, a list of at most `MOST`."""
    from difflib import get_close_matches  # rarely needed

    known, name = list(known), name.lower()
    found = [each for each in ELSEWHERE.get(name, "").split() if each in known]
    words = WORDS.findall(name)
    having = [each for each in known if words and all(begins(word, WORDS.findall(each.lower())) for word in words)]
    return found or (having if len(having) <= MOST else []) or get_close_matches(name, known, 1)


def meant(name, known):
    """Words that ask for the known name which was probably meant; "" if none is near."""
    *others, last = candidates(name, known) or [""]
    return f"; did you mean {' or '.join([*([', '.join(others)] if others else []), last])}?" if last else ""


def meant_or_all(name, known, shown="there are {}"):
    """Words that ask for the known name which was probably meant, or say which there are, as it is `shown`."""
    return meant(name, known) or f"; {shown.format(', '.join(known))}"


def shortened(name):
    """A value that should be a name as Python writes it; a long text with how long it is instead of its end."""
    long = isinstance(name, str) and len(name) > LONGEST_NAME
    return f"{name[:20]!r}... ({len(name)} characters)" if long else repr(name)


def check_names(owner, given, known, what="input"):
    """TypeError if a class or a function has no `what` of a name among those that are given; known : those that it has."""
    for name in given:
        if name not in known:
            raise TypeError(f"{owner} has no {what} {name!r}{meant_or_all(name, known)}")


def names_checked(record, known=None):
    """Let the constructor of a record (modified) say which name it has not, and which was probably meant; the record.

    known : the names that it has, None for those of its fields.
    """
    make, known = record.__init__, known or [each.name for each in fields(record) if each.init]

    @wraps(make)
    def __init__(self, *values, **named):
        check_names(record.__name__, named, known, "argument")
        make(self, *values, **named)

    record.__init__ = __init__
    return record
