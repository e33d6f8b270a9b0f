"""What an FMU carries for people: a page whose links lead somewhere, its pictures, licences and what the host must have."""

import struct
import zipfile
from email.message import Message
from html.parser import HTMLParser
from importlib.metadata import distribution
from pathlib import PurePosixPath

import pytest
from fmpy import read_model_description

from runtime.host import of_every_flavour
from tetherfmu.export import documents
from tetherfmu.export.archive import SLAVES, build
from tetherfmu.export.build_options import BuildOptions
from tetherfmu.export.documents import folded
from tetherfmu.runtime.kernel_library import this_platform
from tetherfmu.wiring.variables import variables

every_fmu = pytest.mark.parametrize("name", list(SLAVES))


def test_each_variant_has_a_page_of_its_physics():
    assert all(documents.physics_of(variant) for variant in SLAVES.values())
    with pytest.raises(ValueError, match=r"spring has no page .*: write tetherfmu/export/assets/physics/spring.html"):
        documents.physics_of("spring")


class Page(HTMLParser):
    """Links, pictures, texts of the cells, and whether every element that opens is closed."""

    EMPTY = ("meta", "img")

    def __init__(self, text):
        super().__init__()
        self.links, self.cells, self.text, self._open = [], [], "", []
        self.feed(text)
        self.close()
        assert self._open == []

    def handle_starttag(self, tag, attributes):
        if tag not in self.EMPTY:
            self._open.append(tag)
        self.links += [value for name, value in attributes if name in ("href", "src")]

    def handle_endtag(self, tag):
        assert self._open.pop() == tag

    def handle_data(self, data):
        self.text += data
        if "td" in self._open:
            self.cells.append(data)


def content(path):
    """Files of an FMU: dict of path to bytes."""
    with zipfile.ZipFile(path) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


@of_every_flavour("name")
def test_page_tells_the_interface_and_its_links_lead_somewhere(fmu_folder, name):
    files = content(fmu_folder / f"{name}.fmu")
    page = Page(files["documentation/index.html"].decode("utf-8"))
    for link in page.links:
        assert link.startswith("https://") or str(PurePosixPath("documentation") / link) in files
    table = variables(SLAVES[name], 21)
    for listed, each in folded(table):
        assert listed in page.cells
        assert each[0].quantity.meaning.removesuffix(", x").replace("point 1 of 21", "points") in page.cells
    assert name in page.text
    assert read_model_description(str(fmu_folder / f"{name}.fmu")).description in page.text
    assert "$" not in page.text


@of_every_flavour("name")
def test_every_variant_tells_its_own_physics(fmu_folder, name):
    symbol = {
        "TetherStraight": "mean of xi f",
        "TetherCatenary": "asinh(V2/H)",
        "TetherQuasiSteady": "omega x (omega x r_i)",
        "TetherDynamic": "m_i dv_i/dt",
        "TetherDynamicFree": "(kite_mass + m_n) dv_n/dt",
    }
    text = content(fmu_folder / f"{name}.fmu")["documentation/index.html"].decode("utf-8")
    assert [each for each in SLAVES if symbol[each] in text] == [name]
    assert ("<code>kite_load</code> is the force" in text) == (name == "TetherDynamicFree")


@pytest.mark.parametrize(
    ("address", "link"), [("https://a.invalid", ""), ("https://b.org", '<a href="https://b.org">project</a>')]
)
def test_page_links_to_the_project_once_it_has_an_address(monkeypatch, address, link):
    found = Message()
    found["Project-URL"] = f"Repository, {address}"
    monkeypatch.setattr(documents, "metadata", lambda package: found)
    assert link in documents.about("")["manual"]
    assert bool(link) == bool(documents.about("")["manual"])


@of_every_flavour("name")
def test_pictures(fmu_folder, name):
    files = content(fmu_folder / f"{name}.fmu")
    for path, size in (("model.png", (200, 200)), ("documentation/figure.png", (720, 450))):
        assert files[path].startswith(b"\x89PNG\r\n\x1a\n")
        assert struct.unpack(">II", files[path][16:24]) == size


@every_fmu
def test_licences_and_dependencies(fmu_folder, name):
    files = content(fmu_folder / f"{name}.fmu")
    assert b"TetherFMU developers" in files["documentation/licenses/license.txt"]
    assert files["documentation/licenses/PythonFMU.txt"].decode() == distribution("pythonfmu").read_text("licenses/LICENSE")
    assert b"Mozilla Public License" in files["documentation/licenses/CPPFMU.txt"]
    needed = files["documentation/externalDependencies.txt"].decode()
    assert "Python 3.11 or newer" in needed
    assert "LD_PRELOAD" in needed
    assert f"Platform: {this_platform()}, as far as" in needed


def test_licences_and_dependencies_of_native_fmus(native_folder, fmi3_folder):
    for folder in (native_folder, fmi3_folder):
        files = content(folder / "TetherDynamic.fmu")
        assert b"TetherFMU developers" in files["documentation/licenses/license.txt"]
        assert b"2-Clause BSD License" in files["documentation/licenses/FMI.txt"]
        needed = files["documentation/externalDependencies.txt"].decode()
        assert f"Platform: {this_platform()}.\n" in needed
        assert "No Python" in needed
        page = Page(files["documentation/index.html"].decode("utf-8"))
        assert "licenses/license.txt" in page.links
        own = [link for link in page.links if not link.startswith("https://")]
        assert all(str(PurePosixPath("documentation") / link) in files for link in own)


def test_page_follows_the_build_options(tmp_path):
    path = build("TetherStraight", tmp_path, BuildOptions(segments=9, shape_points=0))
    page = Page(content(path)["documentation/index.html"].decode())
    assert "shape[1..K,1..3]" not in page.cells
    assert page.cells[page.cells.index("segments") + 2] == "9"
