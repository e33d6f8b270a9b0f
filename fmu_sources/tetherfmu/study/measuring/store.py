"""Results on disk as they finish: a line of JSON for each point, arrays for a reference. A kill loses nothing finished."""

import hashlib
import json
import os
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

from tetherfmu.console.ending import WorkersLost, is_stop
from tetherfmu.libraries.sources import PACKAGE
from tetherfmu.libraries.whole_files import whole

from .errors import DAMAGED, read_reference, write_reference

POINTS = "points.jsonl"  # file of the points of a trade-off study
KEPT = "the finished points are kept, and the same command continues from them"


@cache
def digest(folder):
    """Hash of all sources and tables in a folder: results of other sources are not reused."""
    files = sorted(path for path in folder.rglob("*") if path.suffix in (".py", ".csv"))
    contents = (path.relative_to(folder).as_posix().encode() + path.read_bytes() for path in files)
    return hashlib.sha256(b"".join(contents)).hexdigest()[:12]


def key(*what):
    """Name of a result: a hash of the sources of the package, and of its arguments."""
    return hashlib.sha256(repr((digest(PACKAGE), *what)).encode()).hexdigest()[:24]


@contextmanager
def keeping():
    """Report that finished points are stored if Ctrl-C, a full disk, or a loss of workers ends the block."""
    try:
        yield
    except OSError as error:
        error.strerror = f"{error.strerror}; {KEPT}"
        raise
    except (KeyboardInterrupt, WorkersLost) as end:
        end.args = ("; ".join([*end.args, KEPT]),)
        raise
    except RuntimeError as error:
        if is_stop(error):
            raise KeyboardInterrupt(KEPT) from None
        raise


class Store:
    """A file of finished results, with a folder for entire objects.

    points : dict of results by key, including earlier runs.
    """

    def __init__(self, file):
        self._file = Path(file)
        self.folder = self._file.parent
        self.folder.mkdir(parents=True, exist_ok=True)
        self.points = {}
        text = self._file.read_text(encoding="utf-8") if self._file.exists() else ""
        for line in text.splitlines():
            with suppress(AttributeError, KeyError, TypeError, ValueError):  # a kill may have come while it was written
                stored = json.loads(line)
                self.points[stored.pop("key")] = stored
        if text and not text.endswith("\n"):
            self._append("\n")

    def add(self, key, point):
        """Keep a point, a dict of numbers and texts; it is on disk when this returns."""
        self.add_all({key: point})

    def add_all(self, points):
        """Keep several points by key likewise, at the cost of one."""
        self.points |= points
        self._append("".join(json.dumps({"key": key, **point}) + "\n" for key, point in points.items()))

    def _append(self, text):
        with open(self._file, "a", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())

    def kept(self, key, make):
        """The stored `Reference` that `make` returned for this key; made again if its file is damaged."""
        path = self.folder / f"{key}.npz"
        if path.exists():
            with suppress(*DAMAGED):
                return read_reference(path)
        made = make()
        with whole(path) as unfinished:
            write_reference(unfinished, made)
        return made
