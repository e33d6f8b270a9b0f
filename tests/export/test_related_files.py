"""The manifest of related files: attributes that the draft of FMI fixes, its roles, and files that are in the archive."""

import posixpath
import re
import zipfile
from xml.etree import ElementTree

from runtime.host import of_every_flavour
from tetherfmu.export.documents import EVIDENCE_FOLDER

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"
NAMESPACE = "{http://fmi-standard.org/fmi-ls-manifest}"
FIXED = {  # by the schema of 1.0.0-beta.1
    "fmi-ls-name": "org.fmi-standard.fmi-ls-ref",
    "fmi-ls-version": "1.0.0-beta.1",
    "fmi-ls-description": "Layered Standard providing information on related files included in an FMU.",
}
ROLES = re.compile(
    "document|requirement|specification|model|parameter|system|testcase|result|method|rationale|report|request|delivery|"
    "configuration|signature|meta-data|other|experiment(/(smoke-test|validation|uncertainty-analysis))?|serialized-state(/.*)?"
)


@of_every_flavour("name")
def test_names_every_file_of_the_evidence_set(fmu_folder, name):
    with zipfile.ZipFile(fmu_folder / f"{name}.fmu") as archive:
        names = archive.namelist()
        root = ElementTree.fromstring(archive.read(f"{FOLDER}/fmi-ls-manifest.xml"))
    assert root.tag == "fmiReferences"
    assert root.attrib == {f"{NAMESPACE}{key}": value for key, value in FIXED.items()}
    assert all(set(each.attrib) == {"type", "source", "role", "description"} for each in root)
    assert all(each.tag == "Related" and ROLES.fullmatch(each.get("role")) for each in root)
    found = [posixpath.normpath(posixpath.join(FOLDER, each.get("source"))) for each in root]
    assert found == sorted(each for each in names if each.startswith(EVIDENCE_FOLDER))
    assert len(found) == 1 + 3 * 3
