"""Progress messages of a command."""

import sys


def now(text):
    """Say on a terminal what begins, where it takes more than a moment."""
    if sys.stderr.isatty():
        print(f"{text} ...", file=sys.stderr, flush=True)
