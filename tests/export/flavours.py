"""FMUs of files of systems in all flavours: by PythonFMU, and native ones for FMI 2 and 3."""

import pytest

from runtime.host import STEP, blob_of, restore
from tetherfmu.check.__main__ import main as check
from tetherfmu.export import systems

FLAVOURS = (0, 2, 3)  # version of FMI of a native FMU; 0 by PythonFMU
every_flavour = pytest.mark.parametrize("native", FLAVOURS)


def build_all(folder, *files):
    """Build an FMU of each file and flavour, in a folder of its own for each flavour."""
    for file in files:
        for native in FLAVOURS:
            systems.build(file, folder / str(native), native=native or None)


def go_astray_and_back(host, **inputs):
    """Take a step with other inputs, and go back to the state of before."""
    blob = blob_of(host)
    host.step(STEP, **inputs)
    restore(host, blob)


def assert_checks_pass(folder, capfd, steps=100):
    """All FMUs of `build_all` pass the check, with an evidence set of so many steps; None: without any."""
    fmus = list(map(str, folder.glob("*/*.fmu")))
    assert check(fmus) == 0
    assert capfd.readouterr().out.count(f"evidence set: {steps} steps" if steps else "no evidence set") == len(fmus) > 0
