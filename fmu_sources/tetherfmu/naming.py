"""Names that users give, and that do not exist."""

from difflib import get_close_matches


def meant(name, known):
    """Words that ask for the known name which was probably meant; "" if none is near."""
    near = get_close_matches(name, known, 1)
    return f"; did you mean {near[0]}?" if near else ""


def check_names(owner, given, known):
    """TypeError if a class or a function has no input of a name among those that are given; known : those that it has."""
    for name in given:
        if name not in known:
            hint = meant(name, known) or f"; there are {', '.join(known)}"
            raise TypeError(f"{owner} has no input {name!r}{hint}")
