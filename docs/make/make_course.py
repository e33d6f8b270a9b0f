"""Run the lessons of the course, and write what they print and draw beside their code; `python docs/make/make_course.py`.

Names, such as `06_winch`, choose lessons. What a lesson prints stands below its code, its picture in docs/figures/course.
"""

import os
import re
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from course_pages import CODE, ROOT, lessons

DOCS = ROOT / "docs"
FIGURES = DOCS / "figures" / "course"
FMUS = ("TetherDynamic", "TetherCatenary")
WARNING = re.compile(r"Warning: missing input for variable.*\n")  # of FMPy, for each input without a signal
CELL = "\x1e"  # stands between the outputs of two blocks
LOOK = {"figure.figsize": (6.0, 3.3), "font.size": 11.0, "figure.constrained_layout.use": True, "axes.grid": True}
LOOK |= {"grid.alpha": 0.3, "axes.spines.top": False, "axes.spines.right": False}
RUN = """
import sys
sys.path[:0] = {path!r}
import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot as plt
from pictures import save
plt.rcParams.update({look!r})
plt.show = lambda: save(plt.gcf(), "picture.svg")
names = {{}}
for code in {blocks!r}:
    exec(compile(code, {name!r}, "exec"), names)
    print({cell!r}, end="")
"""


def by_python(code, folder):
    """The finished process of a new Python that runs code in a folder."""
    clean = {**os.environ, "PYTHONPATH": str(ROOT / "fmu_sources")}
    return subprocess.run([sys.executable, "-c", code], cwd=folder, env=clean, capture_output=True, text=True, check=False)


def ran(page, folder, run=by_python):
    """What each block of a lesson prints, run in a folder that has `dist`; its picture is picture.svg there."""
    path = [str(DOCS / "make"), str(ROOT / "fmu_sources")]
    code = RUN.format(path=path, look=LOOK, blocks=CODE.findall(page.read_text("utf-8")), name=page.name, cell=CELL)
    if not (folder / "examples").exists():
        (folder / "examples").symlink_to(ROOT / "examples", target_is_directory=True)
    done = run(code, folder)
    if done.returncode:
        raise RuntimeError(f"{page.name}: {done.stderr}")
    return [WARNING.sub("", text) for text in done.stdout.split(CELL)[:-1]]


def with_outputs(text, printed):
    """A lesson with these outputs in the blocks below its code."""
    outputs = iter(printed)
    return re.sub(
        r"(^```python\n.*?^```\n\n```text\n).*?(?=^```$)",
        lambda found: found[1] + next(outputs),
        text,
        flags=re.MULTILINE | re.DOTALL,
    )


def main(names):
    """Run the lessons of these names, all if there are none."""
    from tetherfmu.__main__ import main as tetherfmu

    FIGURES.mkdir(exist_ok=True)
    with TemporaryDirectory() as folder:
        tetherfmu(["build", *FMUS, "--out", f"{folder}/dist"])
        for page in lessons(DOCS):
            if not names or page.stem in names:
                printed = ran(page, Path(folder))
                page.write_text(with_outputs(page.read_text("utf-8"), printed), encoding="utf-8")
                (Path(folder) / "picture.svg").replace(FIGURES / f"{page.stem}.svg")


if __name__ == "__main__":
    main(sys.argv[1:])
