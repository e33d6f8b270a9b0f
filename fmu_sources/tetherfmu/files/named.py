"""The scenes that come with TetherFMU, by name."""

from pathlib import Path

from tetherfmu.libraries.examples import EXAMPLES
from tetherfmu.runtime.naming import meant_or_all

from .toml_files import tables_of

FOLDERS = ("scenes", "first_flight", "cranes", "wind")  # of the examples


def named_scenes():
    """Paths of the scene files that come with TetherFMU, by name."""
    return {path.stem: path for folder in FOLDERS for path in sorted((EXAMPLES / folder).glob("*.toml"))}


def named_systems():
    """Paths of the files of systems that come with TetherFMU, by name."""
    return {path.stem: path for path in sorted((EXAMPLES / "systems").glob("*.toml"))}


def path_of(given, known=None):
    """Path of a scene file from a path, or from a name; ValueError for an unknown name.

    known : paths by name; None: those of `named_scenes`.
    """
    path, known = Path(given), named_scenes() if known is None else known
    if path.suffix or path.exists():
        return path
    if str(given) not in known:
        raise ValueError(f"there is no file and no scene {str(given)!r}{meant_or_all(str(given), known, 'scenes are {}')}")
    return known[str(given)]


def about(path):
    """Description of a scene file: the first sentence of its first lines, which begin with #."""
    lines = path.read_text(encoding="utf-8").splitlines()
    count = next((k for k, line in enumerate(lines) if not line.startswith("#")), len(lines))
    return " ".join(line.lstrip("# ") for line in lines[:count]).partition(". ")[0].rstrip(".")


def listed():
    """The named scenes and systems as lines of text: name, description, for a scene the duration."""
    scenes, systems = named_scenes(), named_systems()
    width = max(map(len, (*scenes, *systems))) + 2
    found = [f"{name:<{width}}{about(path)}; {tables_of(path)['duration']}" for name, path in scenes.items()]
    for name, path in systems.items():
        rests = (
            "whose driven points rest" if "series" not in (table := tables_of(path)) else table.get("duration", "in motion")
        )
        found.append(f"{name:<{width}}{about(path)}; a system, {rests}")
    return found
