"""`python -m tetherfmu.check` finds what is wrong with an FMU or its place, names the remedy, and never dies of it."""

import os
import re
import shutil
import signal
import subprocess
import sys
import sysconfig
import tempfile
import time
import zipfile
from pathlib import Path

import pytest

from foreign import foreign
from tetherfmu.check import __main__, apart, inspection
from tetherfmu.export import evidence
from tetherfmu.export.archive import SLAVES, build
from tetherfmu.export.build_options import BuildOptions
from tetherfmu.runtime.kernel_library import this_platform


def command(*arguments):
    """Exit status of the command and what it said, on stdout and on stderr."""
    line = [sys.executable, "-m", "tetherfmu.check", *map(str, arguments)]
    done = subprocess.run(line, capture_output=True, text=True, check=False)
    assert "Traceback" not in done.stderr
    return done.returncode, done.stdout + done.stderr


@pytest.fixture
def run(capfd, monkeypatch):
    """The same without a new process for the command; the FMU has its own all the same."""

    def run(*arguments, **environment):
        with monkeypatch.context() as changed:
            changed.setattr(tempfile, "tempdir", None)  # TMPDIR is looked at again
            for name, value in environment.items():
                changed.setenv(name, value)
            status = __main__.main([*map(str, arguments)])
        return status, "".join(capfd.readouterr())

    return run


