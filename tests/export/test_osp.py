"""libcosim connects an end of the tether as one group: position and velocity in, force out."""

import zipfile
from importlib.util import find_spec
from pathlib import Path
from xml.etree import ElementTree

import pytest
from fmpy import read_model_description
from pythonfmu.builder import FmuBuilder

from export.kite_on_rails import RISE
from isolation import in_own_process
from tetherfmu.export import osp
from tetherfmu.export.archive import SLAVES

KITE = f"""<?xml version="1.0" encoding="UTF-8"?>
<OspModelDescription xmlns="{osp.NAMESPACE}" version="1.0">
  <VariableGroups>
    <Generic name="tether">
      <Force name="force"><Variable ref="fx"/><Variable ref="fy"/><Variable ref="fz"/></Force>
      <LinearVelocity name="velocity"><Variable ref="vx"/><Variable ref="vy"/><Variable ref="vz"/></LinearVelocity>
      <LinearDisplacement name="position"><Variable ref="px"/><Variable ref="py"/><Variable ref="pz"/></LinearDisplacement>
    </Generic>
  </VariableGroups>
</OspModelDescription>
"""
SYSTEM = """<?xml version="1.0" encoding="UTF-8"?>
<OspSystemStructure xmlns="http://opensimulationplatform.com/MSMI/OSPSystemStructure" version="0.1">
  <BaseStepSize>0.05</BaseStepSize>
  <Algorithm>fixedStep</Algorithm>
  <Simulators>
    <Simulator name="tether" source="{tether}" stepSize="0.05"/>
    <Simulator name="kite" source="KiteOnRails.fmu" stepSize="0.05"/>
  </Simulators>
  <Connections>
    <VariableGroupConnection>
      <VariableGroup simulator="tether" name="kite"/>
      <VariableGroup simulator="kite" name="tether"/>
    </VariableGroupConnection>
  </Connections>
</OspSystemStructure>
"""
ECCO = {
    "step_size": 0.01,
    "min_step_size": 0.001,
    "max_step_size": 0.05,
    "safety_factor": 0.99,
    "min_change_rate": 0.2,
    "max_change_rate": 1.5,
    "abs_tolerance": 0.1,
    "rel_tolerance": 1e-3,
    "p_gain": 0.2,
    "i_gain": 0.15,
}
OF_A_WINCH = ["LinearVelocity", "Force", "LinearDisplacement", "LinearVelocity", "LinearDisplacement"]
# what the schema of OSP-IS 1.0.1 says of the elements that are used here: children in this order
CHILDREN = {
    "OspModelDescription": ["VariableGroups"],
    "VariableGroups": ["Generic", "Generic", "LinearVelocity", *OF_A_WINCH],
    "Generic": ["Force", "LinearVelocity", "LinearDisplacement"],
}


def gives_motion(group, name):
    """Whether force goes into a group and motion comes out: that of a free end, force of the winch, and what it does."""
    of_winch = group.get("name") in ("winch_pull", "winch_speed", "tether_length")
    return of_winch or (name == "TetherDynamicFree" and group.get("name").startswith("kite"))


@pytest.mark.parametrize("name", list(SLAVES))
def test_groups_obey_the_schema_and_name_variables_of_the_fmu(fmu_folder, name):
    root = ElementTree.parse(fmu_folder / osp.file_name(name)).getroot()
    variables = {each.name: each for each in read_model_description(str(fmu_folder / f"{name}.fmu")).modelVariables}
    groups, tags = [], set()
    for element in root.iter():
        tag = element.tag.removeprefix(f"{{{osp.NAMESPACE}}}")
        tags.add(tag)
        children = [child.tag.removeprefix(f"{{{osp.NAMESPACE}}}") for child in element]
        if tag == "Variable":
            assert variables[element.get("ref")].unit == element.get("unit")
            assert element.get("axis") in (
                None,
                "xyz"[int(element.get("ref")[-2]) - 1] if "[" in element.get("ref") else None,
            )
        elif tag in CHILDREN:
            assert children == CHILDREN[tag]
        else:
            assert set(children) == {"Variable"}
            assert len(children) in (1, 3)
            causality = {variables[child.get("ref")].causality for child in element}
            motion, force = ({"output"}, {"input"}) if gives_motion(element, name) else ({"input"}, {"output"})
            assert causality == (force if tag == "Force" else motion)
        groups += [element.get("name")] if "name" in element.attrib else []
    assert tags >= {*CHILDREN, "Force", "LinearVelocity", "LinearDisplacement", "Variable"}
    assert len(set(groups)) == len(groups), "names of groups are unique in a file"
    inputs = {each for each, variable in variables.items() if variable.causality == "input" and variable.type == "Real"}
    assert inputs <= {element.get("ref") for element in root.iter()}, "every input is in a group"


