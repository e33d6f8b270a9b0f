"""The examples of a checkout or a wheel. Their rooms are packages in one folder."""

import sys
from importlib import import_module

from .sources import PACKAGE

IN_WHEEL = PACKAGE / "examples"
EXAMPLES = IN_WHEEL if IN_WHEEL.exists() else PACKAGE.parents[1] / "examples"  # in a checkout they are beside the package


def example(name):
    """Module of an example, such as `coupling.mooring`; the examples import each other by the same names."""
    if str(EXAMPLES) not in sys.path:
        sys.path.insert(0, str(EXAMPLES))
    return import_module(name)
