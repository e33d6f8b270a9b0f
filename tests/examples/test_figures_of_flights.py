"""Figures of flights: names do not overlap, rounding errors are no signal, each of nine lines has a colour of its own."""

from itertools import combinations

import matplotlib.pyplot as plt
import numpy as np

from tetherfmu.console.colours import coloured
from tetherfmu.libraries.examples import example

figures = example("shared.flight_figures")


def test_names_of_points_in_one_place_do_not_overlap():
    """Five points within a few pixels."""
    figure = plt.figure(figsize=(9.0, 6.0))
    axes = figure.add_subplot(projection="3d")
    axes.plot([0.0, 10.0], [0.0, 10.0], [0.0, 10.0])
    points = {f"point_{k}": np.array([5.0, 5.0, 5.0 + 0.01 * k]) for k in range(5)}
    figures.label_in_space(axes, points)
    figure.canvas.draw()
    boxes = [text.get_window_extent() for text in axes.texts]
    assert [text.get_text() for text in axes.texts] == sorted(points, reverse=True)
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))
    plt.close(figure)


def test_rounding_errors_do_not_fill_a_figure():
    figure, axes = plt.subplots()
    axes.plot([0.0, 1.0, 2.0], [3000.0, 3000.0 + 1e-9, 3000.0])
    figures.with_room(axes)
    low, high = axes.get_ylim()
    assert high - low > 50.0
    axes.plot([0.0, 1.0], [3000.0, 4000.0])
    axes.relim()
    axes.autoscale()
    before = axes.get_ylim()
    figures.with_room(axes)
    assert axes.get_ylim() == before
    plt.close(figure)


def test_nine_lines_have_nine_colours():
    assert len({colour for *_, colour in coloured(dict.fromkeys("abcdefghi"))}) == 9
