"""Studies of the tethers: cost, required configuration of a scene, and sweeps. Only commands and `web` import it."""


def __getattr__(name):
    """Loads the function `sweep`, which needs the packages of the extra `study`, on first access."""
    if name != "sweep":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from .sweeps.sweep import sweep

    return sweep
