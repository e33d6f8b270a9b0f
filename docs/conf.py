"""How Sphinx makes the documentation site: `python -m sphinx -W --keep-going -b html docs site`."""

import re
import shutil
import sys
import tempfile
from importlib.metadata import distribution
from pathlib import Path

from docutils import nodes
from pygments.lexers.special import TextLexer
from sphinx.highlighting import lexers
from sphinx.util.osutil import relative_uri

DOCS = Path(__file__).resolve().parent
sys.path[:0] = [str(DOCS / "make"), str(DOCS.parent / "fmu_sources")]

import course_pages  # noqa: E402
from tetherfmu.libraries import webassembly  # noqa: E402
from tetherfmu.runtime import __version__ as release  # noqa: E402
from tetherfmu.web import page  # noqa: E402

lexers["csv"] = TextLexer()  # which Pygments does not know

project, author, copyright = "TetherFMU", "TetherFMU developers", "TetherFMU developers"
version = release
smartquotes_action = "qe"  # no dashes: an option of a command has two hyphens
extensions = [
    "course_pages",
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx.ext.viewcode",
    "sphinx_design",
    "line_breaks",
    "links_to_functions",
    "real_signatures",
    "rows_of_search",
    "sidebar",
    "words_of_search",
]
exclude_patterns = ["data", "make", "publishing", "site_files"]

myst_enable_extensions = ["amsmath", "attrs_block", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 4
myst_links_external_new_tab = True

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # real_signatures has them
numpydoc_show_class_members = False
numpydoc_xref_param_type = False

add_module_names = False
maximum_signature_line_length = 100
default_role = "literal"  # single backticks in docstrings
toc_object_entries = False
html_theme = "furo"
html_title = f"TetherFMU {release}"
MATHJAX = DOCS / distribution("sphinx-mathjax-offline").locate_file("sphinx-mathjax-offline/static/mathjax/tex-svg-full.js")
html_static_path = ["site_files", str(MATHJAX)]  # formulas without the web: this one file has all that MathJax needs
mathjax_path = MATHJAX.name
html_css_files = ["wide.css"]
html_js_files = [("sidebar.js", {"defer": "defer"})]
html_search_scorer = str(DOCS / "site_files" / "scorer.js")
FLOWN = Path(tempfile.mkdtemp())  # with the page of `tetherfmu web`, and the lessons as notebooks
html_extra_path = [str(FLOWN)]
KERNELS = webassembly.place_of("webassembly", webassembly.FILE, webassembly.VARIANTS, [webassembly.__file__])
if KERNELS.exists():
    page.write(FLOWN / "fly", KERNELS.read_bytes())
    tags.add("flown")  # noqa: F821 (Sphinx defines it here)
else:
    print("the site goes without the page of tetherfmu web: its kernels are not compiled; tetherfmu web compiles them, once")
course_pages.write_notebooks(DOCS, FLOWN / "course")
html_copy_source = False
html_domain_indices = False
WIDE = 800  # pixels
pygments_style, pygments_dark_style = "default", "monokai"


def without_fields(app, what, name, obj, skip, options):
    """Leave out the fields of records, which the docstring of the record explains."""
    return True if type(obj).__name__ == "_tuplegetter" else skip


def width_of(file):
    """Width of an SVG figure in CSS pixels, 0 for other files."""
    if file.suffix != ".svg":
        return 0.0
    found = re.search(r'<svg[^>]*? width="([\d.]+)(pt|px)?"', file.read_text(encoding="utf-8")[:2000])
    return float(found[1]) * (4.0 / 3.0 if found[2] == "pt" else 1.0) if found else 0.0


def figures_as_links(app, doctree, docname):
    """Make each figure a link to its file; mark the wide ones, whose letters a phone would shrink too far to read."""
    if app.builder.format != "html":
        return
    folder = relative_uri(app.builder.get_target_uri(docname), app.builder.imagedir)
    for image in list(doctree.findall(nodes.image)):
        link = nodes.reference(internal=True, refuri=f"{folder}/{app.env.images[image['uri']][1]}")
        image.replace_self(link)
        link += image
        if docname != "use/gallery" and width_of(DOCS / image["uri"]) > WIDE:
            image["classes"].append("wide")


def tables_of_variables(app, doctree, docname):
    """Mark the tables that say in their last column what a variable means; `site_files/wide.css` fits them to a phone."""
    for head in doctree.findall(nodes.thead):
        if head[0][-1].astext() in ("meaning", "why"):
            head.parent.parent["classes"] += ["variables", "pair"] if len(head[0]) == 2 else ["variables"]


def lines_to_wrap(app, doctree, docname):
    """Mark commands and printed sentences, which wrap on a phone; printed tables and code do not."""
    for block in doctree.findall(nodes.literal_block):
        lines = block.astext().splitlines()
        command = re.compile(r"\.venv/bin/|python3? |tetherfmu |pip |fmpy ")
        prose = docname == "reference/variables_of_examples"
        if block.get("language") in (None, "default", "none", "text") and (
            len(lines) < 3 or prose or all(map(command.match, lines))
        ):
            block["classes"].append("wrapped")


def without_page(app, exception):
    """Remove the folder of the page, of which the site has a copy."""
    shutil.rmtree(FLOWN, ignore_errors=True)


def setup(app):
    """Connect the functions above."""
    app.connect("build-finished", without_page)
    app.connect("autodoc-skip-member", without_fields)
    app.connect("doctree-resolved", figures_as_links)
    app.connect("doctree-resolved", tables_of_variables)
    app.connect("doctree-resolved", lines_to_wrap)
