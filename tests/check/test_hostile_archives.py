"""Archives that are made to harm: each is a finding in one sentence, with bounded memory, and never a traceback."""

import re
import stat
import subprocess
import sys
import zipfile
from itertools import pairwise

import pytest

from foreign import foreign
from tetherfmu.check import soundness

MEMORY = 1 << 30  # bytes of address space; the check needs a fifth of that, a file of 1.2 GB as a whole more than that
DTD = "has a document type declaration (DTD)"


@pytest.fixture
def fmu(tmp_path):
    return foreign(tmp_path / "foreign.fmu")


def check(path, memory=None):
    """Exit status of the command and what it printed; nothing else is said."""
    limited = memory and sys.platform == "linux"
    limit = f"import resource; resource.setrlimit(resource.RLIMIT_AS, ({memory}, {memory})); " if limited else ""
    line = f"{limit}import sys; from tetherfmu.check.__main__ import main; sys.exit(main(sys.argv[1:]))"
    done = subprocess.run([sys.executable, "-c", line, str(path)], capture_output=True, text=True, check=False)
    assert done.stderr == ""
    return done.returncode, done.stdout


def refused(path, words, **options):
    status, said = check(path, **options)
    assert (status, said.count("PROBLEM")) == (1, 1), said
    assert words in said


def with_description(fmu, change):
    """The FMU with another text of its model description."""
    with zipfile.ZipFile(fmu) as archive:
        text = archive.read("modelDescription.xml").decode()
    with zipfile.ZipFile(fmu, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", change(text))
    return fmu


LAUGHS = "".join(f"<!ENTITY {b} '{10 * f'&{a};'}'>" for a, b in pairwise("abcdefghi"))
DECLARATIONS = {
    "external": '<!DOCTYPE x [<!ENTITY secret SYSTEM "file:///etc/hostname">]>',
    "over the net": '<!DOCTYPE x SYSTEM "http://localhost:9/x.dtd">',
    "laughs": f"<!DOCTYPE x [<!ENTITY a 'ha'>{LAUGHS}]>",
}


@pytest.mark.parametrize("kind", DECLARATIONS)
@pytest.mark.parametrize("file", soundness.READ_AS_XML)
def test_entities(fmu, kind, file):
    """Declared, whether used or not: what the file names is not read."""
    text = f'<?xml version="1.0"?>{DECLARATIONS[kind]}<x>&secret;</x>'
    if file == soundness.DESCRIPTION:
        with_description(fmu, lambda _: text)
    else:
        with zipfile.ZipFile(fmu, "a") as archive:
            archive.writestr(file, text)
    refused(fmu, f"{file} {DTD}, which may define entities; an FMU must not have one")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda text: text.replace("<Real/>", "<a>" * 5000 + "</a>" * 5000), "nested more than 100 deep"),
        (lambda text: text.replace("<Real/>", "<a/>" * 500_001), "more than 500000 elements"),
        (lambda text: text[:-20], "modelDescription.xml is not readable XML: unclosed token"),
        (
            lambda text: text.replace("UTF-8", "EBCDIC-XX"),
            "modelDescription.xml is not readable XML: unknown encoding",
        ),
        (lambda text: "", "modelDescription.xml is not readable XML"),
        (
            lambda text: text.replace('="foreign"', '="../../foreign"'),
            "has the modelIdentifier '../../foreign'; it must be a name",
        ),
        (lambda text: text.replace('fmiVersion="2.0"', 'fmiVersion="7.0"'), "the fmiVersion is 7; it must be 1, 2, 3"),
        (lambda text: text.replace('fmiVersion="2.0"', ""), "the fmiVersion is missing; it must be 1, 2, 3"),
    ],
    ids=["deep", "many", "truncated", "encoding", "empty", "identifier", "version", "no version"],
)
def test_xml(fmu, change, words):
    refused(with_description(fmu, change), words)


