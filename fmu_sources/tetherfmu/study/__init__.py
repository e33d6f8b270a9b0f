"""Studies of the tethers: what they cost, how much tether a scene needs, and sweeps. Only commands and `web` import it."""


def __getattr__(name):
    """The function `sweep`, which needs the packages of the extra `study`, when it is asked for."""
    if name != "sweep":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from .sweeps.sweep import sweep

    return sweep
