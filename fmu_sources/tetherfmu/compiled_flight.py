"""Many communication steps in one call of compiled code: what `fly` of a tether and of a system does."""

from array import array
from time import perf_counter
from typing import NamedTuple

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.instance import address
from tetherfmu.runtime.status import code

from .results import Refusal

ON_REFUSAL = ("raise", "stop", "skip")
SPAN = 1000  # steps, about, whose rows are all kept at a time where refused steps are skipped


class Rows(NamedTuple):
    """What was kept of a flight, a row for each kept step.

    outputs, peaks : (rows, outputs) of all lines, and the largest |kite_force| of each line since the row before [N], (rows,
    lines); None without them.  motion : of the nodes of each line [m], [m/s], a list of arrays (rows, 2, nodes, 3).
    """

    outputs: np.ndarray | None
    peaks: np.ndarray | None
    motion: list


def fly(instance, inputs, step, every, outputs, skip=False, winds=None):
    """Fly an `Instance` (modified) until all steps are done or one is refused: `Rows`, wall time [s], tuple of `Refusal`.

    inputs : contiguous array of a row for each step.  step : communication step [s], or an array of them.  every : a row is
    kept after every so many steps; 0 for none.  outputs : when they are computed, `layout.NEVER`, `AT_ROWS` or `ALWAYS`.
    skip : leave refused steps out, with NaN in their rows, instead of stopping there.  winds : at the nodes [m/s], array
    (steps, segments + 1, 3), or None. The inputs of the instance become those of the last step done.
    """
    before = instance.values[: instance.outputs_at]
    began = perf_counter()
    if np.ndim(step) or winds is not None:
        steps = np.broadcast_to(step, len(inputs))
        rows, refusals = _row_by_row(instance, inputs, steps, winds, every, outputs, skip)
    else:
        rows, refusals = (_skipping if skip else _until_refused)(instance, inputs, step, every, outputs)
    seconds = perf_counter() - began
    skipped = {refusal.step for refusal in refusals}
    end = min(skipped) if skipped and not skip else len(inputs)
    last = next((k for k in reversed(range(end)) if k not in skipped), None)
    instance.values[: instance.outputs_at] = before if last is None else array("d", inputs[last])
    return _cut(instance, rows, outputs), seconds, refusals


def _places(instance, outputs):
    """First places of the peaks, of the motion of each line, and the end of a row."""
    size, lines = instance.parameters_at - instance.outputs_at, len(instance.lines)
    peaks, motion = (size, size + lines) if outputs != at.NEVER else (0, 0)
    return peaks, [*np.cumsum([motion, *(6 * (segments + 1) for segments in instance.counts)]).tolist()]


def _width(instance, outputs):
    """Numbers of a row."""
    return _places(instance, outputs)[1][-1]


def _unflown(instance, count, outputs):
    """So many rows of NaN."""
    return np.full((count, _width(instance, outputs)), np.nan)


def _cut(instance, rows, outputs):
    """`Rows` of an array of them."""
    peaks, places = _places(instance, outputs)
    motion = [
        rows[:, first:end].reshape(len(rows), 2, segments + 1, 3)
        for first, end, segments in zip(places[:-1], places[1:], instance.counts, strict=True)
    ]
    if outputs == at.NEVER:
        return Rows(None, None, motion)
    return Rows(np.ascontiguousarray(rows[:, :peaks]), rows[:, peaks : places[0]].copy(), motion)


def _run(instance, inputs, step, every, outputs):
    """How many steps were done until one was refused, and the rows until then, array (rows, numbers)."""
    count = len(inputs) // every if every else 0
    rows = np.zeros((count + 1, _width(instance, outputs)))  # the last one for scratch
    arrays = instance.plan, instance.parameters, instance.state, instance.before, instance.work
    plan, parameters, state, before, work = map(address, arrays)
    flight = inputs.ctypes.data, len(inputs), step, every, outputs
    done = instance.kernels.fly(plan, parameters, *flight, state, before, rows.ctypes.data, work)
    return done, rows[: done // every if every else 0]


def _refusal(instance, inputs, step, place):
    """`Refusal` of a step that was refused: done again alone, it is refused with its sentence."""
    instance.values[: instance.outputs_at] = array("d", inputs[place])
    return Refusal(place, instance.advance(step), code(instance.status))


def _until_refused(instance, inputs, step, every, outputs):
    """Rows, and a tuple of the `Refusal` that ended the flight, or none."""
    done, rows = _run(instance, inputs, step, every, outputs)
    return rows, (_refusal(instance, inputs, step, done),) if done < len(inputs) else ()


def _skipping(instance, inputs, step, every, outputs):
    """Rows, and a tuple of the `Refusal` of each step that was left out."""
    span, refusals = max(every, SPAN - SPAN % every) if every else len(inputs), []
    kept = [_unflown(instance, 0, outputs)]
    for first in range(0, len(inputs), max(1, span)):
        part = inputs[first : first + span]
        rows, k = _unflown(instance, len(part) if every else 0, outputs), 0
        while k < len(part):
            done, flown = _run(instance, part[k:], step, 1 if every else 0, outputs)
            rows[k : k + len(flown)] = flown
            k += done + 1
            if k <= len(part):
                refusals.append(_refusal(instance, inputs, step, first + k - 1))
        kept.append(_every(instance, rows, every, outputs))
    return np.concatenate(kept), tuple(refusals)


def _row_by_row(instance, inputs, steps, winds, every, outputs, skip):
    """Rows, and a tuple of the `Refusal` of each refused step, of steps [s] that differ or with winds at the nodes."""
    rows, refusals = _unflown(instance, len(inputs) if every else 0, outputs), []
    for k in range(len(inputs)):
        parameters = instance.parameters[:]
        if winds is not None:
            put_node_winds(instance, winds[k])
        done, flown = _run(instance, inputs[k : k + 1], float(steps[k]), 1 if every else 0, outputs)
        if done:
            rows[k : k + len(flown)] = flown
        else:
            refusals.append(_refusal(instance, inputs, float(steps[k]), k))
            instance.parameters[:] = parameters  # the winds of before
            if not skip:
                rows = rows[:k]
                break
    return _every(instance, rows, every, outputs), tuple(refusals)


def put_node_winds(instance, winds, line=0):
    """Give a line of an `Instance` (modified) the wind at each node [m/s], array (segments + 1, 3)."""
    parameters, end = np.frombuffer(instance.parameters_of(line)), at.parameters_size(instance.counts[line])
    parameters[end - winds.size : end] = winds.T.ravel()
    parameters[at.WIND_PROFILE] = at.AT_NODES


def _every(instance, rows, every, outputs):
    """Of the rows of all steps those after every so many, with the largest peaks since the row before."""
    if not every:
        return rows
    kept = rows[every - 1 :: every].copy()
    if outputs == at.ALWAYS:
        first, (end, *_) = _places(instance, outputs)
        peaks = rows[: len(kept) * every, first:end].reshape(len(kept), every, end - first)
        kept[:, first:end] = np.where(np.isnan(peaks[:, -1]), np.nan, np.fmax.reduce(peaks, axis=1))
    return kept