def changed(source, target, change):
    """Copy an FMU; change : function of the name and the bytes of a file, None leaves the file out. Returns the copy."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            content = change(name, old.read(name))
            if content is not None:
                new.writestr(name, content)
    return target


def test_sound_fmus(run, fmu_folder):
    status, said = run(*(fmu_folder / f"{name}.fmu" for name in SLAVES))
    assert status == 0
    assert said.count("valid by the XML schema of FMI 2.0, and FMPy finds no problem") == len(SLAVES)
    assert said.count("evidence set: 200 steps") == len(SLAVES)
    for kind in evidence.GIVEN:
        assert said.count(f"evidence set, winch by {kind}: {evidence.WINCH_STEPS} steps") == len(SLAVES)
    assert len(re.findall(r"kite_force\[3\] +[\d.e+-]+ of +[\d.e+-]+ N$", said, re.MULTILINE)) == len(SLAVES)
    assert f"on {this_platform()}" in said
    assert "0 problems found" in said


def test_sound_native_fmus(run, native_folder, fmi3_folder):
    """The evidence sets run, that for FMI 3 with arrays: with the same deviations, digit by digit."""
    status, said = run(native_folder / "TetherDynamicFree.fmu", fmi3_folder / "TetherDynamicFree.fmu")
    assert status == 0
    for version in (2, 3):
        assert f"valid by the XML schema of FMI {version}.0, and FMPy finds no problem" in said
    two, three = said.split("evidence set: 200 steps")[1:]
    deviations = re.findall(r"^ +(\w+(?:\[\d\])?) +(\S+) of +(\S+) (N|m)$", two, re.MULTILINE)
    assert len(deviations) == 10 + 2 * 6  # of the winch three in N or m, and where the kite is
    assert deviations == re.findall(r"^ +(\w+(?:\[\d\])?) +(\S+) of +(\S+) (N|m)$", three, re.MULTILINE)
    assert "LD_PRELOAD" not in said


def test_wrong_use(tmp_path, fmu_folder):
    assert command()[0] == 2
    for wrong in (tmp_path / "none.fmu", tmp_path):
        status, said = command(fmu_folder / "TetherStraight.fmu", wrong)
        assert status == 2
        assert str(wrong) in said


def test_without_fmpy_it_says_how_to_get_it(monkeypatch, capsys, fmu_folder):
    find = __main__.importlib.util.find_spec
    monkeypatch.setattr(__main__.importlib.util, "find_spec", lambda name: None if name == "fmpy" else find(name))
    assert __main__.main([str(fmu_folder / "TetherStraight.fmu")]) == 2
    assert "pip install fmpy" in capsys.readouterr().err


DAMAGES = {  # in the list of files, not in a date there, which nobody would call damage
    "signature of the list": lambda content: content.rfind(b"PK\x01\x02"),
    "signature of the end": lambda content: content.rfind(b"PK\x05\x06"),
    "name in the list": lambda content: content.rfind(b"PK\x01\x02") + 46,
    **{f"byte {place}": lambda content, place=place: place for place in (30, 2000, 40_000, 150_000)},
}


@pytest.mark.parametrize("damage", list(DAMAGES))
def test_damaged_archive(run, tmp_path, fmu_folder, damage):
    content = bytearray((fmu_folder / "TetherStraight.fmu").read_bytes())
    content[DAMAGES[damage](content)] ^= 0xFF
    damaged = tmp_path / "TetherStraight.fmu"
    damaged.write_bytes(content)
    status, said = run(damaged)
    assert status == 1
    assert "damaged" in said or "not a readable zip archive" in said


@pytest.mark.parametrize("fmi", ["2.0", "1.0", "3.0"])
def test_a_foreign_fmu_is_validated_only(run, tmp_path, fmi):
    status, said = run(foreign(tmp_path / "foreign.fmu", fmi))
    assert "no evidence set in this FMU: it was validated, not run" in said
    icon = "terminalsAndIcons/icon.png" if fmi == "3.0" else "model.png"
    assert f"FMI recommends files that the FMU lacks: {icon}" in said
    assert "PythonFMU" not in said
    assert status == (0 if fmi == "2.0" else 1)  # the description of another version has other elements


def test_a_wrong_model_description(run, tmp_path):
    status, said = run(foreign(tmp_path / "foreign.fmu", wrong=' unitt="m"'))
    assert status == 1
    assert "FMPy's validation: ERROR (line 6, column 0)" in said
    assert said.count("PROBLEM") == 1  # said once
    broken = changed(tmp_path / "foreign.fmu", tmp_path / "broken.fmu", lambda name, content: content[:-20])
    assert run(broken)[0] == 1


@pytest.mark.parametrize(
    ("name", "is_legal"),
    [
        ("a[1,20]._b.c3", True),
        ("der(a,2)", True),
        ("'a b'", True),
        ("a b", False),
        ("a[1", False),
        ("a[-1]", False),
        ("2a", False),
    ],
)
def test_names_of_variables_are_those_of_the_grammar(tmp_path, fmu_folder, name, is_legal):
    def rename(file, content):
        return content.replace(b'"reel_out_speed"', f'"{name}"'.encode()) if file == "modelDescription.xml" else content

    (found, *_) = inspection.description(changed(fmu_folder / "TetherStraight.fmu", tmp_path / "TetherStraight.fmu", rename))
    assert (found.level == "ok", "is not a legal variable name" in found.text) == (is_legal, not is_legal)


@pytest.mark.parametrize("character", "+#%()[]',&;=@!ä")
def test_characters_that_crash_pythonfmu(tmp_path, character):
    assert inspection.crashing_characters(tmp_path / f"a{character}b") == [character]


@pytest.mark.parametrize("character", "'ä")
def test_a_folder_for_extraction_that_crashes_pythonfmu(run, tmp_path, fmu_folder, character):
    """The run is refused with the remedy."""
    special = tmp_path / f"a{character}b"
    special.mkdir()
    status, said = run(fmu_folder / "TetherStraight.fmu", TMPDIR=str(special))
    assert status == 1
    assert f"crashes on {character} in that path" in said
    assert "TMPDIR" in said
    assert "the evidence set was not run" in said


@pytest.mark.parametrize(("folder", "dies"), [("a b_c-d.e~F1", False), ("a#b", True), ("käfer", True)])
def test_what_crashes_pythonfmu_is_known(tmp_path, fmu_folder, folder, dies):
    """The folder for extraction is what the check takes for harmless, or not: then the process dies indeed."""
    (tmp_path / folder).mkdir()
    assert bool(inspection.crashing_characters(tmp_path / folder)) is dies
    command = [
        sys.executable,
        "-m",
        "tetherfmu.check.apart",
        "flown",
        str(fmu_folder / "TetherStraight.fmu"),
        str(tmp_path / "result.json"),
    ]
    environment = {**os.environ, "TMPDIR": str(tmp_path / folder)}
    quiet = dict.fromkeys(("stdout", "stderr"), subprocess.DEVNULL)
    with subprocess.Popen(command, env=environment, stdin=subprocess.PIPE, **quiet) as process:
        assert (process.wait() != 0) is dies


def test_an_fmu_in_a_folder_that_crashes_some_hosts(run, tmp_path, fmu_folder):
    copy = tmp_path / "it's a+käfer, [50%] (new)" / "TetherStraight.fmu"
    copy.parent.mkdir()
    status, said = run(shutil.copy(fmu_folder / "TetherStraight.fmu", copy))
    assert status == 0
    assert "a host that extracts the FMU beside itself will crash" in said
    assert "evidence set: 200 steps" in said


def test_missing_platforms(run, tmp_path):
    source = build("TetherStraight", tmp_path, BuildOptions(platforms=(this_platform(), "aarch64-linux")))
    assert f"platforms: aarch64-linux, {this_platform()}; this one is among them" in run(source)[1]  # those of the kernels
    no_library = changed(
        source, tmp_path / "a.fmu", lambda name, content: None if name.startswith("binaries/linux") else content
    )
    status, said = run(no_library)
    assert status == 1
    assert "has no library for linux64, only for none" in said
    assert f"build it with: tetherfmu build --platforms {this_platform()}" in said
    here = f"-{this_platform()}."
    no_kernels = changed(source, tmp_path / "b.fmu", lambda name, content: None if here in name else content)
    status, said = run(no_kernels)
    assert status == 1
    assert f"has no kernels for {this_platform()}, only for aarch64-linux\n" in said
    assert f"build it with: tetherfmu build --platforms {this_platform()}" in said
    assert "the evidence set was not run" in said


def test_a_library_for_another_processor(run, tmp_path, native_folder):
    """In the folder for this machine, as in an FMU for ARM Linux alone: where importers look."""
    foreign = changed(
        native_folder / "TetherStraight.fmu",
        tmp_path / "TetherStraight.fmu",
        lambda name, content: b"no code of this machine" if name.startswith("binaries/") else content,
    )
    status, said = run(foreign)
    assert status == 1
    assert "Failed to load shared library" in said
    assert "remedy: use an FMU for this processor and system" in said


def test_an_fmu_that_dies_is_a_finding(run, tmp_path, fmu_folder):
    def kill(name, content):
        return (
            content + b"\nimport ctypes\nctypes.string_at(0)\n"
            if re.match(r"resources/tether_straight\w+\.py", name)
            else content
        )

    status, said = run(changed(fmu_folder / "TetherStraight.fmu", tmp_path / "TetherStraight.fmu", kill))
    assert status == 1
    assert "the process that ran the FMU died" in said


def with_evidence(fmu_folder, tmp_path, ending, pattern, text):
    """A copy of TetherStraight.fmu with a change in a file of its evidence set."""

    def change(name, content):
        return (
            re.sub(pattern, text, content, count=1, flags=re.MULTILINE)
            if name.endswith(f"TetherStraight{ending}")
            else content
        )

    return changed(fmu_folder / "TetherStraight.fmu", tmp_path / "TetherStraight.fmu", change)


def test_a_deviation_from_the_reference(run, tmp_path, fmu_folder):
    status, said = run(with_evidence(fmu_folder, tmp_path, "_ref.csv", rb"^(5,[^,]*),[^,]*", rb"\1,0.0"))
    assert status == 1
    assert re.search(r"ground_force\[2\] .* TOO MUCH", said)
    assert said.count("TOO MUCH") == 1


def test_a_refused_step(run, tmp_path, fmu_folder):
    status, said = run(with_evidence(fmu_folder, tmp_path, "_in.csv", rb"^(5,)[^,]*", rb"\1nan"))
    assert status == 1
    assert "the run ended at 5 s instead of 10 s: a step was refused" in said


@pytest.mark.parametrize(
    ("ending", "pattern", "text"),
    [
        ("_ref.csv", rb"^5,[^,]*", b"5,many"),
        ("_ref.csv", rb"^5,[^,]*,", b"5,"),
        ("_ref.opt", rb"^AllowedDeviation.*\n", b""),
        ("_ref.opt", rb"^StepSize.*", b"StepSize"),
    ],
)
def test_an_evidence_set_that_cannot_be_read(run, tmp_path, fmu_folder, ending, pattern, text):
    status, said = run(with_evidence(fmu_folder, tmp_path, ending, pattern, text))
    assert status == 1
    assert "the evidence set cannot be read" in said


@pytest.mark.skipif(sys.platform != "linux", reason="libpython is a trouble of Linux")
def test_libpython_for_other_hosts(monkeypatch, tmp_path):
    library = tmp_path / "libpython3.99.so.1.0"
    values = {"INSTSONAME": library.name, "LIBDIR": str(tmp_path)}
    monkeypatch.setattr(sysconfig, "get_config_var", values.get)
    assert "install libpython" in inspection.hosts_that_are_not_python()[0].remedy
    library.touch()
    assert inspection.hosts_that_are_not_python()[0].remedy.endswith(f"LD_PRELOAD={library}")
    values["INSTSONAME"] = "libpython3.99.a"
    assert inspection.shared_python() is None


# --- FMUs that end, hold, or deceive the process that runs them: a line for each, and nothing runs on


LOOP = "while True: pass"
HOSTILE = {
    "ends with status 0": ("import os; os._exit(0)", "wrote no result: the FMU ended the process that ran it"),
    "ends with status 3": ("import os; os._exit(3)", "the run of the evidence set failed: exit code 3"),
    "kills itself": ("import os; os.kill(os.getpid(), 9)", "the process that ran the FMU died (exit code -9)"),
    "holds": (LOOP, "the run of the evidence set did not end within 1 s"),
    "fails": ("raise ValueError('of its own')", "the run of the evidence set failed: "),
    "says much": ("import sys, os; sys.stderr.write('a' * 10**8); os._exit(1)", "the run of the evidence set failed: "),
    "leaves a result": (
        "import sys, os; open(sys.argv[3], 'w').write('{}'); os._exit(0)",
        "the result of the evidence run cannot be read",
    ),
}


def with_slave(fmu_folder, target, line):
    """TetherStraight.fmu whose slave begins with a line of Python."""

    def change(name, content):
        is_launcher = name.startswith("resources/tether_straight_") and name.count("/") == 1
        return f"{line}\n".encode() + content if is_launcher else content

    return changed(fmu_folder / "TetherStraight.fmu", target, change)


def with_a_second(task, path, what):
    """`apart.apart` with one second for the FMU; FMPy's validation takes longer."""
    with pytest.MonkeyPatch.context() as limited:
        limited.setattr(apart, "LONGEST", 1 if task is apart.flown else apart.LONGEST)
        return apart.apart(task, path, what)


