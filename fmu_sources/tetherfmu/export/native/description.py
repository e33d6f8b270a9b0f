"""Model description of a native FMU for FMI 2.0: the variables of the PythonFMU slave, and the capabilities of the shell."""

from xml.etree.ElementTree import Element, SubElement

from tetherfmu.fmi.model_description import annotations, definitions, number_text, structure, variables
from tetherfmu.runtime import __version__
from tetherfmu.runtime.parameters import DEFAULT_TOLERANCE

from ..archive import GENERATED
from ..texts import xml_text

CAPABILITIES = {
    "needsExecutionTool": "false",
    "canHandleVariableCommunicationStepSize": "true",
    "canInterpolateInputs": "true",
    "maxOutputDerivativeOrder": "0",
    "canRunAsynchronuously": "false",
    "canBeInstantiatedOnlyOncePerProcess": "false",
    "canNotUseMemoryManagementFunctions": "true",
    "canGetAndSetFMUstate": "true",
    "canSerializeFMUstate": "true",
    "providesDirectionalDerivative": "true",
}
CATEGORIES = {
    "logStatusWarning": "what is implausible; it was done",
    "logStatusDiscard": "steps that were refused; the state does not change",
    "logStatusError": "other calls that were refused; the state does not change",
}


def text(model, token, sources=()):
    """Text of modelDescription.xml.

    model : `fmus.Model`.  token : the guid.  sources : C files that an importer compiles.
    """
    table = model.wiring.shown
    root = Element("fmiModelDescription", fmiVersion="2.0", guid=token, **facts(model))
    slave = SubElement(root, "CoSimulation", modelIdentifier=model.name, **CAPABILITIES)
    if sources:
        listed = SubElement(slave, "SourceFiles")
        for file in sources:
            SubElement(listed, "File", name=file)
    root.extend(definitions(table))
    root.append(categories())
    root.append(experiment(*model.times))
    root.extend(annotations("VendorAnnotations", "Tool", "name", model.wiring.constants))
    root.append(variables(table))
    root.append(structure(table))
    return xml_text(root)


def facts(model):
    """Attributes of the description in both versions of FMI."""
    own = {"modelName": model.name, "description": model.about, "author": "TetherFMU developers", "version": __version__}
    tool = {"generationTool": f"TetherFMU {__version__}", "generationDateAndTime": GENERATED}
    return own | {"license": "MIT"} | tool | {"variableNamingConvention": "structured"}


def experiment(step, stop):
    """DefaultExperiment; step : of communication [s].  stop : time [s]."""
    tolerance = f"{DEFAULT_TOLERANCE:.0e}".replace("e-0", "e-")
    times = {"startTime": "0", "stopTime": number_text(stop)}
    return Element("DefaultExperiment", **times, tolerance=tolerance, stepSize=repr(step))


def categories():
    """LogCategories."""
    element = Element("LogCategories")
    for name, meaning in CATEGORIES.items():
        SubElement(element, "Category", name=name, description=meaning)
    return element
