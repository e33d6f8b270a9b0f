"""The page on ropes: its example runs, and its table follows from the sources that it names."""

import re
from math import pi

import pytest

from manual import page, shown
from running import run_code
from tetherfmu import MATERIALS, Tether

PAGE = page("use/your_rope")
TABLE = PAGE.partition("## Ropes and wires")[2]
ROWS = [re.split(r" *\| *", row) for row in re.findall(r"^\| (.+) \|$", TABLE, re.MULTILINE)[1:]]


def test_the_example_prints_what_stands_below_it():
    code, printed = shown(PAGE)
    assert run_code(code).stdout == printed


@pytest.mark.parametrize("name", MATERIALS)
def test_materials_are_those_of_the_package(name):
    ((_, density, modulus, _),) = (row for row in ROWS if f"`{name}`" in row[0])
    assert float(density) == pytest.approx(MATERIALS[name].density, abs=0.5)
    assert float(modulus) == pytest.approx(MATERIALS[name].modulus / 1e9, rel=2e-3)


def test_the_default_is_the_tether_of_the_package():
    ((_, density, modulus, _),) = (row for row in ROWS if "(default)" in row[0])
    default = Tether()
    assert float(density) == default.density
    assert float(modulus) == pytest.approx(default.axial_stiffness / (pi / 4.0 * default.diameter**2) / 1e9, abs=0.5)


@pytest.mark.parametrize("row", [row for row in ROWS if "mass" in row[3]], ids=lambda row: row[0])
def test_mass_per_square_of_the_diameter(row):
    """kg/m per m2 of d2, over pi/4; the stiffness likewise."""
    mass = float(re.search(r"mass ([\d.]+) \$d\^2\$", row[3])[1])
    assert float(row[1]) == pytest.approx(4.0 / pi * mass, abs=0.5)
    if stiffness := re.search(r"\$EA\$ ([\d.e]+) \$d\^2\$", row[3]):
        assert float(row[2]) == pytest.approx(4.0 / pi * float(stiffness[1]) / 1e9, rel=3e-3)
