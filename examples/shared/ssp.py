"""Systems of FMUs as SSP 1.0 files: the system structure, parameter sets, and FMUs that are built with their start values.
The same system for the Open Simulation Platform, with which libcosim lets FMUs take different steps, is an extra file.

The FMUs carry all start values themselves, because not every importer sets enumerations, or reads parameter sets. A
parameter set holds what a fidelity changes. Each fidelity has a system structure of its own in the file, as SSP allows; the
one that is called SystemStructure.ssd is what importers open.
"""

import tempfile
import warnings
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement

from fmpy import read_model_description

from power_system import kite_power_system as power
from shared import example_fmus
from tetherfmu import PlausibilityWarning
from tetherfmu.export import archive
from tetherfmu.export.build_options import BuildOptions, Purpose
from tetherfmu.export.documents import OSP_FOLDER
from tetherfmu.export.texts import xml_text
from tetherfmu.files.lean import Lean
from tetherfmu.fmi.model_description import base_units, number_text
from tetherfmu.runtime import __version__
from tetherfmu.wiring.variables import variables
from wind import turbulence_systems as turbulent

NAMESPACE = "http://ssp-standard.org/SSP1/SystemStructure"
PREFIXES = {"ssd": "Description", "ssc": "Common", "ssv": "ParameterValues"}
TOOL = f"TetherFMU {__version__}"
FMU = "application/x-fmu-sharedlibrary"
STEP, STOP = 0.02, 200.0  # of the default experiment [s]
OMS_NAMESPACE = "https://raw.githubusercontent.com/OpenModelica/OMSimulator/master/schema/oms.xsd"
OSP_NAMESPACE = "http://opensimulationplatform.com/MSMI/OSPSystemStructure"
OSP_STRUCTURE = f"{OSP_FOLDER}/OspSystemStructure.xml"  # as libcosim looks for it
PAGE = "<h1>{name}</h1>\n<p>{name} of TetherFMU {version}. {about}</p>"


@dataclass(frozen=True)
class Wiring:
    """What a system has beside connections of equal names.

    renamed : dict of an input, "instance.name", to the name of the output that it gets, "" for none.  files : dict of FMUs
    to pairs (file name, bytes) in their resources.  steps : dict of the instances that may take longer steps than the
    others, where the importer lets them, to theirs [s].
    """

    renamed: dict = field(default_factory=dict)
    files: dict = field(default_factory=dict)
    steps: dict = field(default_factory=dict)


def write_all(folder, options=None):
    """Write the systems of the examples to a folder; returns their paths.

    options : `BuildOptions` of their tethers, of which the purpose and the start values are replaced.
    """
    options = options or BuildOptions()
    fidelities = {name: {"tether": values} for name, values in power.FIDELITIES.items()}
    folder = Path(folder)
    return [
        write("kite_power_system", power.FMUS, power.START, fidelities, folder, options),
        write("winch_inside", power.INSIDE, power.INSIDE_START, fidelities, folder, options, Wiring(steps=power.OWN_STEPS)),
        write("circular_flight", power.CIRCLE, power.CIRCLE_START, {"standard": {}}, folder, options),
        *in_turbulence(folder, options),
    ]


def in_turbulence(folder, options):
    """Write the systems with turbulent wind to a folder; gives their paths. options : as in `write_all`."""
    options = replace(options, wind_points=turbulent.POINTS, shape_points=turbulent.POINTS)
    wiring = Wiring(turbulent.RENAMED, files={"TurbulentWind": [(Path(turbulent.BOX).name, turbulent.box())]})
    for name, fmus, start in (
        ("turbulent_circle", turbulent.CIRCLE, turbulent.CIRCLE_START),
        ("turbulent_parked_kite", turbulent.PARKED, turbulent.PARKED_START),
    ):
        yield write(name, fmus, start, {"standard": {}}, Path(folder), options, wiring)


