"""The report of a scene: CSV of all points, Pareto figure, one page in Markdown and HTML."""

import csv
from pathlib import Path

from markdown import markdown

from tetherfmu.study.measuring.runs import VARIANTS
from tetherfmu.study.measuring.tables import circumstances
from tetherfmu.study.scenes.files import OUTPUTS

from .tradeoff import LEVELS, cheapest, front

COLORS = dict(zip(VARIANTS, ("C7", "C2", "C1", "C0"), strict=True))
NAMES = {"straight": "straight", "catenary": "catenary", "quasi_steady": "quasi-steady", "dynamic": "dynamic"}
ABOUT = """\
Cost: kernel time for one simulated second, from counted work and measured unit costs; a step with all its outputs.
Through FMPy: measured, with FMPy setting the inputs that change, doing the step, and getting both end forces."""

HTML = """\
<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<title>{title}</title>
<style>
body {{ font-family: sans-serif; max-width: 60em; margin: 2em auto; padding: 0 1em }}
table {{ border-collapse: collapse }}
td, th {{ border: 1px solid #ccc; padding: 0.2em 0.6em }}
img {{ max-width: 100% }}
</style>
</head>
<body>
{body}
</body>
</html>
"""


def percent(value):
    """Text of a share in percent, two digits."""
    return f"{100.0 * value:.2g} %"


def factor(cost):
    """Text of how many times faster than real time, two digits."""
    return f"{float(f'{1.0 / cost:.2g}'):.0f}" if cost else "-"


def write_csv(points, reference, path):
    """All points; errors that are smaller than ten times the reference's own are not known better than that."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        numbers = ("calls", "work", "kernel_s_per_s", "cost_s_per_s", "with_fmpy_estimated_s_per_s")
        writer.writerow(["variant", "segments", "tolerance", "step_s", *OUTPUTS, *numbers, "refused"])
        row = [*reference.config, *(reference.space[name] + reference.time[name] for name in OUTPUTS)]
        writer.writerow([*row, reference.run.calls, reference.run.steps, "", "", "", "reference: bounds of its own errors"])
        for point in points:
            found = [f"{point.errors[name]:.3g}" for name in OUTPUTS] if point.errors else [""] * len(OUTPUTS)
            costs = [f"{value:.3g}" for value in (point.seconds, point.cost, point.host_cost)]
            writer.writerow([*point.config, *found, point.calls, point.work, *costs, point.refused])


def draw_points(axis, points, names, size):
    """Cost against error of all points, a color for each variant, and their front as a line; returns the front."""
    for variant in VARIANTS:
        mine = [p for p in points if p.config.variant == variant and p.errors]
        x, y = [100.0 * p.error(names) for p in mine], [1e6 * p.cost for p in mine]
        axis.loglog(x, y, ".", color=COLORS[variant], markersize=size, alpha=0.6, label=NAMES[variant])
    best = front(points, names)
    axis.step([100.0 * p.error(names) for p in best], [1e6 * p.cost for p in best], "k-", where="post", linewidth=1.0)
    return best


def draw(points, reference, names, title, path):
    """The Pareto figure: cost against error, the front as a line, the reference's own error as a grey band."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    figure, axis = plt.subplots(figsize=(6.4, 4.4), layout="constrained")
    best = draw_points(axis, points, names, 5)
    own = 100.0 * reference.own_error(names)
    left = min([0.5 * own, *(100.0 * p.error(names) for p in best)])
    axis.axvspan(left, own, color="0.85", linewidth=0.0, label="reference's own error")
    for level in LEVELS:
        axis.axvline(100.0 * level, color="0.8", linewidth=0.8, zorder=0)
    axis.invert_xaxis()
    axis.set_xlabel(f"error of {', '.join(names)} [%]")
    axis.set_ylabel("kernel time per simulated second [µs]")
    axis.set_title(title)
    axis.legend(frameon=False, fontsize=8)
    figure.savefig(path, dpi=100, metadata={"Software": None})
    plt.close(figure)


def level_rows(points, names, levels, through_fmpy):
    """Rows of the cheapest configurations; `through_fmpy` maps configurations to measured time per simulated second."""
    rows = []
    for level in levels:
        best = cheapest(points, level, names)
        if best is None:
            rows.append((percent(level), "none", "-", "-", "-"))
            continue
        host = through_fmpy.get(best.config)
        cells = percent(best.error(names)), factor(best.cost), factor(host) if host else "-"
        rows.append((percent(level), best.config.words(), *cells))
    return rows


def table(columns, rows):
    """Lines of a Markdown table."""
    lines = ["| " + " | ".join(columns) + " |", "|" + "---|" * len(columns)]
    return lines + ["| " + " | ".join(row) + " |" for row in rows]


def page(scene, reference, points, through_fmpy, figure):
    """The page as Markdown; `figure` is the path of the figure as seen from it."""
    names = scene.wanted.outputs
    levels = sorted({*LEVELS, scene.wanted.allowed_error}, reverse=True)
    own = reference.own_error(names)
    lines = [f"# Scene {scene.name}: speed against accuracy", "", f"Errors of {', '.join(names)}. {ABOUT}", ""]
    columns = ("error at most", "cheapest configuration", "error", "times real time, kernel", "through FMPy")
    lines += table(columns, level_rows(points, names, levels, through_fmpy))
    lines += ["", f"![Cost against error of all configurations]({figure})", "", "## How exact each tether can be", ""]
    rows = []
    for variant in VARIANTS:
        mine = [p for p in points if p.config.variant == variant and p.errors]
        best = min(mine, key=lambda p: p.error(names), default=None)
        rows.append(
            (NAMES[variant], percent(best.error(names)), best.config.words()) if best else (NAMES[variant], "-", "refused")
        )
    lines += table(("tether", "smallest error", "with"), rows)
    lines += [
        "",
        "## The reference",
        "",
        f"{reference.config.words()}, with the exact reel-out and wind of each step. Half of the segments change it by "
        f"{percent(max(reference.space[n] for n in names))}, the double step with ten times the tolerance by "
        f"{percent(max(reference.time[n] for n in names))}: it is wrong by less than {percent(own)}. Errors below "
        f"{percent(10.0 * own)} are not told apart.",
        "",
        circumstances(),
        "",
    ]
    return "\n".join(lines)


def write(scene, reference, points, through_fmpy, folder):
    """Write points.csv, pareto.png, report.md and report.html to a folder; returns the page."""
    folder = Path(folder)
    write_csv(points, reference, folder / "points.csv")
    draw(points, reference, scene.wanted.outputs, scene.name, folder / "pareto.png")
    text = page(scene, reference, points, through_fmpy, "pareto.png")
    (folder / "report.md").write_text(text, encoding="utf-8")
    body = markdown(text, extensions=["tables"])
    (folder / "report.html").write_text(HTML.format(title=scene.name, body=body), encoding="utf-8")
    return text
