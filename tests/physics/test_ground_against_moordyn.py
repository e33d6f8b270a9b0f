"""The dynamic tether on a flat ground against MoorDyn: a drop, a lift, a drag over the ground.

Scenes, laws and settings: benchmarks/moordyn_ground.py, which wrote the files. MoorDyn is a peer: its time step is converged
(1e-3 N), and at rest and while sliding both laws are the same. Where a node lands or leaves they differ by the damper of the
ground: MoorDyn's acts in full at once and pulls at nodes that leave. With half of that damper MoorDyn differs from itself,
over a whole scene, by 0.14 N (drop) and 0.5 N (lift), root mean square; we from it by 0.6 and 0.8 N. An independent chain
with MoorDyn's law differs from it by 0.07 and 0.05 N, so nothing but the law matters (`moordyn_ground.py --law`).
"""

import numpy as np
import pytest

from benchmarks.moordyn_ground import COLUMNS, FRICTION, SINK, TETHER, ours
from mechanics import line_density
from scenes import read

WEIGHT = 9.81 * line_density(TETHER)  # [N/m]
SEGMENT = TETHER.initial_length / TETHER.segments
TENSIONS, LYING, NODES = slice(1, 3), 3, slice(4, None)


def flown(name):
    """Times [s], our rows with steps of 5 ms, and MoorDyn's."""
    columns = read(f"moordyn_{name}.csv")
    theirs = np.column_stack([columns[each] for each in COLUMNS])
    found = ours(name, 0.005)[0]
    np.testing.assert_allclose(found[:, 0], theirs[:, 0], atol=1e-9)
    return theirs[:, 0], found, theirs


def rms(difference):
    return np.sqrt(np.mean(difference**2))


def test_a_drop():
    """The same until it lands, and again when it lies; its hanging ends swing on, undamped."""
    time, found, theirs = flown("fall")
    gap = found - theirs
    before, after = time <= 1.0, time >= 2.0
    assert np.abs(gap[before, NODES]).max() < 1e-3  # 0.3 mm: steps of the ends of 5 ms and 1 ms, of 12 m of fall
    np.testing.assert_array_equal(found[:, LYING] > 0.0, theirs[:, LYING] > 0.0)  # touches down between the same rows
    assert rms(gap[after, TENSIONS]) < 0.02  # 0.01 N of 0.6 N: phase of the swinging ends, 1 % of a turn
    assert np.abs(gap[after, LYING]).max() < 0.02  # it rolls up and down under the ends
    assert np.abs(gap[after, NODES]).max() < 2e-3  # 0.6 mm: how far nodes slid as they landed, of 5 m
    assert found[-1, [5, 7, 9]] == pytest.approx(-SINK, rel=1e-5)
    assert theirs[-1, [5, 7, 9]] == pytest.approx(-SINK, rel=1e-5)
    assert found[after, TENSIONS].mean() == pytest.approx(theirs[after, TENSIONS].mean(), rel=1e-3)


def test_a_lift():
    """Hardly different while one end is lifted; as the tether becomes taut, each snap follows from the last one."""
    time, found, theirs = flown("lift")
    gap = found - theirs
    lifted = time <= 5.0
    assert rms(gap[lifted, TENSIONS]) < 0.15  # of 2 N; 0.08
    assert rms(gap[lifted, LYING]) < 0.3  # a tenth of a segment; 0.17
    assert np.abs(gap[lifted, NODES]).max() < 0.02  # of 20 m; 0.013
    assert rms(gap[:, TENSIONS]) < 1.2
    assert np.abs(gap[:, NODES]).max() < 0.15  # MoorDyn with half of its damper: 0.12
    assert found[:, 2].mean() == pytest.approx(theirs[:, 2].mean(), rel=0.05)  # 3 %
    assert rms(gap[:, LYING]) < 0.15 * SEGMENT


def test_a_drag():
    """T = mu (w L' - T d/l0) in the last segment: friction of all nodes but the driven one, which lies d higher."""
    time, found, theirs = flown("drag")
    steady = time >= 2.0
    dragged = WEIGHT * (TETHER.initial_length - 0.5 * SEGMENT)
    tension = FRICTION * dragged / (1.0 + FRICTION * SINK / SEGMENT)
    assert found[steady, 2] == pytest.approx(tension, rel=1e-5)
    assert theirs[steady, 2] == pytest.approx(tension, rel=1e-5)
    assert found[steady, TENSIONS] == pytest.approx(theirs[steady, TENSIONS], abs=1e-6)
    # while it is accelerated by up to 0.75 m/s2, driven with steps of 5 ms and of 1 ms: 0.04 N of 3 N
    assert np.abs(found - theirs)[:, TENSIONS].max() < 0.06
    assert np.abs(found - theirs)[1:, NODES].max() < 1e-4
