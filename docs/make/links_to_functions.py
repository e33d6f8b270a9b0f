"""Sphinx extension: on the pages of equations a name such as `segment.tension` becomes a link to its source.

viewcode makes a page of each module whose objects the manual describes; here also of those whose functions are named. The
source leads back to the place that names it first.
"""

from docutils import nodes
from sphinx.pycode import ModuleAnalyzer
from sphinx.transforms.post_transforms import SphinxPostTransform
from sphinx.util import logging
from sphinx.util.nodes import make_refnode

import tetherfmu
from named_functions import FOLDER, MODULES, NAME, PAGES

SOURCES = "_modules"  # folder of viewcode's pages


def mark_names(app, doctree):
    """Register the functions that a page of equations names with viewcode, and mark their names."""
    page = app.env.current_document.docname
    folder, _, name = page.rpartition("/")
    if folder != FOLDER or name not in PAGES:
        return
    for literal in doctree.findall(nodes.literal):
        found = NAME.fullmatch(literal.astext())
        if not found:
            continue
        module, function = MODULES[found[1]], found[2]
        tags, used, prefix = described(app.env, module)
        if function not in tags:
            logging.getLogger(__name__).warning("%s names %s, which is no function", page, found[0])
            continue
        if used.setdefault(function, page) == page and f"{prefix}.{function}" not in doctree.ids:
            literal["ids"].append(f"{prefix}.{function}")
            doctree.ids[f"{prefix}.{function}"] = literal
        literal["source_of"] = module, function


def described(env, module):
    """What viewcode has of a module: places of its functions, pages that they lead back to, prefix of their anchors."""
    if not hasattr(env, "_viewcode_modules"):
        env._viewcode_modules = {}
    if not env._viewcode_modules.get(module):
        analyzer = ModuleAnalyzer.for_module(module)
        analyzer.find_tags()
        front = module.removeprefix("tetherfmu.") in tetherfmu._HOMES  # its names are those of the package
        env._viewcode_modules[module] = analyzer.code, analyzer.tags, {}, "tetherfmu" if front else module
    return env._viewcode_modules[module][1:]


class Links(SphinxPostTransform):
    """Turn marked names into links."""

    default_priority = 100
    formats = ("html",)

    def run(self, **_):
        """Replace the names on a page."""
        page = self.env.current_document.docname
        for literal in list(self.document.findall(lambda node: isinstance(node, nodes.literal) and "source_of" in node)):
            module, function = literal["source_of"]
            source = f"{SOURCES}/{module.replace('.', '/')}"
            literal.replace_self(make_refnode(self.app.builder, page, source, function, literal.deepcopy()))


def setup(app):
    """Add the links."""
    app.connect("doctree-read", mark_names)
    app.add_post_transform(Links)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
