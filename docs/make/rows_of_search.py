"""Sphinx extension: each variable, parameter, command, option and key is an entry of the search that leads to its row.

A page of `PAGES` has tables whose first column names them. The rows get anchors, and the names are objects of a domain,
which the search shows with what they are; `site_files/scorer.js` puts the one first whose name was typed.
"""

import re
from typing import ClassVar

from docutils import nodes
from sphinx.domains import Domain, ObjType

COMMANDS, SYSTEMS = "reference/commands", "reference/systems"
EXAMPLES, SCENES, LOGS = "reference/variables_of_examples", "use/scene_files", "use/your_log"
PAGES = {  # page: (column that names, what is named; {} is the heading of the section)
    "reference/variables": (("name", "{}"),),
    SYSTEMS: (("key", "key of a system file"), ("variable", "variable of a system")),
    EXAMPLES: (("name", "variable of {}"),),
    COMMANDS: (("option", "option"),),
    SCENES: (("key", "key of a scene file"), ("section", "key of a scene file")),
    LOGS: (("key", "key of a map"),),
}
KINDS = {  # by heading
    "Inputs": "input",
    "Outputs": "output",
    "Local variables": "local variable",
    "Parameters": "parameter",
}


class Rows(Domain):
    """Named rows: name -> (what it is, page, anchor) for each page."""

    name, label, data_version = "row", "rows of tables", 1
    initial_data: ClassVar = {"rows": {}}
    object_types: ClassVar = {}

    def get_type_name(self, type, primary=False):
        """What a row is, as the search shows it."""
        return type.lname

    def get_objects(self):
        """Name, shown name, kind, page, anchor and priority of each."""
        for page, rows in self.data["rows"].items():
            for name, kind, anchor in rows:
                self.object_types.setdefault(kind, ObjType(kind))
                yield name, name, kind, page, anchor, 1

    def clear_doc(self, docname):
        """Forget a page."""
        self.data["rows"].pop(docname, None)

    def merge_domaindata(self, docnames, otherdata):
        """Take the pages that another process has read."""
        self.data["rows"] |= {page: rows for page, rows in otherdata["rows"].items() if page in docnames}


def names_of(page, section, row):
    """Names in the first cell of a row, each in full."""
    written = [literal.astext() for literal in row[0].findall(nodes.literal)]
    if page == COMMANDS:
        option = re.match(r"--[\w-]+", written[0]) if written else None
        return [f"tetherfmu {section} {option[0]}"] if option else []
    if page == SCENES and written and written[0].startswith("["):
        return [f"{written[0][1:-1]}.{key.astext()}" for key in row[1].findall(nodes.literal)]
    before, full = "", []
    for name in written:
        if name.startswith("."):
            name = before + name
        elif full and "." not in name and page != EXAMPLES:
            name = f"{before}.{name}" if before else name
        before = name.rpartition(".")[0] if "[" not in name else name.partition("[")[0].rpartition(".")[0]
        full.append(name)
    if page == SYSTEMS:  # a section of a file, or any name, is no name of its own
        full = [name for name in full if "." in name and not name.endswith(".NAME")]
    return [f"{section}.{name}" for name in full] if page == EXAMPLES and section not in KINDS else full


def shown(name):
    """A name without ranges such as 1..3, whose dots would divide it."""
    return re.sub(r"(\d)\.\.(\w)", lambda found: "1, 2, 3" if found[2] == "3" else found[2].lower(), name)


def note_rows(app, doctree):
    """Give the rows of a page their anchors, and note their names."""
    page = app.env.current_document.docname
    noted, taken = app.env.get_domain("row").data["rows"].setdefault(page, []), set(doctree.ids)
    for table in doctree.findall(nodes.table) if page in PAGES else ():
        section = table.parent
        while not isinstance(section, nodes.section):
            section = section.parent
        title = section.next_node(nodes.title).astext()
        (head,) = table.findall(nodes.thead)
        kinds = dict(PAGES[page])
        if head[0][0].astext() not in kinds or (page == "reference/variables" and title not in KINDS):
            continue
        if page == COMMANDS:
            noted.append((f"tetherfmu {title}", "command", section["ids"][0]))
        kind = kinds[head[0][0].astext()].format(
            "several" if page == EXAMPLES and title in KINDS else KINDS.get(title, title)
        )
        for row in next(table.findall(nodes.tbody)):
            for name in names_of(page, title, row):
                anchor = re.sub(r"[^\w.-]", "", re.sub(r"\[.*", "", name.removeprefix("tetherfmu ").replace(" ", "")))
                if anchor not in taken:
                    row["ids"].append(anchor)
                    taken.add(anchor)
                    noted.append((shown(name), kind, anchor))


def setup(app):
    """Connect all."""
    app.add_domain(Rows)
    app.connect("doctree-read", note_rows)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
