"""Assemble FMUs: PythonFMU packs the slave script, then the archive is rewritten so that equal sources give equal bytes."""

import hashlib
import json
import tempfile
import zipfile
from pathlib import Path

from pythonfmu.builder import FmuBuilder

from .fmi import OPTIONS_FILE

SOURCES = Path(__file__).resolve().parent.parent
SLAVES = {
    "TetherStraight": "tether_straight.py",
    "TetherCatenary": "tether_catenary.py",
    "TetherQuasiSteady": "tether_quasi_steady.py",
    "TetherDynamic": "tether_dynamic.py",
}
DATE = (2026, 1, 1, 0, 0, 0)
DATE_TEXT = "2026-01-01T00:00:00Z"


def build(name, folder, segments, shape_points):
    """Build one FMU.

    Parameters
    ----------
    name : str
        One of `SLAVES`.
    folder : Path
        Where the FMU goes; made if missing.
    segments : int
        Start value of the parameter `segments`.
    shape_points : int
        Points of the output `shape`; 0 leaves it out.

    Returns
    -------
    Path
        Of the FMU.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as temporary:
        options = Path(temporary) / OPTIONS_FILE
        options.write_text(json.dumps({"segments": segments, "shape_points": shape_points}, sort_keys=True))
        raw = FmuBuilder.build_FMU(SOURCES / SLAVES[name], dest=temporary, project_files=[options])
        target = folder / f"{name}.fmu"
        partial = folder / f"{name}.fmu.partial"
        _rewrite(raw, partial)
        partial.replace(target)
    return target


def platforms(path):
    """Platforms an FMU has binaries for."""
    with zipfile.ZipFile(path) as archive:
        return sorted({entry.split("/")[1] for entry in archive.namelist() if entry.startswith("binaries/")})


def _rewrite(source, target):
    """Copy an FMU with a guid from its content, fixed dates and sorted entries."""
    with zipfile.ZipFile(source) as archive:
        files = {entry: archive.read(entry) for entry in archive.namelist() if not entry.endswith("/")}
    description = files["modelDescription.xml"].decode("utf-8")
    description = _replace_attribute(description, "generationDateAndTime", DATE_TEXT)
    description = _replace_attribute(description, "guid", "")
    digest = hashlib.sha256(description.encode("utf-8"))
    for entry in sorted(files):
        if entry != "modelDescription.xml":
            digest.update(entry.encode("utf-8"))
            digest.update(files[entry])
    description = _replace_attribute(description, "guid", f"{{{digest.hexdigest()[:32]}}}")
    files["modelDescription.xml"] = description.encode("utf-8")
    with zipfile.ZipFile(target, "w") as archive:
        for entry in sorted(files):
            item = zipfile.ZipInfo(entry, DATE)
            item.compress_type = zipfile.ZIP_DEFLATED
            item.external_attr = 0o644 << 16
            archive.writestr(item, files[entry])


def _replace_attribute(description, name, value):
    """The description with another value of the first attribute of this name."""
    start = description.index(f' {name}="') + len(name) + 3
    return description[:start] + value + description[description.index('"', start) :]
