"""FMUs in all flavours: by PythonFMU, and native ones for FMI 2 and 3; what the states of each of them have to do."""

import math
import zlib

import pytest
from fmpy.fmi1 import FMICallException

from runtime.host import STEP, Host, blob_of, extract_all, restore
from tetherfmu.commands.build import main
from tetherfmu.export import system_fmus
from tetherfmu.export.build_options import BuildOptions
from tetherfmu.libraries import native_shell

FLAVOURS = {"pythonfmu": None, "native": 2, "native_fmi3": 3}  # version of FMI of a native FMU
NEXT = dict(zip(FLAVOURS, [*FLAVOURS][1:] + [*FLAVOURS][:1], strict=True))  # flavour that takes states over from one
WIND_POINTS = 3  # of the FMUs of the fixture `windy`
every_flavour = pytest.mark.parametrize("flavour", FLAVOURS)


def build_by_command(folder, flavour, *options):
    """Build what the options of the command name, or all tethers, and extract it."""
    native = () if flavour == "pythonfmu" else ("--native", "--header", "--fmi", str(FLAVOURS[flavour]))
    assert main([*options, "--out", str(folder), *native]) == 0
    extract_all(folder)


def folder_of(built_once, flavour):
    """Folder with all FMUs of a flavour."""
    return built_once(f"{flavour}_fmus", lambda folder: build_by_command(folder, flavour))


def build_system(folder, flavour, text, wind_points, with_evidence):
    """Build the FMU of a system, from the text of its file, in a flavour, beside the file.

    with_evidence : or without its evidence set, three flights that take longer than all else, and with a C shell that is
    not optimized and files that are hardly compressed, which takes a third of the time; the numbers are the same.
    """
    file = folder / "system.toml"
    file.write_text(text, encoding="utf-8")
    options = BuildOptions(shape_points=None, wind_points=wind_points)
    with pytest.MonkeyPatch.context() as changed:
        if not with_evidence:
            changed.setattr(system_fmus, "_evidence_of", lambda *given: {})
            changed.setattr(zlib, "Z_DEFAULT_COMPRESSION", 1)
            changed.setattr(native_shell, "OPTIONS", ("-O0", "-fno-sanitize=all", *native_shell.OPTIONS[1:]))
        system_fmus.build(file, folder, options, native=FLAVOURS[flavour])
    extract_all(folder)


def assert_said(messages, sentences):
    """The same is said, behind the name of the instance or of the call; a message is a printf format."""
    said = [message.replace("%%", "%") for message in messages]
    assert len(said) == len(sentences), (said, sentences)
    assert all(any(each.endswith(f": {sentence}") for each in said) for sentence in sentences), (said, sentences)


def check_flight(host, other, rows, sentences, half, *, start, step, assert_same):
    """Flown once; again from its half after what was refused and what is taken back, elsewhere, after a reset; anew.

    host : a `Host` before its start.  other : folder of the FMU that takes its states over.  rows : what is expected at the
    start and after each step.  sentences : what is said in all of them.  half : number of steps of the first half.
    start(host), step(host, k), assert_same(host, row) : start it, do step k with its inputs, compare its outputs.
    """

    def fly(host, begin, expected):
        for k, row in enumerate(expected, start=begin):
            host.time = k * STEP
            step(host, k)
            assert_same(host, row)

    start(host)
    assert_same(host, rows[0])
    fly(host, 0, rows[1 : half + 1])
    blob, rest = blob_of(host), rows[half + 1 :]
    fly(host, half, rest)
    assert_said(host.messages, sentences)
    restore(host, blob)
    with pytest.raises(FMICallException):
        host.step(math.nan)
    assert blob_of(host) == blob
    step(host, half + 7)
    restore(host, blob)
    assert blob_of(host) == blob
    fly(host, half, rest)
    late = blob_of(host)
    restore(host, late)
    assert blob_of(host) == late
    taker = Host(other, "taker")
    restore(taker, blob)
    assert_same(taker, rows[half])
    assert blob_of(taker) == blob
    fly(taker, half, rest)
    host.fmu.reset()
    restore(host, blob)
    fly(host, half, rest)
    host.fmu.terminate()
    restore(host, blob)
    fly(host, half, rest)
    host.fmu.reset()
    start(host)
    assert_same(host, rows[0])
    fly(host, 0, rows[1:3])
