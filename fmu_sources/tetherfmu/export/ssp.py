"""Systems of FMUs as SSP 1.0 files: the system structure, parameter sets, and FMUs that are built with their start values.

The FMUs carry all start values themselves, because not every importer sets enumerations, or reads parameter sets. A parameter
set holds what a fidelity changes. Each fidelity has a system structure of its own in the file, as SSP allows; the one that is
called SystemStructure.ssd is what importers open.
"""

import sys
import tempfile
from importlib import import_module
from pathlib import Path
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from fmpy import read_model_description

from tetherfmu.libraries.sources import EXAMPLES
from tetherfmu.runtime import __version__
from tetherfmu.runtime.model_description import number

from . import archive, example_fmus

NAMESPACE = "http://ssp-standard.org/SSP1/SystemStructure"
PREFIXES = {"ssd": "Description", "ssc": "Common", "ssv": "ParameterValues"}
FMU = "application/x-fmu-sharedlibrary"
STEP, STOP = 0.02, 200.0  # of the default experiment [s]
PAGE = "<!DOCTYPE html>\n<title>{name}</title>\n<p>{name} of TetherFMU {version}, with the start values of the system {system}.</p>\n"


def write_all(folder, platforms=None):
    """Write the systems of the examples to a folder; returns their paths.  platforms : for the kernels, as `archive.build`."""
    if str(EXAMPLES) not in sys.path:
        sys.path.append(str(EXAMPLES))
    given = import_module("kite_power_system")
    power = {name: {"tether": values} for name, values in given.FIDELITIES.items()}
    return [
        write("kite_power_system", given.FMUS, given.START, power, Path(folder), platforms),
        write("circular_flight", given.CIRCLE, given.CIRCLE_START, {"standard": {}}, Path(folder), platforms),
    ]


def write(name, fmus, start, fidelities, folder, platforms=None):
    """Write NAME.ssp; returns its path.

    fmus : dict of instances to names of FMUs.  start : start values, of every FMU that has the name.  fidelities : dict of
    names to dicts of instances to values of parameters; "standard" is the one that importers open.
    """
    wiring = import_module("kite_power_system")
    with tempfile.TemporaryDirectory() as temporary:
        paths = {each: _built(fmu, start, name, Path(temporary) / each, platforms) for each, fmu in fmus.items()}
        variables = {instance: read_model_description(str(path)).modelVariables for instance, path in paths.items()}
        files = {f"resources/{fmus[each]}.fmu": path.read_bytes() for each, path in paths.items()}
    givers = {output: instance for instance, known in variables.items() for output in wiring.given_by(known)}
    for fidelity, values in fidelities.items():
        end = "" if fidelity == "standard" else f"_{fidelity}"
        root = _described(name, fidelity)
        system = SubElement(root, "ssd:System", name=name)
        elements = SubElement(system, "ssd:Elements")
        connections = SubElement(system, "ssd:Connections")
        for instance, known in variables.items():
            inputs = wiring.wanted_by(known, givers)
            component = SubElement(elements, "ssd:Component", name=instance, type=FMU, source=f"resources/{fmus[instance]}.fmu")
            _connectors(component, inputs, wiring.given_by(known))
            if instance in values:
                bindings = SubElement(component, "ssd:ParameterBindings")
                SubElement(bindings, "ssd:ParameterBinding", source=f"resources/{instance}_{fidelity}.ssv")
                files[f"resources/{instance}_{fidelity}.ssv"] = _text(_parameters(fidelity, values[instance]))
            for each in inputs:
                ends = {"startElement": givers[each], "endElement": instance}
                SubElement(connections, "ssd:Connection", ends, startConnector=each, endConnector=each)
        SubElement(root, "ssd:DefaultExperiment", startTime="0", stopTime=number(STOP))
        files[f"SystemStructure{end}.ssd"] = _text(root)
    return archive.write_archive(files, folder / f"{name}.ssp")


def _built(fmu, start, system, folder, platforms):
    """Path of an FMU with start values of a system."""
    if fmu in example_fmus.SLAVES:
        known = {variable.name for variable in example_fmus.table_of(fmu) if variable.causality != "output"}
        return example_fmus.build(fmu, folder, [(name, value) for name, value in start.items() if name in known])
    starts = [[name, value] for name, value in start.items()]
    page = PAGE.format(name=fmu, version=__version__, system=system)
    trim = archive.Trim(system, starts, [], f"With the start values of the system {system}.", STEP, page)
    return archive.build(fmu, folder, platforms=platforms, scene=trim)


def _described(name, fidelity):
    spaces = {f"xmlns:{prefix}": f"{NAMESPACE}{what}" for prefix, what in PREFIXES.items()}
    tool = f"TetherFMU {__version__}"
    return Element("ssd:SystemStructureDescription", spaces, name=f"{name}, {fidelity}", version="1.0", generationTool=tool)


def _connectors(component, inputs, outputs):
    connectors = SubElement(component, "ssd:Connectors")
    for kind, names in (("input", inputs), ("output", outputs)):
        for name in names:
            SubElement(SubElement(connectors, "ssd:Connector", name=name, kind=kind), "ssc:Real")


def _parameters(name, values):
    space = {"xmlns:ssv": f"{NAMESPACE}ParameterValues"}
    root = Element("ssv:ParameterSet", space, version="1.0", name=name, generationTool=f"TetherFMU {__version__}")
    parameters = SubElement(root, "ssv:Parameters")
    for each, value in values.items():
        parameter = SubElement(parameters, "ssv:Parameter", name=each)
        SubElement(parameter, "ssv:Integer" if isinstance(value, int) else "ssv:Real", value=number(value))
    return root


def _text(root):
    indent(root)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, encoding="utf-8") + b"\n"
