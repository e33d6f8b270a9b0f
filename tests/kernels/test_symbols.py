"""The compiled entry points stand alone: they reference nothing but the mathematical library, memset and memcpy."""

import subprocess
import sys

import pytest

ALLOWED = {"memset", "memcpy", "sqrt", "exp", "log", "log1p", "pow", "asinh", "sinh", "atan2", "ceil", "sin", "cos"}
PROGRAM = """
import llvmlite.binding as llvm
from tetherfmu.kernels import entry_points
from tetherfmu.kernels.compilation import compile_entry_point

llvm.initialize_all_targets()
llvm.initialize_all_asmprinters()
function = compile_entry_point(getattr(entry_points, "{name}"), on_disk=False)
machine = llvm.Target.from_triple("x86_64-unknown-linux-gnu").create_target_machine(cpu="x86-64", opt=3, reloc="pic")
module = llvm.parse_assembly(function._library.get_llvm_str())
entry_name = function._wrapper_name
for item in list(module.functions) + list(module.global_variables):
    if not item.is_declaration and item.name != entry_name:
        item.linkage = "internal"
builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=3))
builder.getModulePassManager().run(module, builder)
for item in list(module.functions) + list(module.global_variables):
    if item.is_declaration and not item.name.startswith("llvm."):
        print(item.name)
"""


@pytest.mark.parametrize("name", ["dynamic_initialize", "dynamic_advance", "dynamic_observe"])
def test_entry_point_needs_the_mathematical_library_only(name):
    done = subprocess.run([sys.executable, "-c", PROGRAM.format(name=name)], capture_output=True, text=True, check=True)
    assert set(done.stdout.split()) <= ALLOWED
