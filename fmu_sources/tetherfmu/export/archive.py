"""Assemble FMUs: compiled kernels, the folders `runtime`, `wiring` and `fmi`, PythonFMU's wrapper, one archive.

Inside an FMU the names of the slave script and the package contain a hash of their content, so that FMUs of different
versions coexist in one process. Equal sources and options yield equal bytes.
"""

import hashlib
import json
import shutil
import sys
import tempfile
import zipfile
from pathlib import Path

from pythonfmu.builder import FmuBuilder

from tetherfmu.fmi.resources import KERNELS_FOLDER, OPTIONS_FILE
from tetherfmu.libraries import ready
from tetherfmu.libraries.sources import PACKAGE
from tetherfmu.libraries.whole_files import whole
from tetherfmu.runtime.kernel_library import NO_LIBRARY_OF_PYTHONFMU, PYTHONFMU, file_name
from tetherfmu.runtime.variants import EVERY_VARIANT, class_name, library_of

from . import osp
from .build_options import BuildOptions
from .documents import OSP_FOLDER, documents
from .rehearsal import check_start

SLAVES = {class_name(each): each for each in EVERY_VARIANT}  # name of the FMU: variant
SLAVE = '''"""PythonFMU slave."""

from .fmi.slave import TetherSlave


class {name}(TetherSlave):
    variant, description = {variant!r}, {description!r}
'''
SHIPPED = ("runtime", "wiring", "fmi")  # folders of the package that every FMU has
# PythonFMU executes the script for each instance and keeps its definitions: 6 kB if that is a class
LAUNCHER = """from {package}.{module} import {name}
from {package}.fmi.workarounds import hold

hold(globals())
"""
DATE, GENERATED = (2026, 1, 1, 0, 0, 0), "2026-01-01T00:00:00Z"
DESCRIPTION = "modelDescription.xml"
GUID_DIGITS, PACKAGE_DIGITS = 32, 12  # hexadecimal, of hashes: as many as a guid has, and enough to tell packages apart
FILE_MODE = 0o644 << 16  # of an entry of an archive: rw-r--r--, where Unix has it


def build(name, folder, options=None):
    """Build one FMU and return its path; RuntimeError if the compiler or the linker fails.

    ValueError names unsupported options or start values.

    name : one of `SLAVES`.  folder : of the FMU, created if missing; the groups of variables for the Open Simulation
    Platform are written beside it (`osp.py`).  options : `BuildOptions`; None for the defaults.
    """
    folder, options = Path(folder), options or BuildOptions()
    folder.mkdir(parents=True, exist_ok=True)
    variant = SLAVES[name]
    about, given = options.description_of(variant), options.of_slave(variant)
    check_start(variant, given)
    files = packed_with_kernels(name, variant, about, library_of(variant), options.platforms, given)
    files.update(documents(name, variant, about, options, given))
    seal(files)
    return write(files, folder, name, options.purpose)


def packed_with_kernels(name, variant, about, library, platforms, options):
    """Files of an FMU with PythonFMU's model description, dict of path to bytes; RuntimeError if compiling fails.

    It includes PythonFMU's libraries only for the platforms of the kernels; RuntimeError if PythonFMU lacks one.
    name : class of the slave.  variant : None for a system.  about : description.  library : of its kernels.  options : dict
    that it reads at run time.
    """
    compiled = ready.folders([library], platforms)[library]
    kernels = [compiled / file_name(library, platform) for platform in platforms]
    text = SLAVE.format(name=name, variant=variant, description=about)
    with tempfile.TemporaryDirectory() as temporary:
        resources = Path(temporary) / "resources"
        shipped = write_package(resources, name, f"tether_{variant or library}.py", text, kernels)
        (resources / KERNELS_FOLDER).mkdir()
        for each in kernels:
            shutil.copy(each, resources / KERNELS_FOLDER)
        (resources / OPTIONS_FILE).write_text(json.dumps(options, sort_keys=True))
        files = pack(resources, shipped, Path(temporary))
    idle = tuple(folder for platform, folder in PYTHONFMU.items() if platform not in platforms)
    made = {path: content for path, content in files.items() if not path.startswith(idle)}
    if not any(path.startswith("binaries/") for path in made):
        raise RuntimeError(NO_LIBRARY_OF_PYTHONFMU.format(platforms=", ".join(platforms)))
    return made


