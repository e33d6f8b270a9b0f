"""The examples: those of a checkout, or those that a wheel carries."""

import sys
from importlib import import_module

from tetherfmu.libraries.sources import PACKAGE

IN_CHECKOUT, IN_WHEEL = PACKAGE.parents[1] / "examples", PACKAGE / "examples"


def folder():
    """Path of the examples."""
    return IN_WHEEL if IN_WHEEL.exists() else IN_CHECKOUT


def example(name, room="."):
    """Module of an example; room : its folder in that of the examples."""
    sys.path.insert(0, str(folder() / room))
    return import_module(name)
