"""What a replay was like: its finest tether, whether that was slack, and its errors for people."""

from . import runs


def words(name):
    """Name of a tether for people."""
    return name.replace("_", "-")


def finest(made):
    """The name of the finest tether of a `Replay`, and its `runs.Flown`."""
    name = runs.finest(made.flown)
    return name, made.flown[name]


def is_slack(made):
    """Where the finest tether is slack, or lies on the ground, array (times,) of bool."""
    table = finest(made)[1].table
    return ~made.flight.is_taut(table.tether_length.to_numpy()) | (table.grounded_length.to_numpy() > 0.0)


def slack_share(made):
    """Share of the time in which the finest tether is slack, or lies on the ground."""
    return float(is_slack(made).mean())


def rounded(errors):
    """A table of errors, see `comparison.errors`, for people: lengths to 1 cm, tensions to three digits, and to 0.1 N."""
    table = errors.copy()
    for head in table.columns:
        if head.endswith(" m"):
            table[head] = table[head].round(2) + 0.0  # not -0
        elif head.endswith(" N"):
            table[head] = table[head].map(lambda force: round(float(f"{force:.3g}"), 1) + 0.0)
    return table
