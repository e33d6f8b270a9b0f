"""Write the table of constants of a map into docs/use/your_log.md: `python docs/make/make_keys_of_maps.py`."""

import re
from pathlib import Path

import pandas as pd

from tetherfmu.runtime.quantities import quantities
from tetherfmu.study.measuring.tables import markdown
from tetherfmu.study.replay.columns import OF_SCENES, OWN

PAGE = Path(__file__).resolve().parents[1] / "use" / "your_log.md"
BEGIN, END = "<!-- constants: written by docs/make/make_keys_of_maps.py -->", "<!-- end of constants -->"


def table():
    """A row for each constant that only maps have, Markdown; then the sections that they share with scenes."""
    rows = [
        {"key": f"`{section}.{name}`", "default": f"{getattr(kind(), name):g} {each.unit}".strip(), "meaning": each.meaning}
        for section, kind in OWN.items()
        for name, each in quantities(kind)
    ]
    shared = ", ".join(f"`{section}`" for section in OF_SCENES)
    text = f"The sections {shared} have the keys of [scene files](scene_files.md)."
    return f"{markdown(pd.DataFrame(rows))}\n\n{text}"


def page():
    """The page with the table in its place."""
    old = PAGE.read_text(encoding="utf-8")
    return re.sub(f"{BEGIN}.*{END}", lambda _: f"{BEGIN}\n\n{table()}\n\n{END}", old, flags=re.DOTALL)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
