"""FMUs that are kept for the user, so that `tetherfmu fly` need not write into the folder one is in.

They are where the platform has such files, `~/.cache/tetherfmu` on Linux (or below `XDG_CACHE_HOME`),
`~/Library/Caches/tetherfmu` on macOS, `%LOCALAPPDATA%\\tetherfmu` on Windows, in a folder that is named by all sources: an
edit or another version never takes old ones. It may be deleted at any time.
"""

import os
import sys
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path

from shared import example_fmus
from tetherfmu.export import archive
from tetherfmu.libraries.examples import EXAMPLES
from tetherfmu.libraries.sources import PACKAGE
from tetherfmu.runtime import __version__

SOURCES = {".c", ".h", ".html", ".py", ".txt"}  # ends of the names of files that FMUs are made from


def kept(name):
    """Path of an FMU of a tether or of the examples, built with the default options if it is not there."""
    file = folder() / f"{name}.fmu"
    if file.exists():
        return file
    return build(name, file.parent)


def build(name, place):
    """Build an FMU of a tether or of the examples with the default options into a folder, and say so; its path."""
    make = example_fmus.build if name in example_fmus.SLAVES else archive.build
    file = make(name, place)
    print(f"{file} is built", file=sys.stderr)
    return file


@cache
def folder():
    """Where they are."""
    content = sha256(f"pythonfmu {version('pythonfmu')}".encode())
    for root in (PACKAGE, EXAMPLES / "fmus", EXAMPLES / "shared"):
        for path in sorted(each for each in root.rglob("*") if each.suffix in SOURCES):
            content.update(path.relative_to(root).as_posix().encode("utf-8"))
            content.update(path.read_bytes())
    return of_user() / f"fmus_{__version__}_{content.hexdigest()[:12]}"


def of_user():
    """Folder of this project among those of the user that may be deleted at any time."""
    if sys.platform == "win32":
        place = os.environ.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local"
    elif sys.platform == "darwin":
        place = Path.home() / "Library" / "Caches"
    else:
        place = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(place) / "tetherfmu"
