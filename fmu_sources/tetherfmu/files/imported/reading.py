"""Detects the program of a file, and whether its result can be read here."""

import tomllib

from tetherfmu.files import scene_files as scenes
from tetherfmu.files import system_files as systems
from tetherfmu.files.toml_files import contents_of

from . import kiteutils, moordyn
from .written import said, toml


def imported(path):
    """`Imported` of a file, its text in TOML, and sentences on it; ValueError without the name of the file is one."""
    text = contents_of(path).decode("utf-8", errors="replace")
    if moordyn.HAS_IT.search(text):
        made = moordyn.system(text)
    elif kiteutils.HAS_IT.search(text):
        made = kiteutils.imported(text)
    else:
        raise ValueError(
            "is neither a file of settings of KiteUtils.jl, with a section tether, nor one of MoorDyn v2 or CableDyn, "
            "with a section LINE TYPES"
        )
    written = toml(made, path.name)
    table = tomllib.loads(written)
    if made.kind == "scene":
        scenes.read(table, path.parent, "imported")
    else:
        systems.read(table, "imported")
    return made, written, list(said(made))
