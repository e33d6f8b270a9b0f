"""Sphinx extension: each lesson of the course, `docs/course`, is also offered as a notebook, which has no outputs.

The lessons are plain pages. `make_course.py` writes what their code prints and draws into them.
"""

import json
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
COURSE = "course"  # folder of the lessons, in docs and on the site
CODE = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"(?<!!)\[([^\]]*)\]\((?!https:)[^)]*\)")  # to another page of the manual
OUTPUT, PICTURE, FOLD = r"\n```text\n(?!python3).*?^```$", r"^!\[[^\]]*\]\([^)]*\)$", r"^</?details>$|^<summary>.*$"
SHOWN = re.compile(f"{OUTPUT}|{PICTURE}|{FOLD}", re.MULTILINE | re.DOTALL)
KERNEL = {"display_name": "Python 3", "language": "python", "name": "python3"}


def lessons(docs):
    """The pages of all lessons, in order."""
    return sorted((Path(docs) / COURSE).glob("[0-9]*.md"))


def notebook(text):
    """A lesson as a notebook, format 4.5; links to other pages become their text, outputs and pictures are left out."""
    cells = []
    for k, part in enumerate(CODE.split(text)):
        is_code = k % 2 == 1
        source = (part if is_code else re.sub(r"\n{3,}", "\n\n", SHOWN.sub("", LINK.sub(r"\1", part)))).strip()
        kind = {"cell_type": "code", "execution_count": None, "outputs": []} if is_code else {"cell_type": "markdown"}
        if source:
            cells.append({**kind, "id": f"cell-{k}", "metadata": {}, "source": source})
    if cells[-1]["cell_type"] == "code":
        cells[-1]["metadata"] = {"jupyter": {"source_hidden": True}}  # the answer
    return {"cells": cells, "metadata": {"kernelspec": KERNEL}, "nbformat": 4, "nbformat_minor": 5}


def write_notebooks(docs, folder):
    """Write each lesson as a notebook to a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    for page in lessons(docs):
        text = json.dumps(notebook(page.read_text(encoding="utf-8")), indent=1, ensure_ascii=False)
        (folder / f"{page.stem}.ipynb").write_text(text + "\n", encoding="utf-8")


def add_link(app, doctree, docname):
    """Offer a lesson as a notebook, below its title."""
    from docutils import nodes  # comes with Sphinx, which who runs a lesson need not have

    folder, _, name = docname.rpartition("/")
    if folder == COURSE and name[0].isdigit() and app.builder.format == "html":
        link = nodes.reference("", "Download this lesson as a notebook", refuri=f"{name}.ipynb", internal=True)
        (section,) = doctree.findall(lambda node: isinstance(node, nodes.section) and node.parent is doctree)
        section.insert(1, nodes.paragraph("", "", link, classes=["notebook"]))


def setup(app):
    """Connect it."""
    app.connect("doctree-resolved", add_link)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