def of_zeros(path, mode, name, size):
    """Write zeros to a file of an archive, which becomes a thousandth of them."""
    with zipfile.ZipFile(path, mode, zipfile.ZIP_DEFLATED, compresslevel=1) as archive, archive.open(name, "w") as file:
        for _ in range(size // 1_000_000):
            file.write(bytes(1_000_000))


def test_few_mb_that_become_more_than_1_gb(tmp_path):
    """As the description, which was read as a whole."""
    path = tmp_path / "large.fmu"
    of_zeros(path, "w", "modelDescription.xml", 1_200_000_000)
    assert path.stat().st_size < 10e6
    refused(path, "the files of the archive have 1200 MB when they are extracted; this check accepts at most", memory=MEMORY)


def test_a_long_description(fmu):
    refused(with_description(fmu, lambda text: text + " " * 30_000_000), "modelDescription.xml has 30 MB", memory=MEMORY)


def test_a_size_that_is_a_lie(fmu):
    """1 kB in the list, 900 MB in the data: no more than what the list says is unpacked, and that is damaged."""
    of_zeros(fmu, "a", "resources/a", 900_000_000)
    content = bytearray(fmu.read_bytes())
    for place in [match.start() for match in re.finditer(re.escape((900_000_000).to_bytes(4, "little")), content)]:
        content[place : place + 4] = (1000).to_bytes(4, "little")
    fmu.write_bytes(content)
    refused(fmu, "'resources/a' is damaged", memory=MEMORY)


def entry(name, mode=0o644, method=zipfile.ZIP_STORED):
    info = zipfile.ZipInfo(name)
    info.external_attr, info.compress_type = mode << 16, method
    return info


@pytest.mark.parametrize(
    ("info", "words"),
    [
        (entry("resources/link", stat.S_IFLNK | 0o777), "'resources/link' is a symbolic link"),
        (entry("resources/a", method=zipfile.ZIP_LZMA), "'resources/a' is compressed in a way that FMI does not allow"),
        (entry("resources/a", method=zipfile.ZIP_BZIP2), "'resources/a' is compressed in a way that FMI does not allow"),
        (entry("../escape.txt"), "which leads out of it"),
        (entry("/root.txt"), "which leads out of it"),
        (entry("folder\\file.txt"), "folder"),
        (entry("C:/autostart"), "the path 'C:/autostart', which leads out of it"),
        (entry("resources/../../a"), "which leads out of it"),
        (entry("MODELDESCRIPTION.xml"), "names that differ in upper and lower case only"),
    ],
)
def test_entries(fmu, info, words):
    with zipfile.ZipFile(fmu, "a") as archive:
        archive.writestr(info, "/etc/passwd")
    refused(fmu, words)


def test_an_encrypted_archive(fmu):
    content = bytearray(fmu.read_bytes())
    for mark, flags in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        content[content.find(mark) + flags] |= soundness.ENCRYPTED
    fmu.write_bytes(content)
    refused(fmu, "'modelDescription.xml' is encrypted; importers cannot read it")


def test_two_files_of_one_name(fmu):
    with zipfile.ZipFile(fmu, "a") as archive, pytest.warns(UserWarning, match="Duplicate name"):
        archive.writestr("modelDescription.xml", "<another/>")
    refused(fmu, "two files of one name")


@pytest.mark.parametrize(
    ("count", "length", "words"), [(10_001, 1, "files; this check accepts at most 10000"), (300, 40_000, "12 MB")]
)
def test_a_long_list_of_files(tmp_path, count, length, words):
    path = tmp_path / "many.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        for k in range(count):
            archive.writestr(f"{k:0{length}d}", "")
    refused(path, words, memory=MEMORY)


def test_an_empty_archive(tmp_path):
    zipfile.ZipFile(tmp_path / "empty.fmu", "w").close()
    refused(tmp_path / "empty.fmu", "no modelDescription.xml")


@pytest.mark.parametrize("part", [0.0, 0.1, 0.5, 0.9, 0.999])
def test_a_truncated_archive(fmu, part):
    content = fmu.read_bytes()
    fmu.write_bytes(content[: int(part * len(content))])
    refused(fmu, "this is not a readable zip archive")
