"""Write all that follows from the sources alone, pages and the picture of the house: `python docs/make/make_pages.py`."""

from pathlib import Path
from runpy import run_path

SCRIPTS = ("commands", "variables", "keys_of_maps", "scene_files", "example_fmus", "house")

if __name__ == "__main__":
    for name in SCRIPTS:
        run_path(str(Path(__file__).with_name(f"make_{name}.py")), run_name="__main__")
