"""Sphinx extension: the lessons of the course, `docs/course`, are run when they are read, and offered as notebooks.

myst-nb runs a lesson in a kernel of Jupyter. What kernels need is in a folder for one build: the FMUs in `dist`, where the
lessons expect them, and a profile of IPython that goes there. jupytext makes the notebooks, which have no outputs.
"""

import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import jupytext
from docutils import nodes

from pictures import themed

ROOT = Path(__file__).resolve().parents[2]
COURSE = "course"  # folder of the lessons, in docs and on the site
FMUS = ("TetherDynamic", "TetherCatenary")
WARNING = "Warning: missing input for variable"  # of FMPy
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\((?!https:)[^)]*\)")  # to another page of the manual
ANIMATION = re.compile(r"^!\[[^\]]*\]\([^)]*\)\n*", re.MULTILINE)

STARTUP = """\
import os, sys
os.environ["MPLBACKEND"] = "module://matplotlib_inline.backend_inline"
os.chdir({work!r})
sys.path.insert(0, {package!r})
"""
PROFILE = """\
c.HistoryManager.enabled = False
c.IPKernelApp.log_level = "ERROR"  # else each kernel warns that it talks to Sphinx unencrypted, on this machine
c.InlineBackend.figure_formats = {"svg"}
c.InlineBackend.rc = {
    "figure.figsize": (6.0, 3.3),
    "font.size": 11.0,
    "figure.constrained_layout.use": True,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "axes.spines.top": False,
    "axes.spines.right": False,
}
"""


def lessons(docs):
    """The pages of all lessons, in order."""
    return sorted((Path(docs) / COURSE).glob("[0-9]*.md"))


def write_notebooks(docs, folder):
    """Write each lesson as a notebook to a folder, without animations; links to other pages become their text there."""
    folder.mkdir(parents=True, exist_ok=True)
    for page in lessons(docs):
        notebook = jupytext.read(page, fmt="md:myst")
        for cell in notebook.cells:
            if cell.cell_type == "markdown":
                cell.source = ANIMATION.sub("", LINK.sub(r"\1", cell.source))
            elif "tags" in cell.metadata:
                cell.metadata["jupyter"] = {"source_hidden": True}  # the answer
        jupytext.write(notebook, folder / f"{page.stem}.ipynb", fmt="ipynb")


def prepare(app):
    """Build the FMUs, and lead the kernels of Jupyter to them; without compiled kernels of tethers that takes minutes."""
    app.course_folder = Path(tempfile.mkdtemp())
    work, profile = app.course_folder / "work", app.course_folder / "ipython" / "profile_default"
    (profile / "startup").mkdir(parents=True)
    names = {"work": str(work), "package": str(ROOT / "fmu_sources")}
    (profile / "startup" / "course.py").write_text(STARTUP.format(**names), encoding="utf-8")
    (profile / "ipython_kernel_config.py").write_text(PROFILE, encoding="utf-8")
    os.environ["IPYTHONDIR"] = str(profile.parent)
    clean = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    build = [sys.executable, "-m", "tetherfmu", "build", *FMUS, "--out", work / "dist"]
    subprocess.run(build, env=clean, check=True, stdout=subprocess.DEVNULL)


def without_warnings(app, doctree):
    """Leave out what FMPy prints of each input that has no signal: many lines, and the lessons say so."""
    for block in list(doctree.findall(nodes.literal_block)):
        if "stream" in block["classes"]:
            text = "".join(line for line in block.astext().splitlines(keepends=True) if not line.startswith(WARNING))
            block.replace_self(nodes.literal_block(text, text, **block.attributes))


def add_link(app, doctree, docname):
    """Offer a lesson as a notebook, below its title."""
    folder, _, name = docname.rpartition("/")
    if folder == COURSE and name[0].isdigit() and app.builder.format == "html":
        link = nodes.reference("", "Download this lesson as a notebook", refuri=f"{name}.ipynb", internal=True)
        (section,) = doctree.findall(lambda node: isinstance(node, nodes.section) and node.parent is doctree)
        section.insert(1, nodes.paragraph("", "", link, classes=["notebook"]))


def finish(app, exception):
    """Let the figures of the lessons follow the theme of the reader; remove what was made for the build."""
    for path in (Path(app.outdir) / app.builder.imagedir).glob("*.svg"):
        path.write_text(themed(path.read_text(encoding="utf-8")), encoding="utf-8")
    shutil.rmtree(app.course_folder, ignore_errors=True)


def setup(app):
    """Connect all."""
    app.connect("builder-inited", prepare)
    app.connect("doctree-read", without_warnings)
    app.connect("doctree-resolved", add_link)
    app.connect("build-finished", finish)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
