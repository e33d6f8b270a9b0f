"""Sphinx extension: where lines of a page may break.

Names in tables break between their words, on a phone only (`site_files/wide.css`). An option such as `--out` and a number
with its unit do not break, nor a formula and the full stop after it. The search has the text as written.
"""

import re

TABLE = re.compile(r"<table.*?</table>", re.DOTALL)
NAME = re.compile(r'(?<=<span class="pre">)[^<]+')
IN_NAME = re.compile(r"(?<=[_./])(?=\w)|(?<=[a-z])(?=[A-Z])")
INLINE_OPTION = re.compile(r'<span class="pre">(?=-)')
FORMULA_AND_STOP = re.compile(r'<span class="math notranslate nohighlight">[^<]*</span>[.,;:)]+')
TAG = re.compile(r"(<[^>]*>)")
CLOSED = re.compile(r"<(/?)(pre|code|script|style|svg)\b")
OPTION = re.compile(r"(?<![\w-])--?[a-zA-Z][\w-]*")
UNIT = re.compile(
    r"(?<=\d) (?=(?:%|°|[kM]?[NWJ]|GN|[mcµk]?m|[mµ]?s|kg|[kM]?Hz|m/s|km/s|[MG]Pa|rad|rms|kB|MB|\d{3})(?![\w]))(?!\d{3}\d)"
)


def breaks_in_names(body):
    """Let the names in tables break between their words."""
    return TABLE.sub(lambda table: NAME.sub(lambda name: IN_NAME.sub("<wbr>", name[0]), table[0]), body)


def whole_numbers_and_options(body):
    """Keep numbers with their units, and options of commands, on one line."""
    body = FORMULA_AND_STOP.sub(r'<span class="whole">\g<0></span>', body)
    parts, within = TAG.split(INLINE_OPTION.sub('<span class="pre option">', body)), []
    for k, part in enumerate(parts):
        if part.startswith("<"):
            if found := CLOSED.match(part):
                within = within[:-1] if found[1] else [*within, found[2]]
        elif "pre" in within:
            parts[k] = OPTION.sub(r'<span class="option">\g<0></span>', part)
        elif not within:
            parts[k] = UNIT.sub("&#160;", part)
    return "".join(parts)


def set_breaks(app, pagename, templatename, context, doctree):
    """Do both to a page."""
    if doctree is not None:
        context["body"] = whole_numbers_and_options(breaks_in_names(context["body"]))


def setup(app):
    """Connect."""
    app.connect("html-page-context", set_breaks)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
