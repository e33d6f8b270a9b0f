"""Modules of LLVM: all functions of a library in one, optimized, for a target, without any need but mathematics."""

import re
from typing import NamedTuple

from tetherfmu.libraries.linking import MATHEMATICS, MEMORY


class Target(NamedTuple):
    """LLVM's name of a platform, and its baseline processor, so that the library runs on all processors."""

    triple: str
    cpu: str


ANY = Target("x86_64-unknown-linux-gnu", "x86-64")  # the first round of optimizing is for it, whatever the target

# Kernels that keep a stack frame of their own, by numba's names: beyond 4096 bytes, the frame of a function that takes them
# in would need a function of the C library on Windows. Two that are faster alone, by 1 to 2 % and 3 to 7 % of a step. And
# large ones that are called from several places: of lines with ropes, of the ground, of each communication step
APART = (
    *("rosenbrock4form", "assembly11node_forces", "step_control13error_of_step"),
    *("strand10sum_forces", "strand11loop_of_end", "strand17take_gain_columns", "strand4form", "strand15right_hand_side"),
    *("net18find_accelerations", "states8evaluate", "events4stop", "fixed9take_rope"),
    *(
        "contact4find",
        "contact6corner",
        "contact13add_to_column",
        "contact10add_to_row",
    ),
    *("boundary14inputs_of_step", "transaction5begin"),
)

# Rooms and modules of kernels that do not lie in the loop of a step, only call it or gain little: their code is kept short,
# so that it calls long kernels instead of taking them in. A loop over a tuple must not be among them: only once it is
# unrolled, LLVM sees that its index is in range
RARE = (
    "rest",
    "line11drum_events",
    "variants11rope_shares",
    "variants12winch_start",
    "variants12first_shares",
    "step8breaking",
    "packing",
    "motion6breaks",
    "motion6events",
    "motion6states",
    "motion7turning",
    "motion8fallback",
    "points5fixed",
    "points11coordinates",
    "step12plausibility",
    "step13power_balance",
)
IN_A_BROWSER = "motion11fixed_steps", "points7descent", "points5guess", "points3net"  # short too where they are downloaded


def whole_module(code, short=RARE):
    """A module of all functions without unreachable code; a second round alone would leave some Python code in it.

    short : names as in `RARE` of the kernels whose code is kept short.
    """
    linked = _linked(code, short)
    optimize(linked, machine_of(ANY), level=1)
    return linked


def _linked(code, short):
    """One LLVM module of all functions, with nothing but the entry points exported, and names by place."""
    linked = as_one_module(code.texts)
    for name, exported in code.names.items():
        linked.get_function(name).name = exported
    for function in linked.functions:
        if any(name in function.name for name in APART):
            function.add_function_attribute("noinline")
        if re.match(rf"_ZN9tetherfmu7kernels\d+({'|'.join(short)})", function.name):  # by numba's name
            function.add_function_attribute("optsize")
    # numba's names contain counters and addresses
    for place, item in enumerate([*linked.global_variables, *linked.functions]):
        if not item.is_declaration and item.name not in code.names.values():
            item.linkage = "internal"
            item.name = f"kernel.{place}"
        elif item.name.startswith("numba.dynamic.globals"):
            item.name = f"python.{place}"
    return linked


def as_one_module(texts):
    """One LLVM module of the texts of several: two at a time, as LLVM looks through all of a module that it links to."""
    import llvmlite.binding as llvm

    modules = list(map(llvm.parse_assembly, texts))
    while len(modules) > 1:
        for module, next_one in zip(modules[::2], modules[1::2], strict=False):
            module.link_in(next_one)
        modules = modules[::2]
    return modules[0]


def machine_of(target, **more):
    """LLVM's machine of a target; more : other options of it."""
    import llvmlite.binding as llvm

    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    found = llvm.Target.from_triple(target.triple)
    return found.create_target_machine(cpu=target.cpu, opt=3, **{"reloc": "pic", "codemodel": "small"} | more)


def for_target(text, target, machine):
    """A module from intermediate code, for another target than the one it was written for."""
    import llvmlite.binding as llvm

    text = re.sub(r"^target triple = .*$", f'target triple = "{target.triple}"', text, flags=re.MULTILINE)
    text = re.sub(r"^target datalayout = .*$", f'target datalayout = "{machine.target_data}"', text, flags=re.MULTILINE)
    if not target.triple.startswith("x86"):
        text = re.sub(r'"target-(cpu|features)"="[^"]*"', "", text)
    return llvm.parse_assembly(text)


def optimize(module, machine, level):
    """Run LLVM's passes of a level, without those that merge two statements into one instruction.

    The numbers of a merged instruction wait for each other: it makes fixed steps a sixth slower.
    """
    import llvmlite.binding as llvm

    tuning = llvm.create_pipeline_tuning_options(speed_level=level)
    tuning.slp_vectorization = False
    builder = llvm.create_pass_builder(machine, tuning)
    builder.getModulePassManager().run(module, builder)


def check_names(module, exported):
    """RuntimeError if a module needs more than the mathematical library, memset and memcpy."""
    items = [*module.functions, *module.global_variables]
    needed = {item.name for item in items if item.is_declaration and not item.name.startswith("llvm.")}
    surplus = needed - {*MATHEMATICS, *MEMORY}
    if surplus:
        raise RuntimeError(f"the kernels {', '.join(exported)} need {sorted(surplus)}: see compilation.py")
