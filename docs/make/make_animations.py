"""Draw docs/figures/lesson_*.svg, animations of lessons of the course: `python docs/make/make_animations.py`.

Each runs the code of its lesson and shows the flight in an SVG file, which moves by itself and follows the theme. Print and
browsers without animations have its first frame.
"""

import contextlib
import io

import matplotlib as mpl
import numpy as np

mpl.use("Agg")
import matplotlib.pyplot as plt

from course_pages import CODE, ROOT, lessons
from pictures import save_moving
from tetherfmu.console.colours import BLACK, BLUE, GREY, VERMILLION

DOCS = ROOT / "docs"
FRAMES, SECONDS = 120, 12.0  # of an animation, and how long it takes [s]
DOT = {"color": VERMILLION, "linewidth": 9.0, "solid_capstyle": "round"}


def variables(number):
    """What the code of a lesson leaves behind: a dict of its variables."""
    (page,) = (page for page in lessons(DOCS) if page.stem.startswith(number))
    code, found = CODE.findall(page.read_text(encoding="utf-8"))[0], {}
    with contextlib.redirect_stdout(io.StringIO()):
        exec(compile(code, page, "exec"), found)  # the code of the page, as a reader runs it
    plt.close("all")
    return found


def write(figure, moving, name):
    """Write an animation of a lesson; moving : line -> array (frames, points, 2)."""
    save_moving(figure, moving, SECONDS, DOCS / "figures" / f"lesson_{name}")
    plt.close(figure)


def tidy(axes, **options):
    """A light grid and no box."""
    axes.set(**options)
    axes.grid(alpha=0.3)
    axes.spines[["top", "right"]].set_visible(False)


def dot(x, y):
    """Where a dot runs along a curve: array (frames, points, 2)."""
    return np.stack([x, y], axis=-1)[:, None].repeat(2, axis=1)


def panels():
    """A figure with a scene at the left and a curve over time at the right."""
    return plt.subplots(1, 2, figsize=(6.6, 3.0), width_ratios=(1.0, 1.4), layout="constrained")


def crane():
    """Lesson 9: the crane moves, the load swings; beside them the swing over time."""
    found = variables("09")
    flown, swing = found["flown"], found["swing"]
    rows = np.linspace(0, len(swing) - 1, FRAMES).astype(int)
    shapes = flown.positions[rows][..., [0, 2]]
    figure, (scene, beside) = panels()
    tidy(scene, xlabel="x [m]", ylabel="height [m]", xlim=(-6.0, 19.0), ylim=(0.0, 56.0))
    tidy(beside, xlabel="time [s]", ylabel="load ahead of the tip [m]", xlim=(0.0, flown.time[-1]))
    scene.axhline(50.0, color=GREY, linewidth=1.0)
    beside.plot(flown.time, swing, color=BLUE)
    moving = {
        scene.plot([0.0], [0.0], color=BLUE, linewidth=2.0)[0]: shapes[:, [0, -1]],
        scene.plot([0.0], [0.0], color=BLACK, linewidth=6.0)[0]: shapes[:, :1] + np.array([(-1.2, 0.0), (1.2, 0.0)]),
        scene.plot([0.0], [0.0], color=VERMILLION, linewidth=10.0)[0]: shapes[:, -1:]
        + np.array([(-1.0, -1.0), (1.0, -1.0)]),
        beside.plot([0.0], [0.0], **DOT)[0]: dot(flown.time[rows], swing[rows]),
    }
    write(figure, moving, "crane")


def winch():
    """Lesson 6: the drum of 100 kg follows the kite, not to scale; beside it both tensions over time."""
    found = variables("06")
    time, pull, length = found["flown"].time, found["pull"], found["length"]
    rows = np.linspace(0, len(pull) - 1, FRAMES).astype(int)
    away = np.array([np.linalg.norm(found["kite"].at(each)[0]) for each in time[rows]]) - 300.0
    figure, (scene, beside) = panels()
    scene.set(xlim=(-5.0, 25.0), ylim=(-9.0, 9.0), aspect="equal")
    scene.axis("off")
    scene.add_patch(plt.Circle((0.0, 0.0), 3.0, facecolor="#dddddd", edgecolor=BLACK))
    scene.text(0.0, -5.5, "winch", ha="center")
    scene.text(14.0, -5.5, "kite", ha="center")
    tidy(beside, xlabel="time [s]", ylabel="tension at the winch [N]", xlim=(0.0, time[-1]), ylim=(2880.0, 3120.0))
    beside.axhline(3000.0, color=GREY)
    beside.text(0.5, 3006.0, "0 kg", color=GREY)
    beside.plot(time, pull, color=BLUE)
    beside.text(16.0, 3104.0, "100 kg", color=BLUE, ha="center")
    angle = -(length[rows] - length[0]) / 3.0
    kite = np.stack([14.0 + 0.8 * away, np.full(FRAMES, 3.0)], axis=-1)[:, None]
    moving = {
        scene.plot([0.0], [0.0], color=BLUE, linewidth=2.0)[0]: np.concatenate([0.0 * kite + [0.0, 3.0], kite], axis=1),
        scene.plot([0.0], [0.0], **DOT)[0]: kite + np.array([(0.0, -1.0), (0.0, 1.0)]),
        beside.plot([0.0], [0.0], **DOT)[0]: dot(time[rows], pull[rows]),
    }
    for turned in (0.0, np.pi / 2.0):
        rim = 2.9 * np.stack([np.cos(angle + turned), np.sin(angle + turned)], axis=-1)[:, None]
        moving[scene.plot([0.0], [0.0], color=BLACK, linewidth=1.5)[0]] = np.concatenate([-rim, rim], axis=1)
    write(figure, moving, "winch")


def main():
    """Draw all of them."""
    crane()
    winch()


if __name__ == "__main__":
    main()