def write(name, fmus, start, fidelities, folder, options, wiring=Wiring()):
    """Write NAME.ssp; returns its path.

    fmus : dict of instances to names of FMUs.  start : start values, of every FMU that has the name.  fidelities : dict of
    names to dicts of instances to values of parameters; "standard" is the one that importers open.  options : as in
    `write_all`.  wiring : `Wiring`.
    """
    with tempfile.TemporaryDirectory() as temporary:
        built = partial(_built, start=start, system=name, options=options, files=wiring.files)
        paths = {each: built(fmu, folder=Path(temporary) / each) for each, fmu in fmus.items()}
        variables = {instance: read_model_description(str(path)).modelVariables for instance, path in paths.items()}
        files = {_source(fmus[each]): path.read_bytes() for each, path in paths.items()}
    sources = {instance: f"../../{_source(fmu)}" for instance, fmu in fmus.items()}
    structure = osp_structure(sources, _connections(variables, wiring), STEP, wiring.steps)
    files[OSP_STRUCTURE] = structure.encode("utf-8")
    for fidelity, values in fidelities.items():
        ending = "" if fidelity == "standard" else f"_{fidelity}"
        texts = {f"SystemStructure{ending}.ssd": _structure(name, fidelity, fmus, variables, values, wiring)}
        texts |= {_set(each, fidelity): _parameters(fidelity, given) for each, given in values.items()}
        files |= {path: xml_text(root).encode("utf-8") for path, root in texts.items()}
    return archive.write_archive(files, folder / f"{name}.ssp")


def _connections(variables, wiring):
    """Dict of instances to dicts of their inputs to pairs (instance, output)."""
    givers = {output: instance for instance, known in variables.items() for output in power.given_by(known)}
    found = {}
    for instance, known in variables.items():
        wanted = {v.name: _output_for(f"{instance}.{v.name}", wiring) for v in known if v.causality == "input"}
        found[instance] = {name: (givers[output], output) for name, output in wanted.items() if output in givers}
    return found


def _output_for(place, wiring):
    """Name of the output that an input, "instance.name", gets."""
    vector, bracket, index = place.partition("[")
    renamed = wiring.renamed.get(vector)
    return place.partition(".")[2] if renamed is None else f"{renamed}{bracket}{index}"


def _structure(name, fidelity, fmus, variables, values, wiring):
    """Element of a system structure; variables : by instance.  values : of the fidelity, as in `write`."""
    spaces = {f"xmlns:{prefix}": f"{NAMESPACE}{what}" for prefix, what in PREFIXES.items()}
    spaces["xmlns:oms"] = OMS_NAMESPACE
    root = Element("ssd:SystemStructureDescription", spaces, name=f"{name}_{fidelity}", version="1.0", generationTool=TOOL)
    system = SubElement(root, "ssd:System", name=name)
    elements, connections = SubElement(system, "ssd:Elements"), SubElement(system, "ssd:Connections")
    inputs_of = _connections(variables, wiring)
    for instance, known in variables.items():
        inputs = inputs_of[instance]
        component = SubElement(elements, "ssd:Component", name=instance, type=FMU, source=_source(fmus[instance]))
        units = {variable.name: variable.unit for variable in known}
        _connectors(component, inputs, power.given_by(known), units)
        if instance in values:
            bindings = SubElement(component, "ssd:ParameterBindings")
            SubElement(bindings, "ssd:ParameterBinding", source=_set(instance, fidelity))
        for each, (giver, output) in inputs.items():
            ends = {"startElement": giver, "endElement": instance}
            SubElement(connections, "ssd:Connection", ends, startConnector=output, endConnector=each)
    _for_omsimulator(system)
    _units(root)
    SubElement(root, "ssd:DefaultExperiment", startTime="0", stopTime=number_text(STOP))
    return root


