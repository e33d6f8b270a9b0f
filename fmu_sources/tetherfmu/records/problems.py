"""Refusals and warnings of a tether."""

from tetherfmu.runtime.status import code


class PlausibilityWarning(UserWarning):
    """An implausible value; one warning since `initialize`, which does not affect results.

    A stretch beyond 5 %, an end that is accelerated beyond 1000 g or faster than sound, velocities that contradict
    positions; docs/models/theory.md, "Plausibility".

    Examples
    --------
    >>> import warnings
    >>> from tetherfmu import TetherStraight
    >>> with warnings.catch_warnings(record=True) as given:
    ...     start = TetherStraight(initial_length=100.0).initialize(kite_position=(300.0, 0.0, 400.0))
    >>> given[0].category.__name__
    'PlausibilityWarning'
    """


class StepRefused(ValueError):
    """A refused step or initialization; the tether keeps its previous state.

    Attributes
    ----------
    status : int or None
        Code of `tetherfmu.runtime.status`, such as `NO_EQUILIBRIUM`; None if no kernel was called.
    flown : Flown or None
        Of a flight: its rows before the step that was refused.

    Examples
    --------
    >>> from tetherfmu import TetherStraight
    >>> try:
    ...     TetherStraight().step(0.02)
    ... except StepRefused as refusal:
    ...     print(refusal)
    this TetherStraight is not initialized: call initialize first
    """

    def __init__(self, message: str, status: int | None = None, flown: tuple | None = None):
        super().__init__(message)
        self.flown = flown
        self.status = None if status is None else code(status)