@pytest.mark.parametrize("kind", HOSTILE)
def test_a_line_for_each_fmu_whatever_it_does(kind, fmu_folder, tmp_path, monkeypatch, capsys):
    line, words = HOSTILE[kind]
    hostile = with_slave(fmu_folder, tmp_path / "hostile.fmu", line)
    if line is LOOP:
        monkeypatch.setattr(__main__, "apart", with_a_second)
    (tmp_path / "next.fmu").write_text("no archive")
    assert __main__.main([str(hostile), str(tmp_path / "next.fmu")]) == 1
    said = capsys.readouterr()
    assert (said.out.count("PROBLEM"), said.out.count(words)) == (2, 1), said.out
    assert "not a readable zip archive" in said.out
    assert "Traceback" not in said.out + said.err
    assert said.out.endswith("2 problems found\n")
    assert len(said.out) < 10_000 + apart.LAST_CHARACTERS


@pytest.mark.skipif(sys.platform != "linux", reason="looks at processes in /proc")
def test_nothing_runs_on_when_the_check_is_killed(fmu_folder, tmp_path):
    sign = tmp_path / "process"
    line = (
        f"import os, pathlib; pathlib.Path({str(sign)!r}).write_text(str(os.getpid())); {LOOP.removesuffix(': pass')}: pass"
    )
    hostile = with_slave(fmu_folder, tmp_path / "hostile.fmu", line.replace("; while", "\nwhile"))
    checking = subprocess.Popen([sys.executable, "-m", "tetherfmu.check", str(hostile)], stdout=subprocess.DEVNULL)
    while not (sign.exists() and sign.read_text()):
        assert checking.poll() is None
        time.sleep(0.05)
    checking.send_signal(signal.SIGKILL)
    checking.wait()
    status = Path(f"/proc/{sign.read_text()}/stat")
    for _ in range(200):
        if not status.exists() or ") Z " in status.read_text():
            return
        time.sleep(0.05)
    os.kill(int(sign.read_text()), signal.SIGKILL)
    pytest.fail("the process that ran the FMU runs on")
