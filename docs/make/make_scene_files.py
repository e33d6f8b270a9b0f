"""Write docs/use/scene_files.md and docs/data/scene_keys.csv from the sources: `python docs/make/make_scene_files.py`."""

from pathlib import Path

import pandas as pd

from advice.page import TEMPLATES
from tetherfmu.files.flights import KINDS
from tetherfmu.files.scene_files import NOT_OF_A_SCENE, OUTPUTS, RECORDS, Scene
from tetherfmu.files.toml_files import spellings
from tetherfmu.files.winds import Box
from tetherfmu.runtime.quantities import quantities
from tetherfmu.study.measuring.tables import page as filled

DOCS = Path(__file__).resolve().parents[1]
PAGE, KEYS = DOCS / "use" / "scene_files.md", DOCS / "data" / "scene_keys.csv"
SHARED = ("tether", "environment", "ground", "winch")  # sections that have the parameters of the FMU


def of_a_scene(record):
    """Pairs (name, Quantity) of a record that a scene file may give."""
    return [(name, declared) for name, declared in quantities(record) if name not in NOT_OF_A_SCENE]


def keys():
    """Table of all keys that are numbers, with units, default and limits."""
    sections = {"": Scene} | RECORDS | {"wind.box": Box} | {f"flight ({kind})": flight for kind, flight in KINDS.items()}
    rows = [
        {
            "section": section,
            "key": name,
            "units": spellings(declared.unit),
            "default": f"{getattr(record, name):.4g}",
            "allowed": declared.in_words(),
            "meaning": declared.meaning,
        }
        for section, record in sections.items()
        for name, declared in of_a_scene(record)
    ]
    return pd.DataFrame(rows).to_csv(index=False)


def page():
    """Text of docs/use/scene_files.md."""
    shared = {name: ", ".join(f"`{key}`" for key, _ in of_a_scene(RECORDS[name])) for name in SHARED}
    records = RECORDS | {"wind.box": Box}
    facts = {"shared": shared, "records": records, "flights": KINDS, "outputs": OUTPUTS, "quantities": quantities}
    return filled("scene_files.md.j2", TEMPLATES, **facts)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    KEYS.write_text(keys(), encoding="utf-8")
