"""Write the table of materials into docs/reference/api.md: `python docs/make/make_materials.py`."""

import re
from pathlib import Path

from tetherfmu import MATERIALS

PAGE = Path(__file__).resolve().parents[1] / "reference" / "api.md"
BEGIN, END = "<!-- materials: written by docs/make/make_materials.py -->", "<!-- end of materials -->"


def table():
    """A row for each source, with the materials that it is of, Markdown."""
    names = {}
    for name, material in MATERIALS.items():
        names.setdefault(material, []).append(f"`{name}`")
    rows = [
        f"| {', '.join(listed)} | {each.density:.0f} | {1e-9 * each.modulus:.3g} | {each.source} |"
        for each, listed in names.items()
    ]
    return "\n".join(["| material | density [kg/m³] | modulus [GPa] | source |", "|---|---|---|---|", *rows])


def page():
    """The page with the table in its place."""
    old = PAGE.read_text(encoding="utf-8")
    return re.sub(f"{BEGIN}.*{END}", lambda _: f"{BEGIN}\n\n{table()}\n\n{END}", old, flags=re.DOTALL)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
