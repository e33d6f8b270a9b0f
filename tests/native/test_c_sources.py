"""The C sources of a native FMU: compiled by an importer they are the FMU itself.

`tests/benchmarks/c_sources.py` does this for all tethers, with FMPy and with several options of the compiler.
"""

import re
import subprocess
from pathlib import Path
from xml.etree import ElementTree

import pytest

from isolation import own_process
from libraries.test_symbols import dynamic_symbols
from native import as_importers_do as importer
from native.test_platforms import C_LIBRARY
from runtime import clients
from runtime.host import Host, extract_all
from shared_drums import SHARED
from tetherfmu.export import system_fmus
from tetherfmu.export.build_options import BuildOptions
from tetherfmu.export.native import native_fmus as native
from tetherfmu.export.native import source_folder as native_sources
from tetherfmu.export.native.c_tables import most_room
from tetherfmu.files.lean import Lean

pytestmark = pytest.mark.skipif(not importer.available(), reason="there is no gcc")
NAME = "TetherStraight"
QUICK = ("-Wno-misleading-indentation",)  # which takes gcc longer than all else; a tether's kernels are indented alike
EXAMPLES = Path(__file__).parents[2] / "examples" / "systems"
IN_C = {"copysign", "fabs", "trunc", "ceil", "sqrt", "floor", "fmax", "memmove"}  # what compilers need no function for
PROGRAM = r"""
#include <stdlib.h>
static int taken;
static void *counted(size_t count, size_t size)
{
    taken++;
    return calloc(count, size);
}
#define calloc counted
#include "fmu.c"

static void ignored(void *environment, fmi2String name, fmi2Status status, fmi2String category, fmi2String text, ...)
{
    (void)environment, (void)name, (void)status, (void)category, (void)text;
}

int main(void)
{
    fmi2CallbackFunctions functions = {ignored, NULL, NULL, NULL, NULL};
    fmi2Component c = fmi2Instantiate("a", fmi2CoSimulation, TOKEN, "", &functions, fmi2False, fmi2True);
    int at_first = taken;
    fmi2ValueReference kite = AT_KITE_POSITION, force = OUTPUTS_AT + AT_KITE_FORCE;
    fmi2Real taut = 320.0, one = 1.0, change = 0.0;
    if (!c || fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0) || fmi2EnterInitializationMode(c)) return 1;
    if (fmi2SetReal(c, &kite, 1, &taut) || fmi2GetReal(c, &force, 1, &change) || fmi2ExitInitializationMode(c)) return 2;
    for (int k = 0; k < 5; k++)
        if (fmi2DoStep(c, 0.1 * k, 0.1, fmi2True)) return 3;
    if (fmi2GetDirectionalDerivative(c, &force, 1, &kite, 1, &one, &change) || !(change > 0.0 || change < 0.0)) return 4;
    if (fmi2DoStep(c, 0.5, -0.1, fmi2True) != fmi2Error || fmi2Reset(c)) return 5;
    if (fmi2EnterInitializationMode(c) || fmi2ExitInitializationMode(c)) return 6;
    if (taken != at_first) return 7;
    fmi2FreeInstance(c);
    return 0;
}
"""


@pytest.fixture(scope="module")
def fmus(tmp_path_factory):
    """An FMU with sources for each version of FMI."""
    folder = tmp_path_factory.mktemp("sources")
    return {fmi: native.build(NAME, folder / str(fmi), fmi=fmi, with_sources=True) for fmi in (2, 3)}


def test_the_numbers_of_the_native_fmu(fmus, tmp_path):
    """To the last bit; nothing but the C library is needed, and nothing but FMI is offered."""
    library = importer.compiled(fmus[3], tmp_path)
    needed, offered = dynamic_symbols(library)
    assert {name for name in needed if not name.startswith("_")} <= C_LIBRARY | IN_C
    assert offered == set(native.functions_of(3))
    other = importer.with_library(fmus[3], library, tmp_path, 3)
    found, expected = (own_process(importer.evidence_run, path=path) for path in (other, fmus[3]))
    assert clients.different(found, expected) == []


# drums over sheaves, one of which starts in balance, and beside them a bridle
SYSTEM = SHARED.replace("winch_mass = 8", 'winch_mass = 8\nwinch_start = "equilibrium"\nreel_out_speed = 0.05')
SYSTEM += (EXAMPLES / "y_bridle.toml").read_text(encoding="utf-8").partition("\n\n")[2]


def given(k):
    """What is given to its FMU in step k."""
    drums = {"steering.winch_force": 200.0 + 10.0 * k, "power.winch_force": 300.0 - 5.0 * k}
    return drums | {"main.reel_out_speed": 0.1 * k, "wind_velocity": (5.0, 0.1 * k, 0.0)}