def guid_of(description, files):
    """A guid that is a hash of a model description without one, and of the other files."""
    digest = hashlib.sha256(description.encode("utf-8"))
    for name in sorted(files):
        digest.update(name.encode("utf-8") + files[name])
    return f"{{{digest.hexdigest()[:GUID_DIGITS]}}}"


def seal(files):
    """Give the model description that PythonFMU has written a fixed date, and a guid from all files (modified)."""
    text = files.pop(DESCRIPTION).decode("utf-8")
    text = _replace_attribute(_replace_attribute(text, "generationDateAndTime", GENERATED), "guid", "")
    files[DESCRIPTION] = _replace_attribute(text, "guid", guid_of(text, files)).encode("utf-8")


def write(files, folder, name, purpose):
    """Write a tether FMU, and beside it the file for libcosim; returns its path.

    files : dict of path in the archive to bytes.  purpose : `build_options.Purpose` or None.
    """
    osp_file = f"{OSP_FOLDER}/{osp.file_name(name)}"
    if osp_file in files and not purpose:
        with whole(folder / osp.file_name(name)) as unfinished:
            unfinished.write_bytes(files[osp_file])
    return write_archive(files, folder / (f"{name}_{purpose.name}.fmu" if purpose else f"{name}.fmu"))


def write_archive(files, target):
    """Write an archive whole or not at all, with fixed dates and sorted entries; returns its path."""
    with whole(target) as unfinished, zipfile.ZipFile(unfinished, "w") as archive:
        for name in sorted(files):
            item = zipfile.ZipInfo(name, DATE)
            item.compress_type = zipfile.ZIP_DEFLATED
            item.external_attr = FILE_MODE
            archive.writestr(item, files[name])
    return target


def write_package(resources, name, file, text, kernels=(), modules=()):
    """Write the package with the slave, and its launcher, under names with a hash of both; returns both paths.

    name : class of the slave.  file, text : of its module.  kernels : compiled libraries, for the hash.
    modules : more files that it imports. Folders of this package remain folders there, other files are beside them.
    """
    sources = {file: text.replace("from tetherfmu.", "from .")}
    for path in (*(each for folder in SHIPPED for each in sorted((PACKAGE / folder).glob("*.py"))), *modules):
        inside = path.relative_to(PACKAGE) if path.parent.parent == PACKAGE else Path(path.name)
        own = path.read_text(encoding="utf-8")
        sources[inside.as_posix()] = own.replace("from tetherfmu.", f"from {'.' * len(inside.parts)}")
    # with the name of the module: a package is loaded from the folder of one FMU, which may vanish before another needs it
    content = json.dumps([file, sources], sort_keys=True).encode("utf-8")
    content += b"".join(each.read_bytes() for each in kernels)
    digest = hashlib.sha256(content).hexdigest()[:PACKAGE_DIGITS]
    package, module = resources / f"tetherfmu_{digest}", Path(file).stem
    for inside, own in sources.items():
        (package / inside).parent.mkdir(parents=True, exist_ok=True)
        (package / inside).write_text(own, encoding="utf-8", newline="\n")
    launcher = resources / f"{module}_{digest}.py"
    start = LAUNCHER.format(package=package.name, module=module, name=name)
    launcher.write_text(start, encoding="utf-8", newline="\n")
    return launcher, package


def pack(resources, shipped, folder):
    """Make PythonFMU create the archive: dict of path to bytes; leaves no trace of the hashed modules in this process."""
    script, package = shipped
    path = list(sys.path)
    beside = [each for each in resources.iterdir() if each != script]
    try:
        with zipfile.ZipFile(FmuBuilder.build_FMU(script, dest=folder, project_files=beside)) as made:
            names = [name for name in made.namelist() if not name.endswith("/") and "__pycache__" not in name]
            return {name: made.read(name) for name in names}
    finally:
        sys.path[:] = path
        for module in [name for name in sys.modules if name.split(".")[0] in (script.stem, package.name)]:
            del sys.modules[module]


def _replace_attribute(description, name, value):
    """The description with another value of the first attribute of this name."""
    opening = f' {name}="'
    start = description.index(opening) + len(opening)
    return description[:start] + value + description[description.index('"', start) :]
