"""The XML schema of FMI 2.0 and fmu-manipulation-toolbox find no problem (FMPy's validation: test_model_description.py)."""

import logging
import zipfile
from pathlib import Path

import fmpy
from fmu_manipulation_toolbox.checker import get_checkers
from fmu_manipulation_toolbox.operations import FMU
from lxml import etree

from runtime.host import of_every_flavour

SCHEMA = Path(fmpy.__file__).parent / "schema" / "fmi2" / "fmi2ModelDescription.xsd"
every_fmu = of_every_flavour("name")


@every_fmu
def test_schema(fmu_folder, name):
    schema = etree.XMLSchema(etree.parse(str(SCHEMA)))
    with zipfile.ZipFile(fmu_folder / f"{name}.fmu") as archive:
        schema.assertValid(etree.fromstring(archive.read("modelDescription.xml")))


@every_fmu
def test_toolbox(fmu_folder, caplog, name):
    """Its checkers tell a problem in the log only."""
    caplog.set_level(logging.INFO)
    checkers = [checker() for checker in get_checkers()]
    with FMU(str(fmu_folder / f"{name}.fmu")) as fmu:
        for checker in checkers:
            fmu.apply_operation(checker)
    assert [record.message for record in caplog.records if record.levelno > logging.INFO] == []
    assert caplog.messages[-1] == "No semantic error against the FMI-2 standard."
