"""The C header beside a native FMU has its value references, choices and token, under names that C and C++ take."""

import math
import re
import subprocess

import pytest
from fmpy import read_model_description

from native import programs
from tetherfmu.commands import build as command
from tetherfmu.export.archive import SLAVES
from tetherfmu.export.build_options import BuildOptions, Purpose
from tetherfmu.export.native import native_fmus as native
from tetherfmu.export.native.host_header import PREFIX, c_name
from tetherfmu.files.lean import Lean

every_header = pytest.mark.parametrize(("fmi", "name"), [(fmi, name) for fmi in (2, 3) for name in SLAVES])


@pytest.fixture
def folder(request, fmi):
    return request.getfixturevalue({2: "native_folder", 3: "fmi3_folder"}[fmi])


def numbers_of(header):
    """Dict of the names in the enumerations of a header to their numbers."""
    found = re.findall(r"^    (\w+) = (\d+)", header.read_text("utf-8"), re.MULTILINE)
    assert len(dict(found)) == len(found)
    return {name: int(number) for name, number in found}


@every_header
def test_numbers_are_those_of_the_model_description(folder, fmi, name):
    """All of them, once each, and nothing else."""
    numbers = numbers_of(folder / f"{name}.h")
    description = read_model_description(str(folder / f"{name}.fmu"))
    for variable in description.modelVariables:
        assert numbers.pop(c_name(variable.name)) == variable.valueReference
        if variable.declaredType and variable.type == "Enumeration":
            for item in variable.declaredType.items:
                assert numbers.pop(f"{c_name(variable.name)}_{item.name.upper()}") == int(item.value)
    sizes = {}
    for variable in description.modelVariables:
        vector = variable.name.partition("[")[0]
        sizes[vector] = sizes.get(vector, 0) + math.prod(int(each.start) for each in variable.dimensions)
    wide = {f"{c_name(vector)}_SIZE": size for vector, size in sizes.items() if size > 1}
    assert numbers == wide
    assert wide["TETHER_SHAPE_SIZE"] == 63
    token = "INSTANTIATION_TOKEN" if fmi == 3 else "GUID"
    text = (folder / f"{name}.h").read_text("ascii")
    assert f'#define TETHER_{token} "{description.guid}"\n' in text
    assert f'#define TETHER_MODEL_IDENTIFIER "{description.coSimulation.modelIdentifier}"\n' in text


@pytest.mark.skipif(not programs.available(), reason="needs gcc on 64-bit Linux")
@every_header
@pytest.mark.parametrize("compiler", [("gcc", "-xc", "-std=c89"), ("g++", "-xc++", "-std=c++11")])
def test_compilers_take_it(folder, fmi, name, compiler):
    """Twice, by the strictest standards, and as value references of FMI."""
    code = f'#include "{name}.h"\n#include "{name}.h"\n#include "fmi{fmi}FunctionTypes.h"\n'
    code += f"extern const fmi{fmi}ValueReference all[];\n"
    references = ", ".join(name for name in numbers_of(folder / f"{name}.h"))
    code += f"const fmi{fmi}ValueReference all[] = {{{references}}};\n"
    places = (f"-I{folder}", f"-I{native.HEADERS}")
    line = [*compiler, "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only", *places, "-"]
    if fmi == 3 and compiler[0] == "gcc":
        line[2] = "-std=c99"  # FMI's own header needs it
    done = subprocess.run(line, input=code, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_equal_options_give_equal_bytes(native_folder, tmp_path):
    again = native.build("TetherStraight", tmp_path / "b", with_header=PREFIX).with_suffix(".h")
    headers = [native_folder / "TetherStraight.h", again]
    assert headers[0].read_bytes() == headers[1].read_bytes()
    other = native.build("TetherStraight", tmp_path / "c", BuildOptions(shape_points=0), with_header=PREFIX).with_suffix(
        ".h"
    )
    assert "SHAPE" not in re.sub("INITIAL_SHAPE", "", other.read_text("ascii"))
    assert numbers_of(other)["TETHER_SEGMENTS"] == numbers_of(headers[0])["TETHER_SEGMENTS"] - 63


def test_an_fmu_for_one_purpose(tmp_path):
    """Its header has its name, and what it has of variables."""
    purpose = Purpose("my-scene é", "For a test.", 0.02, 10.0, "<p>A page.</p>")
    made = native.build(
        "TetherStraight", tmp_path, BuildOptions(purpose=purpose, lean=Lean(outputs=("kite_force",))), with_header=PREFIX
    )
    header = made.with_suffix(".h")
    assert header.name == "TetherStraight_my-scene é.h"
    assert "#ifndef TETHER_TETHERSTRAIGHT_MY_SCENE___" in header.read_text("utf-8")
    assert "TETHER_SAG" not in numbers_of(header)


def test_command(tmp_path, capsys):
    """It is written when it is asked for, and named."""
    for options, files in (((), ["TetherStraight.fmu"]), (("--header",), ["TetherStraight.fmu", "TetherStraight.h"])):
        out = tmp_path / str(len(files))
        assert command.main(["straight", "--native", *options, "--out", str(out)]) == 0
        assert sorted(path.name for path in out.glob("TetherStraight.*")) == files
        assert (f"{out / 'TetherStraight.h'}  " in capsys.readouterr().out) == bool(options)


@pytest.mark.skipif(not programs.available(), reason="needs gcc on 64-bit Linux")
@pytest.mark.parametrize("prefix", ["LEAN_", PREFIX])
def test_headers_of_two_fmus_of_one_name_in_one_file(native_folder, tmp_path, prefix):
    """With names of their own they compile; with the same ones the compiler says which option gives others."""
    options = ["--outputs", "kite_force", "--header-prefix", prefix, "--out", str(tmp_path)]
    assert command.main(["straight", "--native", "--header", *options]) == 0
    code = f'#include "{native_folder}/TetherStraight.h"\n#include "{tmp_path}/TetherStraight.h"\n'
    code += f"int both[] = {{TETHER_KITE_FORCE_1, {prefix}KITE_FORCE_1}};\n"
    line = ["gcc", "-xc", "-std=c89", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only", "-"]
    done = subprocess.run(line, input=code, capture_output=True, text=True, check=False)
    assert (done.returncode == 0) == (prefix != PREFIX)
    assert ("build one of them with --header-prefix" in done.stderr) == (prefix == PREFIX)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ("--native --header-prefix A_", "it requires --header"),
        ("--native --header --header-prefix 9-", "'9-' cannot begin a name in C"),
    ],
)
def test_a_wrong_prefix(options, said, capsys):
    with pytest.raises(SystemExit):
        command.main(["straight", *options.split()])
    assert said in capsys.readouterr().err
