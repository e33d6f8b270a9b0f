"""Shared fixtures, and what is compiled once for all workers of a run."""

import gc
import os
import sys
import tempfile
import time
from functools import partial
from pathlib import Path
from zlib import crc32

import pytest
from xdist.scheduler import LoadScopeScheduling

HERE = Path(__file__).resolve().parent
EXAMPLES = HERE.parent / "examples"
sys.path[:0] = [str(HERE), str(HERE.parent / "docs" / "make")]
sys.path += [str(HERE / "benchmarks"), str(EXAMPLES), str(EXAMPLES / "tutorial")]
gc.disable()  # until all tests are collected
# FMUs that commands and examples keep for the user are kept for a run, not in the home of whoever runs it
KEPT = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
os.environ.setdefault("XDG_CACHE_HOME", KEPT.name)
# a worker has one core; threads of numpy's linear algebra would wait for each other, with up to 40 times the processor time
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

NOT_RELEASED = "not release"  # the marks of a run, by pyproject.toml, without what only a release has
LONGEST_BUILD = 1800.0  # seconds, for what hangs; a cold build takes half a minute on an idle machine


def compile_all(for_release):
    """Compile the kernels for this platform, or all that a release has; returns at once if they are there."""
    from tetherfmu.libraries import ready
    from tetherfmu.libraries.webassembly import with_libraries
    from tetherfmu.runtime.kernel_library import this_platform

    if for_release:
        with_libraries()
    ready.folders(ready.LIBRARIES, [this_platform()])


def pytest_configure(config):
    """Compile before the workers of a whole run start, or each would do it; a run of some tests compiles what they need."""
    whole = config.args_source is config.ArgsSource.TESTPATHS and not config.option.collectonly
    if whole and not hasattr(config, "workerinput"):
        try:
            compile_all(config.option.markexpr != NOT_RELEASED)
        except RuntimeError as error:
            pytest.exit(str(error), returncode=1)


def pytest_xdist_auto_num_workers():
    """Workers of a run: one more than there are cores, as each waits for processes during a quarter of its time."""
    return (os.cpu_count() or 1) + 1


SHARING = {  # tests that use what one process makes once: folder or file, and the name of the group
    "tests/kernels/": "compiled just in time",
    "tests/libraries/test_same_bits.py": "compiled just in time",
    "tests/physics/test_energy_balance.py": "compiled just in time",
    "tests/physics/test_node_winds.py": "compiled just in time",
    "tests/docs/make/test_benchmark_runs.py": "compiled just in time",
    "tests/libraries/test_webassembly.py": "compiled for browsers",
    "tests/web/": "compiled for browsers",
    "tests/runtime/test_c_host.py": "flown by FMPy",
    "tests/runtime/test_clients.py": "flown by FMPy",
}


# begin first, or one worker waits for the other at the end
LONG = ("tests/kernels/", "tests/libraries/test_", "tests/web/", "tests/study/measuring/test_cluster.py")


class ByFile(LoadScopeScheduling):
    """Lets one worker run all tests of a file, or of a group of files, so that what they share is made once.

    The marks of xdist for groups would do, but xdist 3.8 does not see them where pytest is 9.2.
    """

    def _split_scope(self, nodeid):
        file = nodeid.partition("::")[0]
        return next((group for place, group in SHARING.items() if file.startswith(place)), file)


def pytest_xdist_make_scheduler(config, log):
    """The scheduler of this run."""
    return ByFile(config, log)


def pytest_collection_modifyitems(items):
    """Kernels that are compiled just in time are not optimized: that takes longer than to run them, and changes no bit."""
    from numba.core import config

    from coarse_figures import draw_coarsely

    config.OPT = config._OptLevel("0")
    parse_a_name_once()
    draw_coarsely()
    items.sort(key=lambda item: not item.nodeid.startswith(LONG))