def _for_omsimulator(system):
    """Add to an element of a system what OMSimulator imports no system without: the method, and its step."""
    own = SubElement(SubElement(system, "ssd:Annotations"), "ssc:Annotation", type="org.openmodelica")
    method = SubElement(SubElement(own, "oms:Annotations"), "oms:SimulationInformation")
    SubElement(method, "oms:FixedStepMaster", description="oms-ma", stepSize=number_text(STEP))


def osp_structure(sources, connections, step, steps):
    """Text of a system structure for libcosim: FMUs that exchange their variables after each step, all from the same time.

    sources : dict of simulators to the places of their FMUs, as seen from the file.  connections : dict of simulators to
    dicts of their inputs to pairs (simulator, output).  step : shortest communication step [s].  steps : dict of the
    simulators that have another one, a multiple of it [s].
    """
    root = Element("OspSystemStructure", xmlns=OSP_NAMESPACE, version="0.1")
    for name, text in (("StartTime", "0"), ("BaseStepSize", number_text(step)), ("Algorithm", "fixedStep")):
        SubElement(root, name).text = text
    simulators, joined = SubElement(root, "Simulators"), SubElement(root, "Connections")
    for name, source in sources.items():
        SubElement(simulators, "Simulator", name=name, source=source, stepSize=number_text(steps.get(name, step)))
    for taker, inputs in connections.items():
        for wanted, (giver, output) in inputs.items():
            pair = SubElement(joined, "VariableConnection")
            for simulator, name in ((giver, output), (taker, wanted)):
                SubElement(pair, "Variable", simulator=simulator, name=name)
    return xml_text(root)


def _source(fmu):
    """Place of an FMU in the archive."""
    return f"resources/{fmu}.fmu"


def _set(instance, fidelity):
    """Place of a parameter set in the archive."""
    return f"resources/{instance}_{fidelity}.ssv"


def _built(fmu, start, system, folder, options, files):
    """Path of an FMU with start values of a system."""
    is_example = fmu in example_fmus.SLAVES
    table = example_fmus.table_of(fmu) if is_example else variables(archive.SLAVES[fmu], 0, wind_points=options.wind_points)
    known = {variable.name for variable in table if variable.causality != "output"}
    known |= {"file"} if fmu in files else set()
    starts = tuple((name, value) for name, value in start.items() if name in known)
    if is_example:
        return example_fmus.build(fmu, folder, starts, files.get(fmu, ()))
    about = f"With the start values of the system {system}."
    purpose = Purpose(system, about, STEP, STOP, PAGE.format(name=fmu, version=__version__, about=about))
    with warnings.catch_warnings():  # ends that are connected start where other FMUs say
        warnings.simplefilter("ignore", PlausibilityWarning)
        return archive.build(fmu, folder, replace(options, lean=Lean(starts=starts), purpose=purpose))


def _connectors(component, inputs, outputs, units):
    """Add the connectors of an FMU (`component` is modified); units : of its variables by name, None for none."""
    connectors = SubElement(component, "ssd:Connectors")
    for kind, names in (("input", inputs), ("output", outputs)):
        for name in names:
            unit = {"unit": units[name]} if units[name] else {}
            SubElement(SubElement(connectors, "ssd:Connector", name=name, kind=kind), "ssc:Real", unit)


def _units(root):
    """Add the units that the connectors of a system structure name (`root` is modified)."""
    listed = SubElement(root, "ssd:Units")
    for name in sorted({real.get("unit") for real in root.iter("ssc:Real")} - {None}):
        SubElement(SubElement(listed, "ssc:Unit", name=name), "ssc:BaseUnit", base_units(name))


def _parameters(name, values):
    space = {"xmlns:ssv": f"{NAMESPACE}ParameterValues"}
    root = Element("ssv:ParameterSet", space, version="1.0", name=name, generationTool=TOOL)
    parameters = SubElement(root, "ssv:Parameters")
    for each, value in values.items():
        parameter = SubElement(parameters, "ssv:Parameter", name=each)
        SubElement(parameter, "ssv:Integer" if isinstance(value, int) else "ssv:Real", value=number_text(value))
    return root
