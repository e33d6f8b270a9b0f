"""`tetherfmu build --diameter` and `--material`: the FMU starts with the tether that the Python API has with them."""

import pytest
from fmpy import read_model_description

from isolation import in_own_process
from running import status_of
from tetherfmu import MATERIALS, Tether, TetherDynamic, tether_of
from tetherfmu.__main__ import main
from tetherfmu.commands.build import DIAMETER, SEGMENTS
from tetherfmu.export.evidence import inputs_at
from tetherfmu.runtime.variants import DYNAMIC, EVERY_VARIANT, class_name

D = 0.006  # [m], 1.5 times the default: 2.25 times its area
SCENE = inputs_at(3.0)


@pytest.fixture(scope="module")
def fmu(tmp_path_factory):
    folder = tmp_path_factory.mktemp("diameter")
    assert main(["build", "dynamic", "--diameter", str(D), "--segments", "7", "--out", str(folder)]) == 0
    return folder / "TetherDynamic.fmu"


def test_start_values(fmu):
    """Stiffness and damping grow with the area, the density of the material stays."""
    start = {each.name: each.start for each in read_model_description(fmu).modelVariables if each.start is not None}
    default = Tether()
    assert (float(start["diameter"]), start["segments"]) == (D, "7")
    for name, factor in {"axial_stiffness": 2.25, "axial_damping": 2.25, "density": 1.0, "drag_coefficient": 1.0}.items():
        assert float(start[name]) == pytest.approx(factor * getattr(default, name), rel=1e-14)  # digits of the file


@in_own_process
def test_the_first_step_is_that_of_the_python_api(fmu):
    from runtime.host import Host

    tether = TetherDynamic(Tether(segments=7).with_diameter(D))
    tether.initialize(**SCENE)
    expected = tether.step(0.02, **SCENE)
    host = Host(fmu).start(**SCENE)
    host.step(0.02, **SCENE)
    assert host.get("kite_force") == expected.kite_force.tolist()


def test_check_passes(fmu, capsys):
    assert main(["check", str(fmu)]) == 0
    assert "evidence set: 200 steps" in capsys.readouterr().out


def starts(folder, *options):
    """Start values of an FMU that is built with options."""
    assert main(["build", "straight", "--out", str(folder), *options]) == 0
    description = read_model_description(folder / "TetherStraight.fmu")
    return {each.name: float(each.start) for each in description.modelVariables if each.type == "Real" and each.start}


@pytest.mark.parametrize("material", MATERIALS)
@pytest.mark.parametrize("diameter", [None, 0.012])
def test_material(tmp_path, material, diameter):
    found = starts(tmp_path, "--material", material, *(["--diameter", str(diameter)] if diameter else []))
    expected = tether_of(material, diameter or Tether().diameter)
    for name in ("diameter", "density", "axial_stiffness", "axial_damping", "drag_coefficient", "initial_length"):
        assert found[name] == pytest.approx(getattr(expected, name), rel=1e-14)  # digits of the file


def test_a_diameter_in_millimetres_is_named(tmp_path, capsys):
    """4 mm, typed as 4, pull with 23 MN: one line, and the FMU that was asked for."""
    assert starts(tmp_path, "--diameter", "4")["diameter"] == 4.0
    said = "TetherStraight: diameter is 4 m, more than 0.2 m; diameters are in m: 4 mm are 0.004\n"
    assert capsys.readouterr().err == said
    starts(tmp_path, "--diameter", "0.2")
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("diameter", "segments"), [(DIAMETER.minimum, SEGMENTS.maximum), (DIAMETER.maximum, SEGMENTS.minimum)]
)
def test_the_ends_of_what_is_allowed_pass_their_check(tmp_path, diameter, segments):
    """All FMUs, of the most segments the dynamic one; their evidence sets have digits enough."""
    names = EVERY_VARIANT if segments == SEGMENTS.minimum else [DYNAMIC.name]
    options = ["--diameter", str(diameter), "--segments", str(segments), "--out", str(tmp_path)]
    assert main(["build", *(class_name(each) for each in names), *options]) == 0
    built = [*map(str, tmp_path.glob("*.fmu"))]
    assert len(built) == len(names)
    assert main(["check", *built]) == 0


@pytest.mark.parametrize(
    ("options", "scales"),
    [("--set diameter=0.008", True), ("--set diameter=0.008 --set axial_stiffness=7e5 --set axial_damping=5", False)],
)
def test_a_diameter_that_scales_the_stiffness_says_so_once(tmp_path, capsys, options, scales):
    """Of two FMUs in one line, with the values that they start with."""
    assert main(["build", "straight", "catenary", "--out", str(tmp_path), *options.split()]) == 0
    said = "diameter = 0.008 m scales stiffness and damping: axial_stiffness = 2.458e+06 N and axial_damping = 1892 N.s"
    expected = [f"TetherStraight, TetherCatenary: {said}; set them to change this"] if scales else []
    assert capsys.readouterr().err.splitlines() == expected


def test_a_material_wants_the_diameter_beside_it(tmp_path, capsys):
    """With --set it would keep the stiffness of 4 mm."""
    options = ("--material", "steel", "--set", "diameter=0.008", "--out", str(tmp_path))
    assert status_of("build", "straight", *options) == 2
    assert "give the diameter with it, not with --set" in capsys.readouterr().err
