"""A model with a file: the String parameter `file` beside its numbers, in the model description and in the saved state.

The state holds the name of the file, not what is in it.
"""

import struct
import zlib
from pathlib import Path
from xml.etree.ElementTree import SubElement

from tetherfmu.fmi.resources import options_in
from tetherfmu.runtime import refusals
from tetherfmu.runtime.saved_state import STEPPING

from .model_slave import ModelSlave

TAIL = struct.Struct("<II")  # of a saved state: length and checksum of the name, which is before it
LONGEST_NAME = 4096  # bytes
INSIDE = "resources/"  # begins the name of a file that is in the FMU


class FileSlave(ModelSlave):
    """An FMU of the examples with a file, whose name is `self.file`."""

    about_file = ""  # what it is, one line for people

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.file = str(dict(options_in(self.resources).get("starts", ())).get("file", ""))
        self._file_reference = len(self.table)  # that of the numbers are below

    def to_xml(self, model_options=None):
        """Model description with the file, on which the first outputs depend."""
        root = super().to_xml(model_options)
        known = {"causality": "parameter", "variability": "fixed", "initial": "exact"}
        named = {"name": "file", "valueReference": str(self._file_reference), "description": self.about_file}
        SubElement(SubElement(root.find("ModelVariables"), "ScalarVariable", named | known), "String", start=self.file)
        for unknown in root.findall("ModelStructure/InitialUnknowns/Unknown"):
            unknown.set("dependencies", f"{unknown.get('dependencies')} {len(self.table) + 1}".strip())
        return root

    def path(self):
        """Where the file is: in the resources of the FMU if its name begins so."""
        inside = self.file.startswith(INSIDE) and self.resources
        return str(Path(self.resources) / self.file.removeprefix(INSIDE)) if inside else self.file

    def get_string(self, vrs):
        """The name of the file."""
        wrong = [reference for reference in vrs if reference != self._file_reference]
        if wrong:
            self.refuse(refusals.CANNOT_BE_READ.format(reference=wrong[0], name=self.name_of(wrong[0])))
        return ["" if reference in wrong else self.file for reference in vrs]

    def set_string(self, vrs, values):
        """Store the name of the file; it is opened when initialization ends."""
        for reference, value in zip(vrs, values, strict=True):
            if reference != self._file_reference:
                name = self.name_of(reference)
                self.refuse(refusals.CANNOT_BE_SET.format(reference=reference, name=name, value=repr(value)))
            elif self.phase >= STEPPING:
                self.refuse(refusals.IS_FIXED.format(name="file", value=repr(value)))
            elif len(value.encode()) > LONGEST_NAME:
                self.refuse(f"file has a name of {len(value.encode())} bytes; it must have at most {LONGEST_NAME}")
            else:
                self.file = value

    def state_to_bytes(self):
        """The whole state as bytes."""
        name = self.file.encode()
        return super().state_to_bytes() + name + TAIL.pack(len(name), zlib.crc32(name))

    def state_from_bytes(self, blob):
        """Go back to a state; ValueError, with nothing changed, if it is none of this model."""
        if not isinstance(blob, bytes) or len(blob) < TAIL.size:
            raise ValueError(refusals.NO_STATE)
        length, checksum = TAIL.unpack(blob[-TAIL.size :])
        end = len(blob) - TAIL.size
        name = blob[max(end - length, 0) : end]
        if length > LONGEST_NAME or zlib.crc32(name) != checksum:
            raise ValueError(refusals.STATE_DAMAGED)
        text = name.decode()  # UnicodeDecodeError is a ValueError
        super().state_from_bytes(blob[: end - length])
        self.file = text