def parse_a_name_once():
    """FMPy's validation parses the name of each variable with a grammar, in some ms; most FMUs have the same names."""
    from lark import Lark

    parse, known = Lark.parse, {}

    def parsed(self, text, *more, **options):
        key = (self.source_grammar, text)
        if more or options:
            return parse(self, text, *more, **options)
        if key not in known:
            known[key] = parse(self, text)  # a wrong name raises each time
        return known[key]

    Lark.parse = parsed


@pytest.hookimpl(trylast=True)
def pytest_runtest_teardown(item, nextitem):
    """The tests of a file may share processes, until the last one of them."""
    from isolation import end_shared

    if nextitem is None or nextitem.path != item.path:
        end_shared()


def pytest_collection_finish():
    """What was imported and collected stays: it need not be looked through each time when memory is freed."""
    gc.freeze()
    gc.enable()


@pytest.fixture(scope="session")
def fmu_folder(built_once, request):
    """Folder with all FMUs of a flavour (`runtime.host.every_flavour`), built once; without one, of PythonFMU's."""
    return folder_of(built_once, getattr(request, "param", "pythonfmu"))


@pytest.fixture(scope="session")
def native_folder(built_once):
    """Folder with all native FMUs for FMI 2."""
    return folder_of(built_once, "native")


@pytest.fixture(scope="session")
def fmi3_folder(built_once):
    """Folder with all native FMUs for FMI 3."""
    return folder_of(built_once, "native_fmi3")


def folder_of(built_once, flavour):
    """Folder with all FMUs of one of `flavours.FLAVOURS`."""
    import flavours

    return flavours.folder_of(built_once, flavour)


@pytest.fixture(scope="session")
def windy(built_once):
    """Folder with a folder for each flavour of FMUs with wind points: of a tether without nodes, and of one with them."""
    from flavours import FLAVOURS, WIND_POINTS, build_by_command

    def build(folder):
        for flavour in FLAVOURS:
            options = ["TetherStraight", "TetherDynamicFree", "--wind-points", str(WIND_POINTS)]
            build_by_command(folder / flavour, flavour, *options)

    return built_once("fmus_with_wind_points", build)


@pytest.fixture(scope="session")
def built(built_once):
    """Function of the text of a file, a flavour, a number of wind points: path of the FMU of this system."""
    from flavours import build_system

    def fmu_of(text, flavour="pythonfmu", wind_points=0, with_evidence=False):
        name = f"system_{crc32(text.encode()):x}_{flavour}_{wind_points}_{with_evidence:d}"
        make = partial(build_system, flavour=flavour, text=text, wind_points=wind_points, with_evidence=with_evidence)
        return next(built_once(name, make).glob("*.fmu"))

    return fmu_of


@pytest.fixture(scope="session")
def example_folder(built_once):
    """Folder with all FMUs of the examples."""
    from runtime.host import extract_all
    from tetherfmu.libraries.examples import example

    def build(folder):
        fmus = example("shared.example_fmus")
        for name in fmus.SLAVES:
            fmus.build(name, folder)
        extract_all(folder)

    return built_once("example_fmus", build)


@pytest.fixture(scope="session")
def dist(fmu_folder, example_folder, tmp_path_factory):
    """Folder of this name with the FMUs of both kinds, where examples look for them from the folder above."""
    place = tmp_path_factory.mktemp("both") / "dist"
    place.mkdir()
    for each in (*fmu_folder.glob("*.fmu"), *example_folder.glob("*.fmu")):
        (place / each.name).symlink_to(each)
    return place


@pytest.fixture(scope="session")
def built_once(tmp_path_factory):
    """Function of (name, make): a folder that all workers share, which make(folder) fills in the first one that asks."""
    shared = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        shared = shared.parent

    def once(name, make):
        folder, finished = shared / name, shared / f"{name}.finished"
        try:
            folder.mkdir()
        except FileExistsError:
            deadline = time.monotonic() + LONGEST_BUILD
            while not finished.exists():
                assert time.monotonic() < deadline, f"another worker has not finished {folder}"
                time.sleep(0.1)
        else:
            try:
                make(folder)
            finally:
                finished.touch()  # also after a failure, which the other workers see by what is missing
        return folder

    return once
