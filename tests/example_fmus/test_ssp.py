"""The systems as SSP files: valid, and the same flight in libcosim, in a container and in the example's own master.

In turbulence the wind at the points of the tether is that of the box there.
"""

import re
import subprocess
import sys
import zipfile
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from fmpy.ssp.ssd import read_ssd, read_ssv, validate_tree
from lxml import etree

from isolation import in_own_process, own_process
from runtime import clients
from runtime.host import Host
from tetherfmu.libraries.examples import example
from tetherfmu.wind import frozen_turbulence as frozen
from tetherfmu.wind import wind_boxes as boxes

ssp = example("shared.ssp")
ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
SPACES = {prefix: f"{ssp.NAMESPACE}{what}" for prefix, what in ssp.PREFIXES.items()}
STEPS = 150  # 3 s: the first turn
FOLLOWED = ("kite_position[1]", "kite_position[2]", "kite_position[3]", "kite_tension")
SHOWN = ("kite_position[1]", "kite_position[2]", "kite_position[3]", "ground_tension")  # the container shows what is linked
FIDELITIES = {"coarse": 3, "standard": 10, "fine": 30}
OF_FIDELITIES, TURBULENT = ("kite_power_system", "winch_inside"), ("turbulent_circle", "turbulent_parked_kite")
needs_ecos = pytest.mark.skipif(find_spec("ecospy") is None, reason="ecospy is for 64-bit Linux")
needs_libcosim = pytest.mark.skipif(find_spec("libcosimpy") is None, reason="libcosimpy is not installed")


@pytest.fixture(scope="session")
def ssp_folder(built_once):
    return built_once("ssp", lambda folder: ssp.write_all(folder))


@pytest.mark.parametrize("name", [*OF_FIDELITIES, "circular_flight", *TURBULENT])
def test_is_valid(ssp_folder, name):
    """By the schemas of SSP 1.0, as FMPy has them; connections join connectors that are there."""
    path = ssp_folder / f"{name}.ssp"
    system = read_ssd(str(path)).system
    connectors = {(part.name, each.name, each.kind) for part in system.elements for each in part.connectors}
    assert system.connections
    for each in system.connections:
        assert (each.startElement, each.startConnector, "output") in connectors
        assert (each.endElement, each.endConnector, "input") in connectors
    with zipfile.ZipFile(path) as archive:
        structures = [entry for entry in archive.namelist() if entry.endswith(".ssd")]
        for entry in structures:
            structure = etree.fromstring(archive.read(entry))
            validate_tree(structure, "SystemStructureDescription.xsd")
            assert structure.get("name").isidentifier()  # as OMSimulator wants it
    if name in OF_FIDELITIES:
        assert len(structures) == len(FIDELITIES)
        for fidelity, segments in FIDELITIES.items():
            assert parameters_of(path, fidelity)["segments"] == segments


@pytest.mark.parametrize("name", [*OF_FIDELITIES, "circular_flight", "turbulent_circle"])
def test_connectors_have_the_units_of_the_variables(ssp_folder, name, tmp_path):
    """And the system structure says what they are of the base units, as the FMUs do."""
    with zipfile.ZipFile(ssp_folder / f"{name}.ssp") as archive:
        root = etree.fromstring(archive.read("SystemStructure.ssd"))
        archive.extractall(tmp_path, [entry for entry in archive.namelist() if entry.endswith(".fmu")])
    known = {each.get("name"): dict(each[0].attrib) for each in root.find("ssd:Units", SPACES)}
    used = set()
    for part in root.iterfind(".//ssd:Component", SPACES):
        described = read_model_description(str(tmp_path / part.get("source")))
        of_variables = {variable.name: variable.unit for variable in described.modelVariables}
        base_units = {unit.name: unit.baseUnit for unit in described.unitDefinitions}
        for each in part.iterfind(".//ssd:Connector", SPACES):
            unit = each[0].get("unit")
            assert unit == of_variables[each.get("name")]
            used |= {unit} - {None}
            assert unit is None or all(getattr(base_units[unit], base) == int(power) for base, power in known[unit].items())
    assert used == set(known) > {"m", "N"}


