"""Tables of the manual, for the tests that measure their numbers anew."""

import re
from pathlib import Path

DOCS = Path(__file__).resolve().parents[1] / "docs"


def table(page, head):
    """Rows of numbers of the table with this first line in a page of the manual; a percent sign is left out."""
    (path,) = DOCS.rglob(f"{page}.md")
    lines = path.read_text(encoding="utf-8").partition(f"\n{head}\n")[2].splitlines()[1:]
    rows = lines[: next(k for k, line in enumerate(lines) if not line.startswith("|"))]
    return [[float(number) for number in re.findall(r"\| ([\d.]+)", row)] for row in rows]
