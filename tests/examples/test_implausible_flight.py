"""The example prints what its FMU finds implausible, in one line."""

import subprocess
import sys
from pathlib import Path

EXAMPLE = Path(__file__).parents[2] / "examples" / "first_flight" / "circular_flight.py"


def test_a_tether_that_is_too_short(fmu_folder, tmp_path):
    options = ["--fmu", fmu_folder / "TetherStraight.fmu", "--length", "100", "--duration", "1", "--out", tmp_path]
    done = subprocess.run([sys.executable, EXAMPLE, *options], capture_output=True, text=True, check=True)
    assert done.stdout.count("stretched by 400 %, where any rope is broken") == 1
    assert done.stdout.count("%%") == 0