def parameters_of(path, fidelity):
    """Values of a parameter set by name."""
    parameters = read_ssv(str(path), f"resources/tether_{fidelity}.ssv").parameters
    return {each.name: int(each.value) if each.type == "Integer" else float(each.value) for each in parameters}


def test_the_same_bytes_again(ssp_folder, tmp_path):
    written = ssp.write_all(tmp_path)
    assert {path.name for path in written} == {path.name for path in ssp_folder.glob("*.ssp")}
    for path in written:
        assert path.read_bytes() == (ssp_folder / path.name).read_bytes()


def by_the_example(names, start, fmus, inside=False):
    """Rows of the tether's outputs by the Jacobi master of the example; inside : whether the winch is inside the tether."""
    sys.path.append(str(EXAMPLES))
    from first_flight import circular_flight
    from power_system import kite_power_system, pumping_cycle

    circular_flight.find_fmu = pumping_cycle.find_fmu = lambda name: Path(fmus) / f"{name}.fmu"
    rows = []
    given, parts_of = kite_power_system.START, kite_power_system.FMUS
    if inside:
        given, parts_of = kite_power_system.INSIDE_START, kite_power_system.INSIDE
    with pumping_cycle.system(given | start, "jacobi", parts_of) as (parts, signals, places, _):
        for k in range(STEPS):
            pumping_cycle.jacobi(parts, signals, 0.02 * k, 0.02)
            rows.append([signals[places[name]] for name in names])
    return rows


