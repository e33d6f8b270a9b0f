"""Make the folder that users download from: FMUs for all platforms, wheel and sdist, checksums, what to download when."""

import argparse
import hashlib
import subprocess
import sys
from pathlib import Path

from tetherfmu.export.documents import filled
from tetherfmu.libraries.ahead_of_time import TARGETS
from tetherfmu.libraries.sources import PACKAGE
from tetherfmu.runtime import __version__

from . import build

CHECKOUT = PACKAGE.parents[1]
README, CHECKSUMS = "README.txt", "SHA256SUMS"


def make_packages(folder):
    """Write wheel and sdist of the checkout to a folder; RuntimeError with what was said if that fails."""
    if not (CHECKOUT / "pyproject.toml").exists():
        raise RuntimeError("a release is made in a checkout of the sources, not by an installed wheel")
    command = [sys.executable, "-m", "build", "--no-isolation", "--sdist", "--wheel", "--outdir", str(folder), str(CHECKOUT)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise RuntimeError(f'{(done.stdout + done.stderr).strip()}\n(what it needs comes with: pip install -e ".[release]")')


def write_checksums(folder):
    """Write SHA256SUMS, as `sha256sum --check` reads it, for all other files of a folder."""
    files = sorted(path for path in folder.iterdir() if path.is_file() and path.name != CHECKSUMS)
    lines = [f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in files]
    (folder / CHECKSUMS).write_text("".join(lines), encoding="ascii", newline="\n")


def main(arguments=None):
    """Make the release; returns the exit status."""
    parser = argparse.ArgumentParser(prog="tetherfmu release", description="Make a folder with all that users download.")
    parser.add_argument(
        "--out", default="release", type=Path, metavar="DIR", help="an empty or new folder (default: release)"
    )
    folder = parser.parse_args(arguments).out
    try:
        if folder.exists() and any(folder.iterdir()):
            raise RuntimeError(f"{folder} is not empty")
        if build.main(["--out", str(folder), "--platforms", "all"]) != 0:
            return 1
        make_packages(folder)
        platforms = ", ".join(TARGETS)
        text = filled("release.txt", version=__version__, platforms=platforms)
        (folder / README).write_text(text, encoding="utf-8", newline="\n")
        write_checksums(folder)
    except (OSError, RuntimeError) as error:
        print(f"no release: {error}", file=sys.stderr)
        return 1
    print("\n".join(f"{path}  {path.stat().st_size / 1024:.0f} kB" for path in sorted(folder.iterdir())))
    return 0
