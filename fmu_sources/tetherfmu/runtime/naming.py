"""Suggestions for unknown names from users, and prefixes for error messages."""

import re
from contextlib import contextmanager
from dataclasses import fields
from functools import wraps

# other programs' names for possible names here; known ones are suggested
OTHERS = {
    "step": "dt",
    "fixed_step": "dt",
    "communication_step": "dt",
    "initial_length": "l0 l_tether length rest_length unstretched_length",
    "tether_length": "length unstretched_length",
    "kite_mass": "mass",
    "mass_per_length": "linear_density mass mass_per_meter",
    "density": "rho rho_tether",
    "air_density": "rho rho_0",
    "aarch64-darwin": "mac macos",
    "axial_damping": "ba damping",
    "axial_stiffness": "c_spring ea stiffness",
    "diameter": "d d_tether",
    "drag_coefficient": "cd cd_tether cdn",
    "gravity": "g",
    "ground": "ground_position",
    "kite": "kite_position",
    "reel_out_speed": "v_reel_out v_ro",
    "relative_tolerance": "rel_tol rtol",
    "surface_roughness": "z0",
    "wind_exponent": "alpha",
    "wind_profile": "profile_law",
    "wind_reference_height": "h_ref",
    "wind_velocity": "v_wind wind_speed",
    "x86_64-darwin": "darwin64",
    "x86_64-linux": "linux64",
    "x86_64-windows": "win64",
}
WORDS_OF_OTHERS = " ".join(OTHERS.values()).split()
ELSEWHERE = {each: " ".join(name for name, words in OTHERS.items() if each in words.split()) for each in WORDS_OF_OTHERS}
MOST, SHORTEST = 4, 3  # number of suggested names; letters of a shortened word
LONGEST_NAME = 100  # characters: file systems allow some 255 for the name of a file, which has more than this in it
WORDS = re.compile("[a-z0-9]+")


@contextmanager
def prefixed(text, kind=ValueError):
    """Convert a ValueError of the block to another class, with a prefix that names its subject."""
    try:
        yield
    except ValueError as problem:
        raise kind(f"{text}{problem}") from None


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
    """Text that suggests a similar known name; "" if there is none."""
    *others, last = candidates(name, known) or [""]
    return f"; did you mean {' or '.join([*([', '.join(others)] if others else []), last])}?" if last else ""


def meant_or_all(name, known, shown="there are {}"):
    """Text that suggests a similar known name, or lists all known names, as `shown`."""
    return meant(name, known) or f"; {shown.format(', '.join(known))}"


def shortened(name):
    """A value that should be a name as Python writes it; a long text with how long it is instead of its end."""
    long = isinstance(name, str) and len(name) > LONGEST_NAME
    return f"{name[:20]!r}... ({len(name)} characters)" if long else repr(name)


def check_names(owner, given, known, what="input"):
    """TypeError if a class or a function has no `what` with one of the given names; known : its names."""
    for name in given:
        if name not in known:
            raise TypeError(f"{owner} has no {what} {name!r}{meant_or_all(name, known)}")


def names_checked(record, known=None):
    """Make the constructor of a record (modified) report unknown names with a suggestion; returns the record.

    known : its names, None for its fields.
    """
    make, known = record.__init__, known or [each.name for each in fields(record) if each.init]

    @wraps(make)
    def __init__(self, *values, **named):
        check_names(record.__name__, named, known, "argument")
        make(self, *values, **named)

    record.__init__ = __init__
    return record
