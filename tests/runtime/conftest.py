"""The C host, for all tests that need it."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from runtime.clients import python_library
from tetherfmu.runtime.kernel_library import this_platform


def compile_c(source, target, *options):
    """Compile a C file, with Zig's compiler, which the builder needs anyway, where gcc is missing: it is slow at first."""
    zig = (sys.executable, "-m", "ziglang", "cc", "-target", "x86_64-linux-gnu.2.17")
    command = [*(("gcc",) if shutil.which("gcc") else zig), "-O1", "-Wall", "-Wextra", "-Werror"]
    subprocess.run([*command, "-o", str(target), str(Path(__file__).parent / source), *options], check=True)
    return target


def _only_linux():
    if this_platform() != "x86_64-linux":
        pytest.skip("for 64-bit Linux")


@pytest.fixture(scope="session")
def c_host_program(built_once):
    """Path of the compiled `c_host.c`."""
    _only_linux()
    if python_library() is None:
        pytest.skip("this Python has no shared library; a host that is not Python needs one")
    return built_once("c_host", lambda folder: compile_c("c_host.c", folder / "c_host", "-ldl", "-lpthread")) / "c_host"


@pytest.fixture(scope="session")
def poison(built_once):
    """Path of the compiled `poison.c`, to be preloaded."""
    _only_linux()
    return built_once("poison", lambda folder: compile_c("poison.c", folder / "poison.so", "-shared", "-fPIC")) / "poison.so"
