"""Winches that drive several lines of a system, each with a ratio: one drum turns all of them.

A winch at the speed w pays out a line with a ratio r at r w; payouts of several winches on a line are summed. With
the matrix R of ratios (lines, winches) the reel-out speeds of lines are R w, their lengths initial_length + R p, with the
payouts p of the winches. These follow from the lines with the shares S = (R^T R)^-1 R^T: p = S (length - initial_length).

The tensions T of its lines drive a force-controlled winch: m w' = R^T T - W - c w - F sign(w); the
kernels store its drum with one of its lines, its carrier.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ..runtime import layout as at
from ..runtime.naming import meant_or_all, names_checked, prefixed
from ..runtime.parameters import Winch
from ..runtime.quantities import quantities
from .lines import Line, check_inputs, checked_name, first_input

BY_SPEED, BY_FORCE, BY_LENGTH = "speed", "force", "length"
GIVEN = {BY_SPEED: "reel_out_speed", BY_FORCE: "winch_force", BY_LENGTH: "winch_length"}  # input of each control
QUANTITIES_OF_A_WINCH = dict(quantities(Winch))
CONTROL = QUANTITIES_OF_A_WINCH["winch_control"].numbers
LEAST_TO_BREAK = 3  # segments of a portion that may break, see `kernels/equations/parts.py`
SMALLEST_RATIO, LARGEST_RATIO = 1e-3, 1e3
# quantities of a `Winch` that a shared one has, if it is controlled by force
OF_A_DRUM = ("winch_mass", "winch_damping", "winch_friction", "winch_start")


def of_a_winch(name):
    """Field of a record for a quantity of a `Winch`."""
    return field(default=getattr(Winch, name), metadata={"quantity": QUANTITIES_OF_A_WINCH[name]})


@names_checked
@dataclass(frozen=True)
class SharedWinch:
    """A winch that holds several lines of a system, at their starts. ValueError if a name or a number is wrong.

    Parameters
    ----------
    name : str
        Letters, digits and underscores.
    lines : dict of str to float
        Names of lines and their ratios: rope of the line for each metre that the winch pays out; negative if it then reels
        in. A line may be in several winches, whose payouts are summed. It has no other winch.
    control : "speed", "force" or "length"
        Its input: `reel_out_speed`; `winch_force`, which the sum of tensions times ratios has to overcome [N]; or
        `winch_length`, the length paid out since the start [m].
    reel_out_speed : float
        At the start [m/s], whatever the control; positive pays out.
    winch_force : float
        At the start [N], with the control "force"; positive reels in.
    winch_mass, winch_damping, winch_friction : float
        Drum properties as in `Winch`, with the control "force" [kg], [N.s/m], [N].
    winch_start : "given" or "equilibrium"
        With the control "force": no initial payout, or the payout at which the drum is in balance with `winch_force`
        while its lines and the free points without position are in equilibrium.

    Examples
    --------
    >>> SharedWinch("steering", {"left": 1.0, "right": -1.0}, control="length").input
    'winch_length'
    """

    name: str
    lines: Mapping[str, float]
    control: str = BY_SPEED
    reel_out_speed: float = first_input("m/s", "at the start; positive pays out")
    winch_force: float = first_input("N", "at the start; positive reels in")
    winch_mass: float = of_a_winch("winch_mass")
    winch_damping: float = of_a_winch("winch_damping")
    winch_friction: float = of_a_winch("winch_friction")
    winch_start: int | str = of_a_winch("winch_start")

    def __post_init__(self):
        checked_name("winch", self.name)
        if self.control not in tuple(GIVEN):
            raise ValueError(f"{self.name}.control is {self.control!r}; it must be {' or '.join(map(repr, GIVEN))}")
        if not isinstance(self.lines, Mapping) or not self.lines:
            raise ValueError(f"{self.name}.lines is {self.lines!r}; it must have names of lines, each with its ratio")
        for line, ratio in self.lines.items():
            is_number = isinstance(ratio, int | float) and not isinstance(ratio, bool)
            if not (is_number and SMALLEST_RATIO <= abs(ratio) <= LARGEST_RATIO):
                raise ValueError(
                    f"{self.name}.lines.{line} is {ratio!r}; it must be a number between {SMALLEST_RATIO:g} and "
                    f"{LARGEST_RATIO:g}, or the negative of one"
                )
        if self.control == BY_FORCE and all(ratio < 0.0 for ratio in self.lines.values()):
            raise ValueError(
                f"{self.name}.lines has the ratios {list(self.lines.values())}; with the control 'force' one of "
                "them must be above 0: reverse all signs"
            )
        check_inputs(self, "reel_out_speed", "winch_force")
        with prefixed(f"{self.name}."):
            object.__setattr__(self, "winch_start", self.drum.winch_start)
        for name in ("winch_force", *OF_A_DRUM):
            if getattr(self, name) != getattr(SharedWinch, name) and self.control != BY_FORCE:
                raise ValueError(
                    f"{self.name}.{name} is {getattr(self, name)!r} and has no effect: control is {self.control!r}"
                )

    @property
    def input(self) -> str:
        """Name of its input."""
        return GIVEN[self.control]

    @property
    def ratios(self) -> tuple[tuple[str, float], ...]:
        """Pairs of a line and its ratio."""
        return tuple((line, float(ratio)) for line, ratio in self.lines.items())

    @property
    def drum_names(self) -> tuple[str, ...]:
        """Names of the quantities of its drum, empty unless it is force-controlled."""
        return OF_A_DRUM if self.control == BY_FORCE else ()

    @property
    def drum(self) -> Winch:
        """`Winch` with its control and its drum."""
        return Winch(winch_control=self.control, **{name: getattr(self, name) for name in OF_A_DRUM})


def holding(winches, line):
    """The winches that drive a line with this name."""
    return [each for each in winches if line in each.lines]


def check_winches(winches: Sequence[SharedWinch], lines: Sequence[Line], taken: Sequence[str]) -> None:
    """ValueError, in words, unless winches match the lines of a system; taken : names of points and lines."""
    known, names = [line.name for line in lines], [*taken, *(each.name for each in winches)]
    for winch in winches:
        if names.count(winch.name) > 1:
            raise ValueError(f"the name {winch.name} is given twice; each point, line and winch needs a name of its own")
        for name in winch.lines:
            if name not in known:
                raise ValueError(
                    f"the winch {winch.name} holds the line {name}, which does not exist{meant_or_all(name, known)}"
                )
    for line in lines:
        held = holding(winches, line.name)
        check_drums(line, [each for each in held if each.control == BY_FORCE])
        if held and (line.winch != Winch() or line.reel_out_speed != 0.0):
            raise ValueError(f"the line {line.name} is held by the winch {held[0].name}; it can have no winch of its own")
        if len({each.control for each in held}) > 1:
            names = ", ".join(f"{each.name} ({each.control})" for each in held)
            raise ValueError(f"the line {line.name} is held by winches with different controls, {names}; give them the same")


def check_drums(line, held):
    """ValueError if a line cannot be held by winches that are controlled by force, a list."""
    if len(held) > at.MOST_HOLDERS:
        names = ", ".join(each.name for each in held)
        raise ValueError(f"the line {line.name} is held by {names} by force; it must be {at.MOST_HOLDERS} winches at most")
    if held:
        check_turned(line, f"{held[0].name} holds it by force")


def carriers_of(winches):
    """Of each winch that is controlled by force one of its lines, each another one: a dict of names.

    They exist, as no winch pays out what others do together.
    """
    found = {}

    def seek(winch, tried):
        for line in winch.lines:
            if line not in tried:
                tried.add(line)
                if line not in found or seek(found[line], tried):
                    found[line] = winch
                    return True
        return False

    for winch in winches:
        if winch.control == BY_FORCE:
            seek(winch, set())
    return {winch.name: line for line, winch in found.items()}


def check_with_sheaves(lines, winches):
    """ValueError if a system with sheaves or force-controlled shared winches uses unsupported features."""
    name = next((line.name for line in lines if line.through), None)
    why = f"{name} runs over sheaves"
    if name is None:
        name = next((each.name for each in winches if each.control == "force"), None)
        why = f"the winch {name} holds lines by force"
    if name is None:
        return
    for line in lines:
        if line.winch.winch_control == at.WINCH_BY_FORCE:
            check_turned(line, f"its winch is controlled by force, and {why}")
        if line.through:
            check_rope(line)


def check_rope(line):
    """ValueError if a line over sheaves has a law, or may break where it cannot."""
    first, *others = line.tethers
    if first.damping_law != at.STRAIN_RATE:
        raise ValueError(f"{line.name}.damping_law is stretch_rate; over sheaves it must be strain_rate")
    strength = max(each.breaking_force for each in line.tethers)
    if others and strength != 0.0:
        raise ValueError(
            f"{line.name}.breaking_force is {strength!r}, and {line.name} is of {len(line.tethers)} tethers in series over "
            "sheaves; it must be 0"
        )
    if strength != 0.0 and first.segments < LEAST_TO_BREAK:
        raise ValueError(
            f"{line.name}.segments is {first.segments}; over sheaves a line with breaking_force must have at least "
            f"{LEAST_TO_BREAK}"
        )


def check_turned(line, why):
    """ValueError if the tether of a line cannot be driven by a shared drum or one with sheaves; why : the reason."""
    for tether in line.tethers:
        if tether.damping_law != at.STRAIN_RATE:
            raise ValueError(f"{line.name}.damping_law is stretch_rate, and {why}; it must be strain_rate")
