"""Sphinx extension: on the pages of equations a name such as `segment.tension` becomes a link to that function."""

from docutils import nodes
from sphinx import addnodes
from sphinx.transforms.post_transforms import SphinxPostTransform

from named_functions import FOLDER, MODULES, NAME, PAGES


class Links(SphinxPostTransform):
    """Turn names of functions into references, which Sphinx resolves or warns of."""

    default_priority = 5  # before references are resolved

    def run(self, **_):
        """Replace the names on a page of equations."""
        folder, _, page = self.env.current_document.docname.rpartition("/")
        for name in list(self.document.findall(nodes.literal)) if folder == FOLDER and page in PAGES else ():
            found = NAME.fullmatch(name.astext())
            if found:
                target = f"{MODULES[found[1]]}.{found[2]}"
                place = {"refdomain": "py", "reftype": "obj", "reftarget": target, "refexplicit": True, "refwarn": True}
                name.replace_self(
                    addnodes.pending_xref("", name.deepcopy(), refdoc=self.env.current_document.docname, **place)
                )


def setup(app):
    """Add the links."""
    app.add_post_transform(Links)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
