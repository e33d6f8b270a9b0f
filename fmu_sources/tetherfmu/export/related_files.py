"""The manifest of FMI's layered standard for related files (FMI-LS-REF 1.0.0-beta.1): roles of the evidence set files.

It is a draft: the evidence set itself uses the files of FMI's cross-check; the manifest names their roles.
"""

from pathlib import PurePosixPath
from xml.etree.ElementTree import Element, SubElement

from .texts import xml_text

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
MANIFEST = f"{FOLDER}/fmi-ls-manifest.xml"
NAMESPACE = "http://fmi-standard.org/fmi-ls-manifest"
ABOUT = {
    "fmi-ls-name": "org.fmi-standard.fmi-ls-ref",
    "fmi-ls-version": "1.0.0-beta.1",
    "fmi-ls-description": "Layered Standard providing information on related files included in an FMU.",
}
FILES = {  # type, role and description, by the end of a path
    "README.txt": ("text/plain", "document", "how to run the evidence set, and what its reference is"),
    "_in.csv": ("text/csv", "testcase", "inputs over time; all other variables keep their start values"),
    "_ref.csv": ("text/csv", "result", "reference results"),
    "_ref.opt": ("text/csv", "configuration", "steps, tolerance, allowed deviation and start values of the run"),
}


def manifest(paths):
    """Text of the manifest. paths : of the evidence set files in the archive, all listed in `FILES`."""
    root = Element("fmiReferences", {"xmlns:fmi-ls": NAMESPACE, **{f"fmi-ls:{key}": value for key, value in ABOUT.items()}})
    upwards = "../" * len(PurePosixPath(FOLDER).parts)
    for path in sorted(paths):
        kind, role, description = next(facts for end, facts in FILES.items() if path.endswith(end))
        SubElement(root, "Related", type=kind, source=upwards + path, role=role, description=description)
    return xml_text(root)
