"""Does the scene advisor keep its word? Both advices in fresh random scenes, against finer references than its own.

    python tests/benchmarks/advice.py 1001 2001 [--scenes 15] [--allowed 0.03 0.01]

The numbers are seeds of `random_scenes`. Each scene is asked for with each allowed error. Printed are a line for each case
and a table: how often the allowed error was said to be met and was not, how often the true error lay within the two that
were given, and the time of the processor. Fifteen scenes take some two minutes, most of them for their references.
"""

import argparse
import sys
from pathlib import Path

from tetherfmu.records.problems import StepRefused
from tetherfmu.study.advice.tradeoff import REFERENCE_ERROR
from tetherfmu.study.measuring.errors import converged
from tetherfmu.study.measuring.tables import circumstances, markdown, percent

sys.path[:0] = [str(Path(__file__).resolve().parents[2] / "docs" / "make")]

from advice.page import NAMES, asking, judged, summary  # noqa: E402
from advice.random_scenes import random_scenes  # noqa: E402


def line(seed, found):
    """A verdict of `judged` for people."""
    texts = [
        f"{'met' if each['met'] else 'WRONG' if each['wrong'] else 'not said to be met'}, "
        f"{percent(each['least'])} to {percent(each['expected'])} said, {percent(each['error'])} true, "
        f"{each['seconds']:.2f} s, {each['tried']} tried"
        for each in (found, found["fast"])
    ]
    return f"{seed}: {found['scene']}, {percent(found['allowed'])} allowed: {texts[0]}; fast: {texts[1]}"


def verdicts(seed, count, allowed):
    """`judged` for the scenes of a seed, one after the other."""
    for scene in random_scenes(count, seed):
        try:
            reference = converged(asking(scene, allowed[0]), REFERENCE_ERROR, NAMES)
        except StepRefused as refusal:
            print(f"{seed}: {scene.name}: no reference: {refusal}", flush=True)
            continue
        for level in allowed:
            found = judged(asking(scene, level), reference)
            print(line(seed, found), flush=True)
            yield found


def main():
    """Judge the scenes of all seeds and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("seeds", type=int, nargs="+", metavar="SEED")
    parser.add_argument("--scenes", type=int, default=15, help="of each seed")
    parser.add_argument("--allowed", type=float, nargs="+", default=[0.03, 0.01], help="errors of the force on the kite")
    options = parser.parse_args()
    found = [each for seed in options.seeds for each in verdicts(seed, options.scenes, options.allowed)]
    print("\n" + circumstances() + "\n\n" + markdown(summary(found)))


if __name__ == "__main__":
    main()
