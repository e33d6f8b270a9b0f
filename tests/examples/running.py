"""Run the examples in processes of their own, and look at what they draw."""

import os
import subprocess
import sys

import matplotlib.pyplot as plt
import numpy as np

from tetherfmu.libraries.examples import EXAMPLES


def run_python(*arguments, cwd=None):
    """Run Python with the rooms of the examples, in a folder; the finished process."""
    path = os.pathsep.join([str(EXAMPLES), *sys.path])
    return subprocess.run(
        [sys.executable, *map(str, arguments)],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
        timeout=900,
        cwd=cwd,
    )


def run(fmu_folder, code):
    """What Python code prints that finds the FMUs of this test run; it must end cleanly."""
    find = f"fmu_tools.find_fmu = lambda name: {str(fmu_folder)!r} + f'/{{name}}.fmu'"
    done = run_python("-c", f"from shared import fmu_tools\n{find}\nfrom first_flight import circular_flight\n{code}")
    assert done.returncode == 0, done.stderr
    return done.stdout


def assert_is_drawn(file):
    colors = plt.imread(file)[:, :, :3]
    assert np.count_nonzero(np.ptp(colors, axis=-1) > 0.2) > 1000  # coloured pixels; empty axes have none
