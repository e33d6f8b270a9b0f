"""A library compiled by the first numba that the project promises, and by the last one on another Python: the same numbers.

    .venv/bin/python tests/libraries/ends_of_numba.py

Each has an environment of its own, .venv-numba-VERSION. A Python that is not on this machine is left out.
"""

import os
import subprocess
import sys
import tomllib
from pathlib import Path

from tetherfmu.libraries.ready import TESTED

PROJECT = Path(__file__).parents[2]
OTHERS = ["python3.13", *map(str, Path.home().glob(".pyenv/versions/3.13.*/bin/python"))]  # where another Python may be
FLIGHT = """
import sys, numba, tetherfmu
tether = tetherfmu.TetherStraight(wind_profile="explog", air_density_scale_height=8550.0)
tether.initialize()
for k in range(100):
    kite = {"kite_position": (300.0, 0.1 * k, 400.0), "kite_velocity": (0.0, 5.0, 0.0)}
    last = tether.step(0.02, wind_velocity=(8.0, 1.0, 0.0), **kite)
print(f"numba {numba.__version__} on Python {sys.version.split()[0]}:", *map(float.hex, last.kite_force.tolist()))
"""


def flown(python):
    """What the flight prints: who has compiled its library, and the last force; by which Python."""
    environment = os.environ | {"PYTHONPATH": str(PROJECT / "fmu_sources")}
    done = subprocess.run([python, "-c", FLIGHT], env=environment, stdout=subprocess.PIPE, text=True, check=True)
    return done.stdout.strip()


def environment_of(python, version):
    """Python of an environment that has this numba, and what else compiles and flies a library."""
    project = tomllib.loads((PROJECT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    folder = PROJECT / f".venv-numba-{version}"
    subprocess.run([python, "-m", "venv", folder], check=True)
    found = folder / ("Scripts" if sys.platform == "win32" else "bin") / "python"
    wanted = [*project["dependencies"], *project["optional-dependencies"]["build"], f"numba=={version}.*"]
    subprocess.run([found, "-m", "pip", "install", "--quiet", "--no-compile", *wanted], check=True)
    return found


def is_there(python):
    """Whether this machine has a Python; a name may lead to none."""
    try:
        return subprocess.run([python, "-c", ""], capture_output=True, check=False).returncode == 0
    except OSError:
        return False


def main():
    """Compile, fly and compare; returns 1 if the numbers differ."""
    first, last = (f"{major}.{minor}" for major, minor in TESTED)
    pairs = [(sys.executable, first), *((python, last) for python in filter(is_there, OTHERS))][:2]
    found = [flown(sys.executable), *(flown(environment_of(*pair)) for pair in pairs)]
    print(*found, sep="\n")
    return int(len({each.partition(":")[2] for each in found}) > 1)


if __name__ == "__main__":
    sys.exit(main())
