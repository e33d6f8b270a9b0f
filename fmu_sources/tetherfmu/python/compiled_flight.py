"""Many communication steps in one call of compiled code: implementation of `fly` for tethers and systems."""

from array import array
from time import perf_counter
from typing import NamedTuple

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.instance import address
from tetherfmu.runtime.status import code

from .results import Refusal

ON_REFUSAL = ("raise", "stop", "skip")
SPAN = 1000  # approximate number of steps with all rows in memory


class Rows(NamedTuple):
    """Recorded rows of a flight, one for each kept step.

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
    if np.ndim(step) or winds is not None or skip:
        rows, refusals = _in_pieces(instance, inputs, step, winds, every, outputs, skip)
    else:
        done, rows = _run(instance, inputs, step, every, outputs)
        refusals = (_refusal(instance, inputs, step, done),) if done < len(inputs) else ()
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
    rows = np.zeros((count + 1, _places(instance, outputs)[1][-1]))  # the last one for scratch
    arrays = instance.plan, instance.parameters, instance.state, instance.before, instance.work
    plan, parameters, state, before, work = map(address, arrays)
    flight = inputs.ctypes.data, len(inputs), step, every, outputs
    done = instance.kernels.fly(plan, parameters, *flight, state, before, rows.ctypes.data, work)
    return done, rows[: done // every if every else 0]


def _refusal(instance, inputs, step, place):
    """`Refusal` of a step that was refused: done again alone, it is refused with its sentence."""
    instance.values[: instance.outputs_at] = array("d", inputs[place])
    return Refusal(place, instance.advance(step), code(instance.status))


def _in_pieces(instance, inputs, step, winds, every, outputs, skip):
    """Rows, and a tuple of the `Refusal` of each refused step; handles skipped steps, varying steps [s], winds at nodes.

    A piece ends at the next refused step; it is one step if step or winds vary.
    """
    steps, longest = np.broadcast_to(step, len(inputs)), 1 if np.ndim(step) or winds is not None else len(inputs)
    span, refusals = max(every, SPAN - SPAN % every) if every else max(1, len(inputs)), []
    kept = [np.zeros((0, _places(instance, outputs)[1][-1]))]
    for first in range(0, len(inputs), span):
        count, k = min(span, len(inputs) - first), 0
        rows = np.full((count if every else 0, kept[0].shape[1]), np.nan)
        while k < count:
            parameters, piece = instance.parameters[:], inputs[first + k : first + min(k + longest, count)]
            if winds is not None:
                put_node_winds(instance, winds[first + k])
            done, flown = _run(instance, piece, float(steps[first + k]), 1 if every else 0, outputs)
            rows[k : k + len(flown)] = flown
            k += done
            if done < len(piece):
                refusals.append(_refusal(instance, inputs, float(steps[first + k]), first + k))
                instance.parameters[:] = parameters  # the winds of before
                if not skip:
                    return np.concatenate([*kept, _every(instance, rows[:k], every, outputs)]), tuple(refusals)
                k += 1
        kept.append(_every(instance, rows, every, outputs))
    return np.concatenate(kept), tuple(refusals)


def put_node_winds(instance, winds, line=0):
    """Give a line of an `Instance` (modified) the wind at each node [m/s], array (segments + 1, 3)."""
    parameters, first = np.frombuffer(instance.parameters_of(line)), at.node_winds_at(instance.counts[line])
    parameters[first : first + winds.size] = winds.T.ravel()
    parameters[at.WIND_PROFILE] = at.AT_NODES


def _every(instance, rows, every, outputs):
    """Of the rows of all steps every n-th one, with the largest peaks since the row before."""
    if not every:
        return rows
    kept = rows[every - 1 :: every].copy()
    if outputs == at.ALWAYS:
        first, (end, *_) = _places(instance, outputs)
        peaks = rows[: len(kept) * every, first:end].reshape(len(kept), every, end - first)
        kept[:, first:end] = np.where(np.isnan(peaks[:, -1]), np.nan, np.fmax.reduce(peaks, axis=1))
    return kept
