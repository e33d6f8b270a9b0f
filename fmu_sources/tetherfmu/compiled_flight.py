"""Many communication steps in one call of compiled code: what `TetherModel.fly` does."""

from array import array
from time import perf_counter

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.runtime.instance import address
from tetherfmu.runtime.status import code

from .results import Flown, Refusal

ON_REFUSAL = ("raise", "stop", "skip")
SPAN = 1000  # steps, about, whose rows are all kept at a time where refused steps are skipped


def fly(instance, inputs, step, every, outputs, skip=False, winds=None):
    """Fly an `Instance` (modified) until all steps are done or one is refused; returns the `Flown`.

    inputs : contiguous array (steps, INPUTS), with wind points three numbers more for each of them.  step : communication
    step [s], or an array of them.  every : a row is kept after every so many steps; 0 for none.
    outputs : when they are computed, `layout.NEVER`, `AT_ROWS` or `ALWAYS`.
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
    size = _observed(instance, outputs)
    positions = rows[:, size:].reshape(len(rows), instance.segments + 1, 3)
    if outputs == at.NEVER:
        return Flown(None, None, positions, seconds, refusals)
    return Flown(np.ascontiguousarray(rows[:, : size - 1]), rows[:, size - 1].copy(), positions, seconds, refusals)


def _observed(instance, outputs):
    """Numbers of a row before the node positions: outputs and peak, if there are any."""
    return at.outputs_size(instance.points) + 1 if outputs != at.NEVER else 0


def _run(instance, inputs, step, every, outputs):
    """How many steps were done until one was refused, and the rows until then, array (rows, numbers)."""
    width = _observed(instance, outputs) + 3 * (instance.segments + 1)
    rows = np.zeros((len(inputs) // every + 1 if every else 1, width))  # the last one is for scratch
    arrays = instance.parameters, instance.state, instance.before, instance.work
    parameters, state, before, work = map(address, arrays)
    flight = inputs.ctypes.data, len(inputs), step, every, outputs
    done = instance.kernels.fly(
        instance.segments, parameters, *flight, state, before, instance.points, rows.ctypes.data, work
    )
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
    width = _observed(instance, outputs) + 3 * (instance.segments + 1)
    kept = [np.zeros((0, width))]
    for first in range(0, len(inputs), max(1, span)):
        part = inputs[first : first + span]
        rows, k = np.full((len(part) if every else 0, width), np.nan), 0
        while k < len(part):
            done, flown = _run(instance, part[k:], step, 1 if every else 0, outputs)
            rows[k : k + len(flown)] = flown
            k += done + 1
            if k <= len(part):
                refusals.append(_refusal(instance, inputs, step, first + k - 1))
        kept.append(_every(rows, every, width - 3 * (instance.segments + 1), outputs) if every else rows)
    return np.concatenate(kept), tuple(refusals)


def _row_by_row(instance, inputs, steps, winds, every, outputs, skip):
    """Rows, and a tuple of the `Refusal` of each refused step, of steps [s] that differ or with winds at the nodes."""
    width = _observed(instance, outputs) + 3 * (instance.segments + 1)
    rows, refusals = np.full((len(inputs) if every else 0, width), np.nan), []
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
    if not every:
        return rows, tuple(refusals)
    return _every(rows, every, width - 3 * (instance.segments + 1), outputs), tuple(refusals)


def put_node_winds(instance, winds):
    """Give an `Instance` (modified) the wind at each node [m/s], array (segments + 1, 3)."""
    instance.parameters[-winds.size :] = array("d", winds.T.ravel())
    instance.parameters[at.WIND_PROFILE] = at.AT_NODES


def _every(rows, every, size, outputs):
    """Of the rows of all steps those after every so many, with the largest peak since the row before."""
    kept = rows[every - 1 :: every].copy()
    if outputs == at.ALWAYS:
        peaks = rows[: len(kept) * every, size - 1].reshape(len(kept), every)
        kept[:, size - 1] = np.where(np.isnan(peaks[:, -1]), np.nan, np.fmax.reduce(peaks, axis=1))
    return kept
