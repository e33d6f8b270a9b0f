"""Make the folder that users download from: FMUs of both flavours, wheel and sdist, checksums, what to download when.

python docs/make/make_release.py [--out release]
"""

import hashlib
import shutil
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from string import Template

from tetherfmu.commands import build
from tetherfmu.console.ending import FAILED, command, one_line
from tetherfmu.console.options import Parser, folder
from tetherfmu.console.progress import now
from tetherfmu.libraries.ahead_of_time import TARGETS
from tetherfmu.libraries.children import child
from tetherfmu.runtime import __version__

HERE = Path(__file__).resolve().parent
CHECKOUT = HERE.parents[1]
README, CHECKSUMS = "README.txt", "SHA256SUMS"
NATIVE = {"_native": ("--native",), "_native_fmi3": ("--native", "--fmi", "3")}  # endings of the names of their files


def make_packages(folder):
    """Write wheel and sdist of the checkout to a folder; RuntimeError with what was said if that fails."""
    options = ("--no-isolation", "--sdist", "--wheel", "--outdir", str(folder))
    building = [sys.executable, "-m", "build", *options, str(CHECKOUT)]
    with child(building, stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as process:
        said = process.communicate()[0]
    if process.returncode != 0:
        raise RuntimeError(f'no release: {one_line(said)} (what it needs comes with: pip install -e ".[release]")')


def write_checksums(folder):
    """Write SHA256SUMS, as `sha256sum --check` reads it, for all other files of a folder."""
    files = sorted(path for path in folder.iterdir() if path.is_file() and path.name != CHECKSUMS)
    lines = [f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}\n" for path in files]
    (folder / CHECKSUMS).write_text("".join(lines), encoding="ascii", newline="\n")


def make_fmus(folder):
    """Write the FMUs for all platforms to a folder, native ones under names of their own; returns the exit status."""
    everywhere = ("--platforms", "all")
    status = build.main(["--out", str(folder), *everywhere])
    for ending, options in NATIVE.items():
        with tempfile.TemporaryDirectory() as temporary:
            status = status or build.main(["--out", temporary, *everywhere, *options])
            for path in Path(temporary).glob("*.fmu"):
                shutil.move(path, folder / f"{path.stem}{ending}.fmu")
    return status


def fill(folder):
    """Put all files of a release into a folder; returns the exit status."""
    status = make_fmus(folder)
    if status:
        return status
    now("making wheel and sdist")
    make_packages(folder)
    text = Template((HERE / "release.txt").read_text(encoding="utf-8"))
    about = text.substitute(version=__version__, platforms=", ".join(TARGETS))
    (folder / README).write_text(about, encoding="utf-8", newline="\n")
    write_checksums(folder)
    print("\n".join(f"{path}  {path.stat().st_size / 1000:.0f} kB" for path in sorted(folder.iterdir())))
    return 0


@command
def main(arguments=None):
    """Make the release; returns the exit status."""
    parser = Parser(prog="make_release.py", description="make a folder with all that users download")
    parser.add_argument(
        "--out", default="release", type=folder, metavar="DIR", help="empty or new folder (default: release)"
    )
    place = parser.parse_args(arguments).out
    if place.exists() and any(place.iterdir()):
        parser.error(f"argument --out: {place} is not empty; it must be an empty or new folder")
    if find_spec("build") is None:
        raise ModuleNotFoundError(name="build")
    status = FAILED
    try:
        status = fill(place)
    finally:
        if status:  # the folder was empty, and is so again
            for path in place.glob("*"):
                path.unlink()
    return status


if __name__ == "__main__":
    sys.exit(main())
