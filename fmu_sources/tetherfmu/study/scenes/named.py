"""The scenes that come with TetherFMU, by name."""

from pathlib import Path

from tetherfmu.input_files import tables_of
from tetherfmu.libraries.examples import EXAMPLES
from tetherfmu.runtime.naming import meant_or_all

FOLDERS = ("scenes", "first_flight", "cranes", "wind")  # of the examples


def named_scenes():
    """Paths of the scene files that come with TetherFMU, by name."""
    return {path.stem: path for folder in FOLDERS for path in sorted((EXAMPLES / folder).glob("*.toml"))}


def path_of(given):
    """Path of a scene file from a path, or from the name of one of `named_scenes`; ValueError if it is no such name."""
    path = Path(given)
    if path.suffix or path.exists():
        return path
    known = named_scenes()
    if str(given) not in known:
        raise ValueError(f"there is no file and no scene {str(given)!r}{meant_or_all(str(given), known, 'scenes are {}')}")
    return known[str(given)]


def about(path):
    """What a scene file says of itself: the first sentence of its first lines, which begin with #."""
    lines = path.read_text(encoding="utf-8").splitlines()
    count = next((k for k, line in enumerate(lines) if not line.startswith("#")), len(lines))
    return " ".join(line.lstrip("# ") for line in lines[:count]).partition(". ")[0].rstrip(".")


def listed():
    """The named scenes in lines for people: name, what it is, how long it takes."""
    known = named_scenes()
    width = max(map(len, known)) + 2
    return [f"{name:<{width}}{about(path)}; {tables_of(path)['duration']}" for name, path in known.items()]
