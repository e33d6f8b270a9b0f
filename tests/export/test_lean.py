"""Lean FMUs: with what was chosen and no more, and with the numbers of the full FMU to the bit."""

import math
import zipfile

import pytest
from fmpy import read_model_description

from isolation import in_shared_process
from runtime.host import Host, blob_of, restore
from tetherfmu.check.__main__ import main as check
from tetherfmu.commands import build as command
from tetherfmu.export import archive, system_fmus
from tetherfmu.export.build_options import BuildOptions
from tetherfmu.export.native import native_fmus as native
from tetherfmu.export.native.host_header import PREFIX
from tetherfmu.files import lean
from tetherfmu.files.lean import PRESETS, Lean
from tetherfmu.wiring.system_variables import table_of
from tetherfmu.wiring.variables import variables

FLAVOURS = {"pythonfmu": archive.build, "native": native.build, "fmi3": lambda *given: native.build(*given, fmi=3)}
WINDY = Lean(("motion", "reel_out_speed"), ("forces",), (), (("wind_velocity", (8.0, 1.0, 0.0)), ("diameter", "5 mm")))
SYSTEM = """
build = {outputs = ["tension_from", "*.force"], parameters = ["gravity"], set = {"rope.diameter" = "6 mm", gravity = 3.7}}
[points]
mast = {position = [0, 0, 20]}
load = {mass = "50 kg"}
[lines]
rope = {from = "mast", to = "load", initial_length = "10 m", segments = 4}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory, fmu_folder, native_folder, fmi3_folder):
    """TetherDynamic with the choice `WINDY`, and the full one, in all flavours."""
    folder = tmp_path_factory.mktemp("lean")
    for (flavour, build), full in zip(FLAVOURS.items(), (fmu_folder, native_folder, fmi3_folder), strict=True):
        build("TetherDynamic", folder / flavour, BuildOptions(lean=WINDY))
        (folder / f"full_{flavour}").symlink_to(full, target_is_directory=True)
    return folder


def names_of(path):
    """Names of the vectors and scalars of an FMU by causality."""
    found = {}
    for each in read_model_description(str(path)).modelVariables:
        found.setdefault(each.causality, {})[each.name.partition("[")[0]] = each.valueReference
    return found


def flown(host):
    """Forces after each step of a flight outwards that winds in."""
    rows = []
    for k in range(20):
        angle = 0.02 * k
        kite = 300.0 * math.cos(angle), 300.0 * math.sin(angle), 402.0
        host.step(0.02, kite_position=kite, kite_velocity=(0.0, 300.0, 0.0), reel_out_speed=0.1 * k)
        rows.append([host.get(name) for name in ("kite_force", "ground_force", "peak_tension")])
    return rows


@pytest.mark.parametrize("flavour", FLAVOURS)
@in_shared_process
def test_numbers_and_references_are_those_of_the_full_fmu(folder, flavour):
    hosts = [Host(folder / name / "TetherDynamic.fmu") for name in (flavour, f"full_{flavour}")]
    small, full = hosts
    assert set(small.reference.items()) < set(full.reference.items())
    small.start()
    share = (0.005 / 0.004) ** 2
    full.start(wind_velocity=(8.0, 1.0, 0.0), diameter=0.005, axial_stiffness=share * 614600.0, axial_damping=share * 473.0)
    assert flown(small) == flown(full)
    for host in hosts:
        host.close()


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_it_has_what_was_chosen(folder, flavour):
    found = names_of(folder / flavour / "TetherDynamic.fmu")
    found.pop("independent", None)
    motion = {"kite_position", "kite_velocity", "ground_position", "ground_velocity"}
    forces = {"ground_force", "kite_force", "ground_tension", "kite_tension", "max_tension", "peak_tension"}
    assert {key: set(value) for key, value in found.items()} == {"input": {*motion, "reel_out_speed"}, "output": forces}


@pytest.mark.parametrize("flavour", FLAVOURS)
def test_it_passes_its_check(folder, flavour, capsys):
    """With the evidence set of what it has, and a page that lists the constants."""
    path = folder / flavour / "TetherDynamic.fmu"
    assert check([str(path)]) == 0, capsys.readouterr().out
    with zipfile.ZipFile(path) as opened:
        page = opened.read("documentation/index.html").decode("utf-8")
        assert "documentation/evidence/TetherDynamic_ref.csv" in opened.namelist()
        description = opened.read("modelDescription.xml").decode("utf-8")
    assert '<Constant name="wind_velocity[1]" value="8"' in description  # for whoever flies it
    assert "<h2>Constants</h2>" in page
    assert "<td><code>wind_velocity[1..3]</code></td><td>m/s</td><td>8, 1, 0</td>" in page


@pytest.mark.parametrize("flavour", ["pythonfmu", "native"])
@in_shared_process
def test_a_state_with_another_constant_is_refused(folder, flavour):
    small, full = (Host(folder / name / "TetherDynamic.fmu") for name in (flavour, f"full_{flavour}"))
    small.start()
    full.start(wind_velocity=(8.0, 1.0, 0.0))
    words = "has 0.004 for diameter, which is 0.005 in this FMU and cannot be set"
    small.refuses(lambda: restore(small, blob_of(full)), words)
    other = Host(folder / flavour / "TetherDynamic.fmu").start()
    small.step(0.02)
    restore(other, blob_of(small))
    assert other.get("kite_force") == small.get("kite_force")
    for host in (small, full, other):
        host.close()


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("variant", ["dynamic", "dynamic_free"])
def test_presets_name_what_there_is(preset, variant):
    table = variables(variant, 3)
    missing = Lean(preset=preset).left_out(table)
    kept = {each.name.partition("[")[0] for each in table} - {name.partition("[")[0] for name in missing}
    assert 12 < len(kept) < 35
    named = {name for each in PRESETS.values() for names in each.values() for name in names}
    of_systems = {"position", "velocity", "load", "force", "tension_from", "tension_to", "mass", "initial_position"}
    of_systems |= {"payout", "start"}
    assert named - of_systems <= {each.name.partition("[")[0] for each in (*variables("dynamic_free", 3), *table)} | {
        "kite_load"
    }


@in_shared_process
def test_a_system_and_its_file(tmp_path):
    (tmp_path / "Hoist.toml").write_text(SYSTEM)
    for flavour in (None, 2, 3):
        path = system_fmus.build(tmp_path / "Hoist.toml", tmp_path / str(flavour), native=flavour)
        found = names_of(path)
        assert set(found["output"]) == {"rope.tension_from", "mast.force"}
        assert set(found["parameter"]) == {"gravity"}
        assert "local" not in found
        host = Host(path).start()
        rope = 0.25 * math.pi * 0.006**2 * 724.0 * 10.0
        assert host.get("mast.force[3]") == pytest.approx(-3.7 * (50.0 + rope), rel=1e-9)
        assert host.get("rope.tension_from") == pytest.approx(3.7 * (50.0 + 7.0 / 8.0 * rope), rel=1e-9)
        host.close()


def test_c_sources_and_header(tmp_path):
    """A constant is one in the C sources; header and tables do not name it."""
    options = BuildOptions(shape_points=0, lean=Lean(parameters=("initial_length",), starts=(("gravity", 1.5),)))
    path = native.build("TetherStraight", tmp_path, options, with_header=PREFIX, with_sources=True)
    header = path.with_suffix(".h").read_text()
    assert "TETHER_INITIAL_LENGTH =" in header
    assert "GRAVITY" not in header
    with zipfile.ZipFile(path) as opened:
        tables = opened.read("sources/tables.h").decode()
    constants = tables[tables.index("CONSTANT[]") :]
    assert '"gravity"}' in constants[: constants.index("};")]
    assert '"initial_length"}' not in constants[: constants.index("};")]


@pytest.mark.parametrize("inputs", ["winch_force", "*"])
def test_a_first_step_that_waits_for_an_input_is_a_doubt(inputs, tmp_path, capsys):
    """The catenary finds no length for a pull of 0 N; with the input that says how much the winch pulls it is built."""
    options = ["--set", "winch_control=force", "--inputs", inputs, "--out", str(tmp_path)]
    assert command.main(["catenary", *options]) == 0
    assert "would refuse the first step of 0.02 s with its start values: no unstretched length" in capsys.readouterr().err


@pytest.mark.parametrize("flavour", ["native", "fmi3"])  # PythonFMU's FMUs have the same description as these
@pytest.mark.parametrize("key", ["inputs", "outputs", "parameters"])
def test_an_fmu_without_one_kind_is_valid(flavour, key, tmp_path):
    path = FLAVOURS[flavour]("TetherStraight", tmp_path, BuildOptions(lean=Lean(**{key: ()})))
    kind = {"outputs": ("output", "local")}.get(key, (key.removesuffix("s"),))
    assert not any(each.causality in kind for each in read_model_description(str(path)).modelVariables)


def test_wrong_tables_of_files():
    for table, words in (
        ({"input": []}, "unknown key build.input; did you mean inputs?"),
        ({"outputs": "kite_force"}, "build.outputs is 'kite_force'; it must be a list of names"),
        ({"preset": "kit"}, "build.preset is 'kit'; did you mean kite?"),
        ({"set": 3}, r"build.set is 3; it must be a table \[build.set\] of start values"),
    ):
        with pytest.raises(ValueError, match=words.replace("?", r"\?")):
            lean.read(table)
    both = Lean(inputs=("motion",), starts=(("gravity", 1.0),)).over(Lean(outputs=("forces",), starts=(("density", 970.0),)))
    assert both == Lean(("motion",), ("forces",), None, (("density", 970.0), ("gravity", 1.0)))


def test_parameters_come_in_groups(folder):
    """Those that are set first are first, all others by their groups, in the description as on the page."""
    description = read_model_description(str(folder / "full_native" / "TetherDynamic.fmu"))
    listed = [each.name for each in description.modelVariables if each.causality == "parameter"]
    assert listed[:4] == ["initial_length", "diameter", "density", "axial_stiffness"]
    group = {each.name: each.group for each in variables("dynamic", 3)}
    rest = [group[name] for name in listed[12:]]
    assert [each for k, each in enumerate(rest) if k == 0 or rest[k - 1] != each] == [
        "tether",
        "winch",
        "wind",
        "ground",
        "solver",
    ]
    with zipfile.ZipFile(folder / "full_native" / "TetherDynamic.fmu") as opened:
        page = opened.read("documentation/index.html").decode("utf-8")
    assert page.index("what is set first") < page.index("<code>initial_length</code>") < page.index("material and segments")


@pytest.mark.parametrize("preset", PRESETS)
def test_presets_have_a_winch_and_where_a_free_end_starts(preset, tmp_path):
    """Of a free kite end, and of the free points and the lines of a system."""
    file = tmp_path / "hanging.toml"
    file.write_text('name = "Hanging"\n' + SYSTEM.partition("\n")[2].partition("\n")[2])
    tables = variables("dynamic_free", 0), table_of(system_fmus.read(file))
    winch = {"reel_out_speed", "winch_force", "winch_length", "winch_control", "winch_speed"}
    wanted = (
        winch | {"initial_kite_position", "kite_start"},
        {f"rope.{name}" for name in winch} | {"load.initial_position", "load.start"},
    )
    for table, names in zip(tables, wanted, strict=True):
        left_out = Lean(preset=preset).left_out(table)
        assert names <= {each.name.partition("[")[0] for each in table if each.name not in left_out}
