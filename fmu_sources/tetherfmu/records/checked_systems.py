"""Checks points, lines and shared winches for consistency, and computes the shares of lines in a winch payout."""

from dataclasses import replace

import numpy as np

from tetherfmu.runtime.parameters import Environment, Ground, Solver
from tetherfmu.wiring.lines import Line, Point, check_system, record_of
from tetherfmu.wiring.winches import SharedWinch, check_winches, check_with_sheaves

from . import arguments

DEPENDENT = 1e-9  # a singular value of the matrix of ratios below this part of the largest counts as zero


def checked_system(system):
    """A `System` with the shares of its winches; TypeError or ValueError, in words, if it is inconsistent."""
    kinds = {"points": Point, "lines": Line, "winches": SharedWinch}
    given = {name: arguments.records_of(name, getattr(system, name), kind) for name, kind in kinds.items()}
    system = replace(system, **given)
    check_system(system.points, system.lines)
    check_winches(system.winches, system.lines, [each.name for each in (*system.points, *system.lines)])
    held, _, rows = shares_of(system.winches)
    shares = tuple(tuple((line, share) for line, share in zip(held, row, strict=True) if share) for row in rows.tolist())
    for name, kind in {"environment": Environment, "solver": Solver, "ground": Ground}.items():
        record_of("TetherSystem", getattr(system, name), kind)
    for line in system.lines:
        arguments.tethers_of("Line", line.tether)
    check_with_sheaves(system.lines, system.winches)
    wind_points = arguments.wind_points(system.wind_points)
    arguments.check_wind(system.environment, wind_points)
    return replace(system, shares=shares, wind_points=wind_points)


def shares_of(winches):
    """Names of the lines on shared winches, ratios (lines, winches) and shares (winches, lines).

    ValueError if winches have the same lines in the same ratios.
    """
    held = list(dict.fromkeys(name for each in winches for name in each.lines))
    ratios = np.zeros((len(held), len(winches)))
    for j, each in enumerate(winches):
        ratios[[held.index(name) for name in each.lines], j] = list(each.lines.values())
    if winches:
        values = np.linalg.svd(ratios, compute_uv=False)
        if len(held) < len(winches) or values[-1] < DEPENDENT * values[0]:
            raise ValueError(
                f"the winches {', '.join(each.name for each in winches)} hold the same lines in the same "
                "ratios, so that their payouts cannot be distinguished; omit one"
            )
    return held, ratios, np.linalg.pinv(ratios) if winches else ratios.T
