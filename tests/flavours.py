"""FMUs in all flavours: by PythonFMU, and native ones for FMI 2 and 3."""

import pytest

from runtime.host import extract_all
from tetherfmu.commands.build import main
from tetherfmu.export import systems
from tetherfmu.export.build_options import BuildOptions

FLAVOURS = {"pythonfmu": None, "native": 2, "native_fmi3": 3}  # version of FMI of a native FMU
NEXT = dict(zip(FLAVOURS, [*FLAVOURS][1:] + [*FLAVOURS][:1], strict=True))  # flavour that takes states over from one
WIND_POINTS = 3  # of the FMUs of the fixture `windy`
every_flavour = pytest.mark.parametrize("flavour", FLAVOURS)


def build_by_command(folder, flavour, *options):
    """Build what the options of the command name, or all tethers, and extract it."""
    native = () if flavour == "pythonfmu" else ("--native", "--header", "--fmi", str(FLAVOURS[flavour]))
    assert main([*options, "--out", str(folder), *native]) == 0
    extract_all(folder)


def folder_of(built_once, flavour):
    """Folder with all FMUs of a flavour."""
    return built_once(f"{flavour}_fmus", lambda folder: build_by_command(folder, flavour))


def build_system(folder, flavour, text, wind_points, with_evidence):
    """Build the FMU of a system, from the text of its file, in a flavour, beside the file.

    with_evidence : or without its evidence set, three flights that take longer than all else.
    """
    file = folder / "system.toml"
    file.write_text(text, encoding="utf-8")
    options = BuildOptions(shape_points=None, wind_points=wind_points)
    with pytest.MonkeyPatch.context() as changed:
        if not with_evidence:
            changed.setattr(systems, "_evidence_of", lambda *given: {})
        systems.build(file, folder, options, native=FLAVOURS[flavour])
    extract_all(folder)
