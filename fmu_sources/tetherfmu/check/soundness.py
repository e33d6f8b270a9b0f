"""Whether a file is a readable archive: sound, of bounded size, with plain XML. Nothing is read before this check.

Afterwards the sizes in the archive are reliable: `zipfile` reads no more of a file than the list states.
"""

import io
import re
import stat
import struct
import zipfile
import zlib
from pathlib import Path, PurePosixPath, PureWindowsPath
from typing import NamedTuple
from xml.parsers import expat

from .evidence_runs import EVIDENCE_FOLDER

OK, NOTE, PROBLEM = "ok", "note", "PROBLEM"  # levels of findings
DESCRIPTION = "modelDescription.xml"
READ_AS_XML = (DESCRIPTION, "terminalsAndIcons/terminalsAndIcons.xml", "sources/buildDescription.xml")  # by FMPy
IDENTIFIER = "modelIdentifier"  # attribute that names the library
LARGEST_LIST = 10_000_000  # bytes of the list of files in the archive
MOST_FILES = 10_000
LARGEST_SUM = 1_000_000_000  # bytes of all files
LARGEST_TEXT = 20_000_000  # bytes of a file that is read as a whole
MOST_ELEMENTS, DEEPEST = 500_000, 100  # of XML
CHUNK = 1 << 16  # bytes
METHODS = {zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED}  # of compression
ENCRYPTED = 1  # bit of the flags of a file
UNREADABLE = (
    *(zipfile.BadZipFile, zlib.error, struct.error),
    *(EOFError, OSError, RuntimeError, NotImplementedError, ValueError, OverflowError),
)
MOST = "this check accepts at most "
AGAIN = "build or download the FMU again"


class Finding(NamedTuple):
    """One finding: its level (`OK`, `NOTE` or `PROBLEM`), its description, and the remedy if there is one."""

    level: str
    text: str
    remedy: str = ""


class Bounded(io.FileIO):
    """A file that refuses large reads, such as `zipfile`'s read of the list of files."""

    def read(self, size=-1):
        """At most this number of bytes; OSError if too many are requested."""
        if size > LARGEST_LIST:
            raise OSError(f"the list of its files has {size / 1e6:.0f} MB; {MOST}{LARGEST_LIST / 1e6:.0f} MB")
        return super().read(size)


def archive(path):
    """Findings on the file as an archive with a model description."""
    try:
        with Bounded(path) as file, zipfile.ZipFile(file) as opened:
            files = opened.infolist()
            found = too_much(files) or [*wrong_files(files)]
            if not found and (damaged := opened.testzip()):
                found = [Finding(PROBLEM, f"{damaged!r} is damaged in the archive", AGAIN)]
            if not found:
                found = [Finding(PROBLEM, problem) for name in READ_AS_XML for problem in problems_of_xml(opened, name)]
    except UNREADABLE as error:
        return [Finding(PROBLEM, f"this is not a readable zip archive: {error}", AGAIN)]
    return found or [Finding(OK, f"archive: {len(files)} files, {Path(path).stat().st_size / 1000:.0f} kB, none damaged")]


def too_much(files):
    """Limits that these entries (`zipfile.ZipInfo`) exceed: a list of one finding, or an empty one."""
    if len(files) > MOST_FILES:
        return [Finding(PROBLEM, f"the archive has {len(files)} files; {MOST}{MOST_FILES}")]
    size = sum(each.file_size for each in files)
    if size > LARGEST_SUM:
        text = f"the files of the archive have {size / 1e6:.0f} MB when they are extracted"
        return [Finding(PROBLEM, f"{text}; {MOST}{LARGEST_SUM / 1e6:.0f} MB")]
    return []


def wrong_files(files):
    """Yield a finding for each entry that no FMU has, or that no importer should extract."""
    names = [each.orig_filename for each in files]
    if DESCRIPTION not in names:
        yield Finding(PROBLEM, f"this is not an FMU: it has no {DESCRIPTION} at its root")
    for each in files:
        name = each.orig_filename
        if leads_out(name):
            yield Finding(PROBLEM, f"the archive has the path {name!r}, which leads out of it or has a backslash")
        if stat.S_ISLNK(each.external_attr >> 16):
            yield Finding(PROBLEM, f"{name!r} is a symbolic link; an FMU has files only")
        if each.flag_bits & ENCRYPTED:
            yield Finding(PROBLEM, f"{name!r} is encrypted; importers cannot read it")
        elif each.compress_type not in METHODS:
            yield Finding(PROBLEM, f"{name!r} is compressed in a way that FMI does not allow; it must be deflated or stored")
        is_text = name in READ_AS_XML or name.startswith(EVIDENCE_FOLDER)
        if is_text and each.file_size > LARGEST_TEXT:
            yield Finding(PROBLEM, f"{name} has {each.file_size / 1e6:.0f} MB; {MOST}{LARGEST_TEXT / 1e6:.0f} MB")
    if len({name.rstrip("/").lower() for name in names}) < len(names):
        yield Finding(PROBLEM, "the archive has two files of one name, or names that differ in upper and lower case only")


def leads_out(name):
    """Whether a path of an archive may lead out of the folder for extraction on some system."""
    rooted = name.startswith("/") or PureWindowsPath(name).drive
    return bool(rooted or "\\" in name or "\0" in name or ".." in PurePosixPath(name).parts)


def problems_of_xml(opened, name):
    """Why a file of an opened archive is not read as XML: a list of one sentence, or an empty one."""
    if name not in opened.namelist():
        return []
    parser, depths, count = expat.ParserCreate(), [0], [0]

    def refuse_doctype(*_):
        raise ValueError("has a document type declaration (DTD), which may define entities; an FMU must not have one")

    def enter(_, attributes):
        identifier = attributes.get(IDENTIFIER, "a")
        if not re.fullmatch(r"[A-Za-z_]\w*", identifier, re.ASCII):
            raise ValueError(f"has the {IDENTIFIER} {identifier!r}; it must be a name in C, and names a file in the archive")
        depths[0] += 1
        count[0] += 1
        if depths[0] > DEEPEST:
            raise ValueError(f"has elements that are nested more than {DEEPEST} deep")
        if count[0] > MOST_ELEMENTS:
            raise ValueError(f"has more than {MOST_ELEMENTS} elements, the most that this check accepts")

    def leave(*_):
        depths[0] -= 1

    parser.StartDoctypeDeclHandler, parser.StartElementHandler, parser.EndElementHandler = refuse_doctype, enter, leave
    try:
        with opened.open(name) as file:
            while chunk := file.read(CHUNK):
                parser.Parse(chunk)
        parser.Parse(b"", True)
    except (expat.ExpatError, LookupError) as error:  # the second of an unknown encoding
        return [f"{name} is not readable XML: {error}"]
    except ValueError as error:
        return [f"{name} {error}"]
    return []