def test_the_same_groups_are_in_the_fmu(fmu_folder):
    with zipfile.ZipFile(fmu_folder / "TetherDynamic.fmu") as archive:
        inside = archive.read(f"extra/com.open-simulation-platform/{osp.file_name('TetherDynamic')}")
    assert inside == (fmu_folder / osp.file_name("TetherDynamic")).read_bytes()


@pytest.mark.skipif(find_spec("libcosimpy") is None, reason="libcosimpy is not installed")
@in_own_process
def test_libcosim_connects_the_kite_end_at_once(fmu_folder, tmp_path):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver

    FmuBuilder.build_FMU(Path(__file__).with_name("kite_on_rails.py"), dest=tmp_path)
    (tmp_path / osp.file_name("KiteOnRails")).write_text(KITE)
    tether = (fmu_folder / "TetherDynamic.fmu").as_uri()
    (tmp_path / "OspSystemStructure.xml").write_text(SYSTEM.format(tether=tether))
    execution = CosimExecution.from_osp_config_file(osp_path=str(tmp_path))
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    assert execution.step(41)

    def last(simulator, *names):
        index = execution.slave_index_from_instance_name(simulator)
        references = {each.name.decode(): each.reference for each in execution.slave_variables(index)}
        return observer.last_real_values(index, [references[name] for name in names])

    height, speed, force = last("tether", "kite_position[3]", "kite_velocity[3]", "kite_force[3]")
    assert speed == RISE
    assert height == pytest.approx(400.0 + RISE * 2.0, abs=2.0 * RISE * 0.05)
    given = last("kite", "fz")[0]
    assert force < -50.0
    assert given == pytest.approx(force, rel=0.2)


@pytest.mark.skipif(find_spec("libcosimpy") is None, reason="libcosimpy is not installed")
@in_own_process
def test_libcosim_takes_the_kite_end_as_power_bonds(fmu_folder, tmp_path):
    """Its algorithm ECCO chooses the steps by the power force times velocity of both sides, of each component."""
    from libcosimpy.CosimAlgorithm import CosimAlgorithm, EccoParams
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    FmuBuilder.build_FMU(Path(__file__).with_name("kite_on_rails.py"), dest=tmp_path)
    algorithm = CosimAlgorithm.create_ecco_algorithm(EccoParams(**ECCO))
    execution = CosimExecution.from_algorithm(algorithm)
    files = {"tether": fmu_folder / "TetherDynamic.fmu", "kite": tmp_path / "KiteOnRails.fmu"}
    tether, kite = (execution.add_local_slave(CosimLocalSlave(str(path), name)) for name, path in files.items())
    given, taken = (
        {each.name.decode(): each.reference for each in execution.slave_variables(index)} for index in (tether, kite)
    )
    for number, axis in enumerate("xyz", start=1):
        force, velocity = given[f"kite_force[{number}]"], given[f"kite_velocity[{number}]"]
        assert algorithm.add_power_bond(tether, force, velocity, kite, taken[f"v{axis}"], taken[f"f{axis}"]) == 0
        assert execution.connect_real_variables(tether, force, kite, taken[f"f{axis}"]) == 0
        assert execution.connect_real_variables(kite, taken[f"v{axis}"], tether, velocity) == 0
        assert execution.connect_real_variables(kite, taken[f"p{axis}"], tether, given[f"kite_position[{number}]"]) == 0
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    assert execution.step(41)
    height, force = observer.last_real_values(tether, [given["kite_position[3]"], given["kite_force[3]"]])
    time = 1e-9 * execution.status().current_time
    assert height == pytest.approx(400.0 + RISE * time, abs=2.0 * RISE * ECCO["max_step_size"])
    assert abs(time - 41 * ECCO["step_size"]) > ECCO["step_size"]  # the steps have changed
    assert force < -50.0
    assert observer.last_real_values(kite, [taken["fz"]])[0] == pytest.approx(force, rel=0.2)
