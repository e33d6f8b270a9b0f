"""Libraries are found, or compiled when they are missing."""

import subprocess
import sys
import tomllib
from importlib.metadata import PackageNotFoundError

import pytest

from tetherfmu.libraries import ready
from tetherfmu.runtime.kernel_library import file_name, this_platform

HERE = (this_platform(),)
OTHER = next(platform for platform in ("aarch64-linux", "x86_64-linux") if platform not in HERE)


@pytest.fixture(scope="session")
def compiled():
    """Folder of the straight tether."""
    return ready.folders(["straight"], HERE)["straight"]


def test_equal_sources_give_equal_bytes_whatever_was_compiled_together(tmp_path, capfd, monkeypatch):
    """And it is said what is compiled, how long it took, and what is not yet; other platforms follow without numba."""
    alone = ready.compiled_in(tmp_path, ["straight"], HERE)["straight"]
    first, *_, second, third = capfd.readouterr().err.splitlines()  # on a slow machine with lines of progress
    assert first == f"compiling kernels for {this_platform()}, once: straight"
    assert second.startswith("  straight after ")
    others = "catenary, quasi_steady, dynamic, systems of tethers, tetherfmu web"
    assert third == f"not yet compiled; each will be compiled at its first use: {others}"
    with monkeypatch.context() as broken:
        broken.setitem(ready.FOR_NUMBA, "NUMBA_DISABLE_JIT", "1")  # see `test_what_the_compiler_says_is_told`
        ready.compiled_in(tmp_path, ["straight"], [*HERE, OTHER])
    assert capfd.readouterr().err.startswith(f"compiling kernels for {OTHER}, once: straight\n")
    together = ready.folders(["straight"], [*HERE, OTHER])["straight"]
    for name in (file_name("straight", platform) for platform in (*HERE, OTHER)):
        assert (alone / name).read_bytes() == (together / name).read_bytes()


def test_what_is_there_is_not_compiled_again(compiled, capfd):
    assert ready.compiled_in(compiled.parent, ["straight"], HERE) == {"straight": compiled}
    assert capfd.readouterr().err == ""


def test_an_unknown_platform_is_named_with_those_that_are_known():
    with pytest.raises(RuntimeError, match="cannot be compiled for riscv64-linux, only for x86_64-linux, "):
        ready.folders(["straight"], ["x86_64-linux", "riscv64-linux"])


def test_what_the_compiler_says_is_told(tmp_path, monkeypatch):
    monkeypatch.setitem(ready.FOR_NUMBA, "NUMBA_DISABLE_JIT", "1")
    with pytest.raises(RuntimeError, match="compiling the kernels failed: "):
        ready.compiled_in(tmp_path, ["straight"], HERE)
    assert not list(tmp_path.rglob("*straight-*"))


def test_the_libraries_of_the_wheel_come_first(compiled, monkeypatch):
    monkeypatch.setattr(ready, "IN_WHEEL", compiled.parent)
    monkeypatch.setattr(ready, "version", lambda package: pytest.fail("what compiles was looked for"))
    assert ready.folders(["straight"], HERE) == {"straight": compiled}


def test_a_missing_compiler_is_named_with_the_remedy(monkeypatch):
    def missing(package):
        raise PackageNotFoundError(package)

    monkeypatch.setattr(ready, "version", missing)
    with pytest.raises(RuntimeError, match=r'llvmlite, .* is not installed; .* pip install "tetherfmu\[build\]"'):
        ready.folders(["straight"], HERE)


FIRST, LAST = ready.TESTED


@pytest.mark.parametrize("numba", ["99.1.0rc1", f"{FIRST[0]}.{FIRST[1] - 1}.1", f"{LAST[0]}.{LAST[1] + 1}.0"])
def test_an_unknown_numba_is_refused(tmp_path, monkeypatch, numba):
    monkeypatch.setattr(ready, "version", lambda package: numba)
    only = "{}.{} to {}.{}".format(*FIRST, *LAST)
    with pytest.raises(RuntimeError, match=rf'numba {numba} cannot compile them, only {only}; .* "tetherfmu\[build\]"'):
        ready.compiled_in(tmp_path, ["straight"], HERE)


def test_the_extra_has_the_versions_of_numba_that_are_tested():
    project = tomllib.loads((ready.PACKAGE.parents[1] / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert f"numba>={FIRST[0]}.{FIRST[1]},<{LAST[0]}.{LAST[1] + 1}" in project["optional-dependencies"]["build"]


def test_flying_compiles_nothing_and_needs_no_compiler():
    """The Python API, with all that compiles forbidden."""
    code = """
import sys
sys.modules |= dict.fromkeys(("numba", "llvmlite", "ziglang", "scipy"))
import tetherfmu
for variant in ("Straight", "Catenary", "QuasiSteady", "Dynamic"):
    tether = getattr(tetherfmu, f"Tether{variant}")()
    tether.initialize()
    print(tether.step(0.02).kite_tension)
print(tether.energy().elastic)
"""
    ready.folders(["straight", "catenary", "quasi_steady", "dynamic"], HERE)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert all(float(line) > 0.0 for line in done.stdout.splitlines())


def test_files_in_the_folder_of_the_user_are_not_taken_for_modules_of_python(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "gzip.py").write_text("raise ImportError('a file of the user')")
    ready.run("ahead_of_time", [this_platform()], tmp_path / "libraries")
