"""Sphinx extension: pages below others in the sidebar, and stubs that lead on from pages that are gone.

The first level is in the contents of `docs/index.md`.
"""

from pathlib import Path

from course_pages import COURSE, lessons

BELOW = {  # page: pages below it
    "use/start": ("use/in_the_browser", "use/from_tethers_jl"),
    "course/index": (),  # all lessons, and the tutorial
    "use/faq": ("use/glossary",),
    "use/how_much_tether": ("use/quality_of_advice",),
    "use/scene_files": ("use/sweeps", "use/task_pumping"),
    "use/cranes_and_drones": ("use/ground", "use/task_hoist"),
    "use/coupling": ("use/example_fmus",),
    "use/importing": ("use/real_time", "use/task_drone_in_c"),
    "reference/variables": ("reference/systems", "reference/variables_of_examples"),
    "models/theory": ("models/numerics",),
    "measurements/validation": (
        "measurements/measured_flights",
        "measurements/benchmarks",
        "measurements/stability",
        "use/comparison",
    ),
    "contributors/developing": ("contributors/fmus",),
}
MOVED = {  # page that is gone: where its text is
    "contributors/functions": "models/theory.html",
    "reference/derivatives": "reference/fmi.html#derivatives",
    "reference/promises": "reference/changes.html",
    "use/examples_of_systems": "use/gallery.html#a-kite-on-a-y-bridle",
}
CONTENTS = "\n\n```{{toctree}}\n:hidden:\n\n{}\n```\n"
STUB = """<!doctype html>
<meta charset="utf-8"><title>Moved</title>
<meta http-equiv="refresh" content="0; url=../{0}">
<a href="../{0}">{0}</a>
"""


def add_contents(app, docname, source):
    """Put the contents of a page at its end."""
    if docname in BELOW:
        source[0] += CONTENTS.format("\n".join(f"/{page}" for page in BELOW[docname]))


def write_stubs(app, exception):
    """Write a page that leads on for each that is gone."""
    if app.builder.format == "html" and not exception:
        for page, place in MOVED.items():
            path = Path(app.outdir) / f"{page}.html"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(STUB.format(place), encoding="utf-8")


def setup(app):
    """Connect both."""
    BELOW["course/index"] = (*(f"{COURSE}/{page.stem}" for page in lessons(app.srcdir)), "use/tutorial")
    app.connect("source-read", add_contents)
    app.connect("build-finished", write_stubs)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
