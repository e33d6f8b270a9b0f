"""Progress messages of a command."""

import sys


def now(text):
    """Print the current task on a terminal, if it needs more than a moment."""
    if sys.stderr.isatty():
        print(f"{text} ...", file=sys.stderr, flush=True)
