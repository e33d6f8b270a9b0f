"""Build the FMUs of the examples: kites, a winch, a flight controller, a prescribed flight, turbulent wind."""

import json
import tempfile
from html import escape
from importlib import import_module
from pathlib import Path
from xml.etree import ElementTree

from tetherfmu.export.archive import DESCRIPTION, pack, seal, write_archive, write_package
from tetherfmu.export.documents import NO_PACKAGES, of_every_fmu, page
from tetherfmu.export.texts import ASSETS, filled
from tetherfmu.fmi.resources import OPTIONS_FILE
from tetherfmu.libraries.sources import PACKAGE
from tetherfmu.runtime import __version__
from tetherfmu.runtime.kernel_library import PYTHONFMU

FOLDER, WIND = Path(__file__).resolve().parents[1] / "fmus", PACKAGE / "wind"
SLAVES = {  # name: script
    "PointMassKite": "point_mass_kite.py",
    "FlyingKite": "flying_kite.py",
    "Winch": "winch.py",
    "WinchMotor": "winch_motor.py",
    "FlightController": "flight_controller.py",
    "KiteOnPath": "kite_on_path.py",
    "TurbulentWind": "turbulent_wind.py",
}
PACKAGES = {"TurbulentWind": "The package numpy has to be installed in it."}


def slave(name):
    """Class of the slave of an FMU of the examples."""
    return getattr(import_module(f"fmus.{Path(SLAVES[name]).stem}"), name)


def table_of(name):
    """Variables of an FMU of the examples."""
    return slave(name)(instance_name=name, resources="").table


def build(name, folder, starts=(), files_inside=()):
    """Build an FMU of the examples and return its path.

    name : one of `SLAVES`.  folder : made if missing.  starts : pairs (input or parameter, start value), where they are not
    the defaults.  files_inside : pairs (file name, bytes) of more files in its resources.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    script = FOLDER / SLAVES[name]
    beside = [each for each in FOLDER.glob("*.py") if each not in (script, FOLDER / "__init__.py")]
    modules = sorted([*beside, *WIND.glob("*.py")])
    with tempfile.TemporaryDirectory() as temporary:
        resources = Path(temporary) / "resources"
        shipped = write_package(resources, name, script.name, script.read_text(encoding="utf-8"), modules=modules)
        (resources / OPTIONS_FILE).write_text(json.dumps({"starts": [list(each) for each in starts]}))
        for file, content in files_inside:
            (resources / file).write_bytes(content)
        files = pack(resources, shipped, Path(temporary))
    description = ElementTree.fromstring(files[DESCRIPTION]).get("description")
    texts = of_every_fmu(PYTHONFMU, packages=PACKAGES.get(name, NO_PACKAGES))
    texts["documentation/index.html"] = _page(name, script, description)(texts)
    files["model.png"] = (ASSETS / "model.png").read_bytes()
    files.update({path: text.encode("utf-8") for path, text in texts.items()})
    seal(files)
    return write_archive(files, folder / f"{name}.fmu")


def _page(name, script, description):
    """`documents.page` with the equations as the sources have them, and the tables of all variables."""
    texts = [import_module(f"fmus.{each}").__doc__ for each in ("model_slave", script.stem, "aerodynamics")]
    shown = texts if name.endswith("Kite") else texts[:2]
    physics = "\n".join(f"<pre>{escape(text.strip())}</pre>" for text in reversed(shown))
    body = filled("example.html", name=name, version=__version__, description=escape(description), physics=physics)
    return page(name, body, table_of(name), hint="")
