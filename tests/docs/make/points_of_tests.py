"""Points of the stability map, and what stands for their judgement.

Apart from the tests, because each process of a map imports this and should not have to import more than it needs.
"""

import os
import time
from pathlib import Path

from stability.flight import Verdict
from stability.points import point

POINTS = [point(1, number) for number in range(400)]
DEADLY, ENDLESS = POINTS[5], POINTS[3]
ENDED = "FILE_OF_THE_POINT_THAT_ENDED"  # environment variable


def judge_or_die(chosen):
    """Stands for a point that takes its process with it."""
    if chosen == DEADLY:
        os._exit(3)
    return Verdict("converged", 0.0, calls=1)


def judge_or_hang(chosen):
    """Stands for a point that never ends; if it does after all, it leaves a file."""
    if chosen == ENDLESS:
        time.sleep(600.0)
        Path(os.environ[ENDED]).touch()
    return Verdict("converged", 0.0, calls=1)
