"""Count the work of a lesson: evaluations of the right-hand side by `solve_ivp`, steps of tethers and of systems."""

import scipy.integrate

from tetherfmu import TetherSystem
from tetherfmu.python.tether_base import TetherModel

SPENT = {"evaluations": 0, "steps": 0}


def count():
    """Begin to count in this process; to be called before a lesson is imported."""
    solve = scipy.integrate.solve_ivp

    def solve_ivp(*arguments, **options):
        solved = solve(*arguments, **options)
        SPENT["evaluations"] += solved.nfev
        return solved

    scipy.integrate.solve_ivp = solve_ivp
    for kind in (TetherModel, TetherSystem):
        for name in ("initialize", "step", "fly"):
            setattr(kind, name, counted(getattr(kind, name)))


def counted(method):
    """A method of a tether or a system that adds the steps and iterations which a call takes."""

    def call(tether, *arguments, **options):
        before = 0 if method.__name__ == "initialize" else sum(tether.counters.values())
        try:
            return method(tether, *arguments, **options)
        finally:
            SPENT["steps"] += sum(tether.counters.values()) - before

    return call


def spent():
    """Evaluations and steps since this was last asked."""
    found = tuple(SPENT.values())
    SPENT.update(dict.fromkeys(SPENT, 0))
    return found
