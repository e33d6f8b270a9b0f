"""Draw docs/figures/tutorial/*.png, the figures of all lessons, in few colours; `python docs/make/make_tutorial.py`."""

import sys
from pathlib import Path

from PIL import Image

from tetherfmu.__main__ import main as tetherfmu

FIGURES = Path(__file__).resolve().parents[1] / "figures" / "tutorial"
COLOURS = 256  # of a picture


def main():
    """Run the lessons, make their figures small; returns the exit status."""
    status = tetherfmu(["tutorial", "all", "--out", str(FIGURES)])
    for path in FIGURES.glob("*.png"):
        Image.open(path).convert("RGB").quantize(COLOURS).save(path, optimize=True)
    return status


if __name__ == "__main__":
    sys.exit(main())
