"""The manual, for tests that run what it shows."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "docs"
DATA = DOCS / "data"


def page(name):
    """Text of a page, by its path in `docs`."""
    return (DOCS / f"{name}.md").read_text(encoding="utf-8")


def blocks(text):
    """Blocks of code of a page, in order: pairs of language and code."""
    return re.findall(r"^```(\w+)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def codes(text, language):
    """The blocks of a language."""
    return [code for kind, code in blocks(text) if kind == language]


def shown(text):
    """The first block of Python that is followed by what it prints, and that."""
    return re.search(r"```python\n(.*?)```\n\n```text\n(.*?)```", text, re.DOTALL).groups()
