"""How often is a quasi-steady shape found, and how fast? Random tethers; a table by slack.

    python tests/benchmarks/robustness.py [--count N] [--seed S]

Cases: slack -1 to 50 % of the distance, wind 0 to 40 m/s and kite speed 0 to 80 m/s in any direction, the kite anywhere in
the upper half space, 10 to 800 m away and at least 5 m above the ground, 20 segments of the default 4 mm tether. Cold:
initialize. Warm: the next 20 ms. Times include the call from Python. Slack: shapes in which a segment is slack.
"""

from collections import namedtuple
from itertools import pairwise
from time import perf_counter

import numpy as np
from as_script import options

from tetherfmu import StepRefused, TetherQuasiSteady
from tetherfmu.runtime.parameters import Tether

STEP = 0.02
BANDS = (-0.01, 0.0, 0.02, 0.1, 0.3, 0.5)
Case = namedtuple("Case", "slack tether kite_position kite_velocity wind_velocity")
_FACTS = "case refusal positions iterations time slack refused_step next_positions next_iterations next_time"
Result = namedtuple("Result", _FACTS)
Result.__doc__ = """What came of a case: message of the refusal or None, node positions, Newton iterations and time [s] of
the cold start, whether it has a slack segment; then message, positions, iterations and time of the warm step."""


def random_direction(random):
    direction = random.normal(size=3)
    return direction / np.linalg.norm(direction)


def random_cases(count, seed):
    """`count` cases, always the same for a seed."""
    random = np.random.default_rng(seed)
    cases = []
    while len(cases) < count:
        distance = random.uniform(10.0, 800.0)
        kite = distance * random_direction(random) * (1.0, 1.0, np.sign(random.normal()))
        kite[2] = abs(kite[2])
        if kite[2] < 5.0:
            continue
        slack = random.uniform(-0.01, 0.5)
        tether = Tether(segments=20, initial_length=distance * (1.0 + slack))
        velocity = random.uniform(0.0, 80.0) * random_direction(random)
        wind = random.uniform(0.0, 40.0) * random_direction(random)
        cases.append(Case(slack, tether, kite, velocity, wind))
    return cases


def attempt(verb, *arguments, **inputs):
    """Message of the refusal (None: there was none) and the time [s] of a call."""
    start = perf_counter()
    try:
        verb(*arguments, **inputs)
        refusal = None
    except StepRefused as error:
        refusal = str(error)
    return refusal, perf_counter() - start


def solve(case):
    """`Result` of a case."""
    model = TetherQuasiSteady(case.tether)
    inputs = {name: getattr(case, name) for name in ("kite_position", "kite_velocity", "wind_velocity")}
    refusal, time = attempt(model.initialize, **inputs)
    iterations = model.counters["iterations"]
    if refusal:
        return Result(case, refusal, None, iterations, time, False, None, None, 0, 0.0)
    positions = model.positions
    slack = model.outputs().slack_segments > 0
    refused_step, next_time = attempt(model.step, STEP, **inputs)
    next_iterations = model.counters["iterations"] - iterations
    return Result(case, None, positions, iterations, time, slack, refused_step, model.positions, next_iterations, next_time)


def row(name, results):
    solved = [each for each in results if not each.refusal]
    stepped = [each for each in solved if not each.refused_step]
    cold, warm = np.array([each.time for each in results]) * 1e6, np.array([each.next_time for each in solved]) * 1e6
    figures = [
        100 * len(solved) / len(results),
        100 * sum(each.slack for each in solved) / len(solved),
        100 * len(stepped) / len(solved),
        max(each.iterations for each in results),
        max(each.next_iterations for each in solved),
        *np.percentile(cold, (50, 99)),
        *np.percentile(warm, (50, 99)),
    ]
    return f"{name:>12} {len(results):6}" + "".join(f"{figure:10.4g}" for figure in figures)


def table(results):
    """Rows by slack: solved cold, of these slack and solved warm [%], most iterations, median and 99th percentile [us]."""
    columns = ("cold %", "slack %", "warm %", "iter cold", "iter warm", "cold us", "p99", "warm us", "p99")
    lines = [f"{'slack':>12} {'cases':>6}" + "".join(f"{column:>10}" for column in columns)]
    for low, high in pairwise(BANDS):
        chosen = [each for each in results if low <= each.case.slack < high]
        if chosen:
            lines.append(row(f"{100 * low:3.0f} .. {100 * high:2.0f} %", chosen))
    return "\n".join([*lines, row("all", results)])


def main():
    given = options(__doc__, count=2000, seed=1)
    cases = random_cases(given.count, given.seed)
    solve(cases[0])  # compiles
    results = [solve(case) for case in cases]
    print(table(results))
    slowest = 1e3 * np.percentile([each.time for each in results], 99)
    print(f"99 % of the cold starts take less than {slowest:.2f} ms (bar: 5 ms)")


if __name__ == "__main__":
    main()