def by_libcosim(folder, ssd, names):
    """Rows of the tether's outputs by libcosim; ssd : name of the system structure."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver

    execution = CosimExecution.from_ssp_file(str(Path(folder) / ssd), step_size=20_000_000)
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    index = execution.slave_index_from_instance_name("tether")
    references = {each.name.decode(): each.reference for each in execution.slave_variables(index)}
    rows = []
    for _ in range(STEPS):
        assert execution.step()
        rows.append(observer.last_real_values(index, [references[name] for name in names]))
    return rows


def by_ecos(path, names):
    """Rows of the tether's outputs by Ecos, in the system's own structure."""
    with clients.ecos().EcosSimulation(ssp_path=str(path), step_size=0.02) as simulation:
        assert simulation.init()
        rows = []
        for _ in range(STEPS):
            simulation.step()
            rows.append([simulation.get_real(f"tether::{name}") for name in names])
        simulation.terminate()
    return rows


def folders(path, folder):
    """Folders in this one: with an SSP file, extracted, and an empty one for FMUs."""
    extracted, fmus = folder / "extracted", folder / "fmus"
    fmus.mkdir()
    with zipfile.ZipFile(path) as archive:
        archive.extractall(extracted)
    return str(extracted), fmus


def fmus_of(fmu_folder, example_folder, folder):
    for each in (*fmu_folder.glob("*.fmu"), *example_folder.glob("*.fmu")):
        (folder / each.name).symlink_to(each)
    return str(folder)


@needs_libcosim
@pytest.mark.parametrize("fidelity", list(FIDELITIES))
def test_kite_power_system_in_libcosim(ssp_folder, fmu_folder, example_folder, tmp_path, fidelity):
    """As the Jacobi master; libcosim rounds the step to nanoseconds, and sums times: digits behind the tenth differ."""
    extracted, fmus = folders(ssp_folder / "kite_power_system.ssp", tmp_path)
    ssd = "SystemStructure.ssd" if fidelity == "standard" else f"SystemStructure_{fidelity}.ssd"
    start = parameters_of(ssp_folder / "kite_power_system.ssp", fidelity)
    fmus = fmus_of(fmu_folder, example_folder, fmus)
    ours = own_process(by_the_example, names=FOLLOWED, start=start, fmus=fmus)
    theirs = own_process(by_libcosim, folder=extracted, ssd=ssd, names=FOLLOWED)
    np.testing.assert_allclose(theirs, ours, rtol=1e-9, atol=1e-9)


@needs_ecos
def test_kite_power_system_in_ecos(ssp_folder, fmu_folder, example_folder, tmp_path):
    """As the Jacobi master; Ecos sums times."""
    path = ssp_folder / "kite_power_system.ssp"
    start, fmus = parameters_of(path, "standard"), fmus_of(fmu_folder, example_folder, tmp_path)
    ours = own_process(by_the_example, names=FOLLOWED, start=start, fmus=fmus)
    np.testing.assert_allclose(own_process(by_ecos, path=path, names=FOLLOWED), ours, rtol=1e-9, atol=1e-9)


@needs_libcosim
def test_winch_inside_in_libcosim(ssp_folder, fmu_folder, example_folder, tmp_path):
    """As the Jacobi master, with the motor in the place of the winch."""
    extracted, fmus = folders(ssp_folder / "winch_inside.ssp", tmp_path)
    names = (*FOLLOWED, "winch_speed")
    fmus = fmus_of(fmu_folder, example_folder, fmus)
    ours = own_process(by_the_example, names=names, start={}, fmus=fmus, inside=True)
    theirs = own_process(by_libcosim, folder=extracted, ssd="SystemStructure.ssd", names=names)
    np.testing.assert_allclose(theirs, ours, rtol=1e-9, atol=1e-9)


@needs_libcosim
def test_circle_in_libcosim(ssp_folder, fmu_folder, example_folder, tmp_path):
    """The forces are those of the circular flight whose example leads the kite itself."""
    extracted, fmus = folders(ssp_folder / "circular_flight.ssp", tmp_path)
    names = [f"kite_force[{i}]" for i in (1, 2, 3)]
    theirs = own_process(by_libcosim, folder=extracted, ssd="SystemStructure.ssd", names=names)
    ours = own_process(by_circular_flight, fmus=fmus_of(fmu_folder, example_folder, fmus))
    np.testing.assert_allclose(theirs, ours[1:], rtol=0.0, atol=1e-6)  # of 100 N


@needs_libcosim
def test_snippet_of_the_manual(ssp_folder, tmp_path):
    """It prints the tension to which libcosim comes step by step."""
    page = (ROOT / "docs" / "use" / "importing.md").read_text(encoding="utf-8")
    snippets = re.findall(r"^```python\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    (snippet,) = [code for code in snippets if "libcosim" in code]
    (tmp_path / "dist").symlink_to(ssp_folder, target_is_directory=True)
    done = subprocess.run([sys.executable, "-c", snippet], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    (printed,) = re.findall(r"^\[([\d.]+)\]$", done.stdout, re.MULTILINE)  # among what libcosim logs
    extracted = str(tmp_path / "circular_flight")
    steps = own_process(by_libcosim, folder=extracted, ssd="SystemStructure.ssd", names=["kite_tension"])
    assert [float(printed)] == steps[-1]


def by_circular_flight(fmus):
    sys.path.append(str(EXAMPLES))
    from first_flight.circular_flight import fly

    return fly(Path(fmus) / "TetherDynamic.fmu", wind=(8.0, 0.0, 0.0), duration=0.02 * STEPS).kite_force


@in_own_process
def test_kite_power_system_as_a_container(ssp_folder, fmu_folder, example_folder, tmp_path):
    """fmu-manipulation-toolbox makes one FMU of the SSP; it starts the kite without its first steering."""
    from fmu_manipulation_toolbox.assembly import Assembly

    (tmp_path / "fmus").mkdir()
    (tmp_path / "kite_power_system.ssp").write_bytes((ssp_folder / "kite_power_system.ssp").read_bytes())
    assembly = Assembly("kite_power_system.ssp", default_step_size=0.02, fmu_directory=tmp_path)
    assembly.make_fmu()
    names = [f"tetherdynamicfree.{name}" for name in SHOWN]
    result = simulate_fmu(
        str(tmp_path / "kite_power_system.fmu"), stop_time=0.02 * STEPS, output_interval=0.02, output=names
    )
    found = np.array([result[name] for name in names]).T[1:]
    assert len(found) == STEPS
    fmus = fmus_of(fmu_folder, example_folder, tmp_path / "fmus")
    expected = np.array(by_the_example(SHOWN, {}, fmus))
    # the steering that is missing in the first step, 0.25 for 20 ms, turns the kite by 0.3 deg: 5 cm after some seconds
    np.testing.assert_allclose(found[:, :3], expected[:, :3], rtol=0.0, atol=0.05)
    # and at first the winch turns otherwise, which accelerates the rope
    np.testing.assert_allclose(found[10:, 3], expected[10:, 3], rtol=0.02)


# --- in turbulence


STEP, LONG = 0.02, 100  # steps
every_turbulent = pytest.mark.parametrize("name", TURBULENT)


@every_turbulent
def test_connections(ssp_folder, name):
    """All points of the tether and the wind at them are connected, in both ways."""
    system = read_ssd(str(ssp_folder / f"{name}.ssp")).system
    ends = [(c.startElement, c.startConnector, c.endElement, c.endConnector) for c in system.connections]
    points = [f"[{k},{i}]" for k in range(1, 22) for i in (1, 2, 3)]
    assert {("wind", f"wind_at{each}", "tether", f"wind_at{each}") for each in points} <= set(ends)
    assert {("tether", f"shape{each}", "wind", f"shape{each}") for each in points} <= set(ends)
    assert not [each for each in ends if each[2:] == ("tether", "wind_velocity[1]")]
    winds = [each for each in ends if each[2:] == ("kite", "wind_velocity[1]")]
    assert winds == ([("wind", "kite_wind[1]", "kite", "wind_velocity[1]")] if "parked" in name else [])


def flown(path, folder, steps):
    """Fly a system in FMPy, all FMUs from the same communication point: rows of shape, wind there, tension."""
    system = read_ssd(path).system
    with zipfile.ZipFile(path) as archive:
        archive.extractall(folder)
    hosts = {part.name: Host(Path(folder) / part.source, own_folder=True) for part in system.elements}
    inputs = {}
    for each in system.connections:
        inputs.setdefault(each.endElement, []).append((each.startElement, each.startConnector, each.endConnector))

    def exchange():
        values = {}
        for taker, wanted in inputs.items():
            values[taker] = {end: hosts[giver].get(start) for giver, start, end in wanted}
        for taker, given in values.items():
            hosts[taker].set(**given)

    for host in hosts.values():
        host.enter_initialization(None)
    for _ in range(3):  # as many as there are loops
        exchange()
    for host in hosts.values():
        host.fmu.exitInitializationMode()
    rows = []
    for _ in range(steps):
        exchange()
        before = hosts["tether"].get("shape")
        for host in hosts.values():
            host.step(STEP)
        rows.append([before, hosts["wind"].get("wind_at"), hosts["tether"].get("ground_tension")])
    return rows


@every_turbulent
def test_flight(ssp_folder, tmp_path, name):
    """The wind that the tether gets next is that of the box where its points are, to what they move in a step."""
    rows = own_process(flown, path=str(ssp_folder / f"{name}.ssp"), folder=str(tmp_path), steps=LONG)
    given = example("wind.turbulence_systems")
    (tmp_path / "box.npz").write_bytes(given.box())
    field = frozen.FrozenTurbulence(frozen.MeanWind(8.0, 0.0, 10.0, 0.14), boxes.open_box(tmp_path / "box.npz"))
    tension = np.array([row[2] for row in rows])
    assert np.all(np.isfinite(tension))
    assert tension.min() > 100.0  # taut: neither fell down
    for k in (LONG // 2, LONG - 1):
        expected = field.at(STEP * (k + 1), np.reshape(rows[k][0], (-1, 3)))
        found = np.reshape(rows[k][1], (-1, 3))
        # 25 m/s carry a point 0.5 m in a step, on a grid of 10 m on which the wind changes by some m/s
        np.testing.assert_allclose(found, expected, atol=0.4)
        assert found[:, 0].std() > 0.5
