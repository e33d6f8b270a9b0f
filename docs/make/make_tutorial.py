"""Draw docs/figures/tutorial/*.svg, the figures of all lessons; `python docs/make/make_tutorial.py`."""

import sys
from pathlib import Path

from pictures import as_svg
from tetherfmu.__main__ import main as tetherfmu

FIGURES = Path(__file__).resolve().parents[1] / "figures" / "tutorial"


def main():
    """Run the lessons; returns the exit status."""
    with as_svg():
        return tetherfmu(["tutorial", "all", "--out", str(FIGURES)])


if __name__ == "__main__":
    sys.exit(main())
