"""Make the folder that users download from: FMUs for all platforms, wheel and sdist, checksums, what to download when."""

import hashlib
import sys
from importlib.util import find_spec

from tetherfmu.console.ending import FAILED, WrongUse, command
from tetherfmu.console.options import Parser, folder
from tetherfmu.console.progress import now
from tetherfmu.export.documents import filled
from tetherfmu.libraries.ahead_of_time import TARGETS
from tetherfmu.libraries.children import finished
from tetherfmu.libraries.sources import PACKAGE
from tetherfmu.runtime import __version__

from . import build

CHECKOUT = PACKAGE.parents[1]
README, CHECKSUMS = "README.txt", "SHA256SUMS"


def make_packages(folder):
    """Write wheel and sdist of the checkout to a folder; RuntimeError with what was said if that fails."""
    options = ("--no-isolation", "--sdist", "--wheel", "--outdir")
    done = finished([sys.executable, "-m", "build", *options, str(folder), str(CHECKOUT)])
    if done.returncode != 0:
        said = " ".join((done.stdout + done.stderr).split())
        raise RuntimeError(f'no release: {said} (what it needs comes with: pip install -e ".[release]")')


def write_checksums(folder):
    """Write SHA256SUMS, as `sha256sum --check` reads it, for all other files of a folder."""
    files = sorted(path for path in folder.iterdir() if path.is_file() and path.name != CHECKSUMS)
    lines = [f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in files]
    (folder / CHECKSUMS).write_text("".join(lines), encoding="ascii", newline="\n")


@command
def main(arguments=None, prog="tetherfmu release"):
    """Make the release; returns the exit status."""
    parser = Parser(prog=prog, description="Make a folder with all that users download.")
    parser.add_argument(
        "--out", default="release", type=folder, metavar="DIR", help="an empty or new folder (default: release)"
    )
    place = parser.parse_args(arguments).out
    if place.exists() and any(place.iterdir()):
        parser.error(f"argument --out: {place} is not empty; it must be an empty or new folder")
    if not (CHECKOUT / "pyproject.toml").exists():
        raise WrongUse("a release is made in a checkout of the sources, not by an installed wheel")
    if find_spec("build") is None:
        raise ModuleNotFoundError(name="build")
    if build.main(["--out", str(place), "--platforms", "all"]) != 0:
        return FAILED
    now("making wheel and sdist")
    make_packages(place)
    text = filled("release.txt", version=__version__, platforms=", ".join(TARGETS))
    (place / README).write_text(text, encoding="utf-8", newline="\n")
    write_checksums(place)
    print("\n".join(f"{path}  {path.stat().st_size / 1024:.0f} kB" for path in sorted(place.iterdir())))
    return 0