def test_the_numbers_of_the_native_fmu_of_a_system(tmp_path, monkeypatch):
    """To the last bit, with adaptive and fixed steps, other functions to call and a plan that is made at the start."""
    monkeypatch.setattr(system_fmus, "_evidence_of", lambda *given: {})  # flights that take longer than all else
    (tmp_path / "native").mkdir()
    (tmp_path / "system.toml").write_text(SYSTEM, encoding="utf-8")
    path = system_fmus.build(tmp_path / "system.toml", tmp_path / "native", native=2, with_sources=True)
    other = importer.with_library(path, importer.compiled(path, tmp_path, QUICK), tmp_path, 2)
    for each in (path, other):
        extract_all(each.parent)
    for fixed_step in (0.0, 0.005):
        found, expected = (own_process(flown, path=each, fixed_step=fixed_step) for each in (other, path))
        assert found == expected
        assert found[0] != found[-1]
    found, expected = (own_process(derivatives_of_bridle, path=each) for each in (other, path))
    assert found == expected
    assert all(found)


def flown(path, fixed_step):
    """All outputs at the start and after each step."""
    host = Host(path).start(fixed_step=fixed_step)
    rows = [host.all_outputs()]
    for k in range(10):
        host.step(0.02, **given(k))
        rows.append(host.all_outputs())
    return rows


def derivatives_of_bridle(path):
    """Of the tension at the ground by its position after a step: steps done again, in arrays of a trial."""
    host = Host(path).start()
    host.step(0.02)
    output, inputs = [host.reference["main.tension_from"]], [host.reference[f"ground.position[{i}]"] for i in (1, 3)]
    return [host.fmu.getDirectionalDerivative(output, [each], [1.0])[0] for each in inputs]


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_files_are_announced(fmus, fmi, tmp_path):
    sources = importer.unpacked(fmus[fmi], tmp_path)
    description = sources / "buildDescription.xml" if fmi == 3 else sources.parent / "modelDescription.xml"
    names = [each.get("name") for each in ElementTree.parse(description).iter("SourceFile" if fmi == 3 else "File")]
    assert names == [native_sources.FILE]


def test_nothing_is_allocated_after_instantiation(fmus, tmp_path):
    """From the start over steps, derivatives, a refused step and a reset to the next start; a sanitizer finds nothing.

    With a prefix all names that a linker sees are the own ones of the FMU, so that several can be in one program.
    """
    sources = importer.unpacked(fmus[2], tmp_path)
    (sources / "program.c").write_text(PROGRAM)
    prefix = f"-DFMI2_FUNCTION_PREFIX={NAME}_"
    importer.run(["gcc", "-std=c99", "-fsanitize=undefined", prefix, "-c", "program.c", "-o", "program.o"], sources)
    command = ["nm", "-g", "--defined-only", "program.o"]
    listed = subprocess.run(command, cwd=sources, capture_output=True, text=True, check=True)
    names = {line.split()[-1] for line in listed.stdout.splitlines()} - {"main"}
    assert {f"{NAME}_{name}" for name in native.functions_of(2)} < names
    assert all(name.startswith(f"{NAME}_") for name in names)
    importer.run(["gcc", "-fsanitize=undefined", "program.o", "-o", "program", "-lm"], sources)
    importer.run(["./program"], sources)


@pytest.mark.parametrize("sizes", [[1, 3, 4, 8, 9], [5, 5, 5], [7]])
def test_room_is_enough_for_any_number_of_segments(sizes):
    """And not much more than that."""
    halves = [size // 2 for size in sizes]
    bounds = re.findall(r"\((\d+) \+ (\d+) \* \(size_t\)", most_room(halves, sizes))
    for (base, slope), wanted in zip(bounds, (halves, sizes), strict=True):
        spare = [int(base) + int(slope) * n - needed for n, needed in enumerate(wanted, 1)]
        assert min(spare) == 0


BOTH = """
extern const char *{0}_fmi2GetVersion(void), *{1}_fmi2GetVersion(void);
int main(void) {{ return {0}_fmi2GetVersion()[0] != '2' || {1}_fmi2GetVersion()[0] != '2'; }}
"""


def test_two_fmus_of_one_name_in_one_program(fmus, tmp_path):
    """The full and a lean one, each with a prefix of its own."""
    lean = native.build(NAME, tmp_path, BuildOptions(lean=Lean(outputs=("kite_force",))), with_sources=True)
    objects = []
    for prefix, path in (("full", fmus[2]), ("lean", lean)):
        objects.append(str(tmp_path / f"{prefix}.o"))
        sources = importer.unpacked(path, tmp_path / prefix)
        importer.run(["gcc", "-std=c99", f"-DFMI2_FUNCTION_PREFIX={prefix}_", "-c", "fmu.c", "-o", objects[-1]], sources)
    (tmp_path / "program.c").write_text(BOTH.format("full", "lean"))
    importer.run(["gcc", "program.c", *objects, "-o", "program", "-lm"], tmp_path)
    importer.run(["./program"], tmp_path)
