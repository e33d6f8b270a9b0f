"""What an importer does that compiles an FMU from its C sources."""

import shutil
import subprocess
import zipfile
from pathlib import Path

from fmpy import extract, platform, platform_tuple

from tetherfmu.check.evidence_runs import evidence_of, replay

WARNINGS = ("-Wall", "-Wextra", "-Wpedantic", "-Werror")


def available():
    """Whether sources can be compiled here."""
    return shutil.which("gcc") is not None


def unpacked(path, folder):
    """Folder with the sources of an FMU."""
    return Path(extract(str(path), str(folder / f"{path.stem}_unpacked"))) / "sources"


def run(command, folder):
    """Run a command in a folder; it says nothing and succeeds."""
    done = subprocess.run([str(each) for each in command], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert not done.stderr


def compiled(path, folder, options=()):
    """The library that gcc makes of the sources of an FMU, all warnings being errors."""
    library = folder / f"{path.stem}.so"
    command = ["gcc", "-std=c99", *WARNINGS, *options, "-fPIC", "-shared", "fmu.c", "-o", library, "-lm"]
    run(command, unpacked(path, folder))
    return library


def with_library(path, library, folder, fmi):
    """Path of an FMU like this one with another library for this platform, and no other, in it."""
    copy = folder / path.name
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(copy, "w") as new:
        for item in old.namelist():
            if not item.startswith("binaries/"):
                new.writestr(item, old.read(item))
        new.write(library, f"binaries/{platform_tuple if fmi == 3 else platform}/{path.stem}{library.suffix}")
    return copy


def evidence_run(path):
    """All numbers of the evidence sets of an FMU, as it gives them here: dict by name of the set and of the variable."""
    runs = {kind: replay(path, each) for kind, each in evidence_of(path).items()}
    return {f"{kind} {name}": numbers for kind, run in runs.items() for name, numbers in run.items()}
