"""Run code in a process of its own, so that a crash is a failed test and not a dead test run.

Where the system can fork, the process is forked from one that has imported the packages and has loaded no FMU. It ends as
every Python process does: exit handlers, finalization of the interpreter, exit handlers of C. This and the loading of an FMU
take most of the time of a short test: tests of a file that have the same FMU can follow each other in one process
(`in_shared_process`).
"""

import contextlib
import ctypes
import functools
import gc
import importlib
import multiprocessing
import traceback
from pathlib import Path

from tetherfmu.export.archive import SLAVES

TIMEOUT = 900.0  # seconds, for what hangs; the slowest test takes some ten of them, compilation half a minute
FORKS = "forkserver" in multiprocessing.get_all_start_methods()
CONTEXT = multiprocessing.get_context("forkserver" if FORKS else "spawn")
if FORKS:
    CONTEXT.set_forkserver_preload(["fmpy", "hypothesis.stateful", "lxml.etree", "pytest", "tetherfmu.export.archive"])


def _child(connection):
    gc.freeze()  # what was imported before the fork need not be looked through when this process ends
    while call := connection.recv():
        module, name, arguments = call
        try:
            function = getattr(importlib.import_module(module), name)
            connection.send((None, getattr(function, "__wrapped__", function)(**arguments)))
        except BaseException:
            connection.send((traceback.format_exc(), None))
    if FORKS:
        ctypes.pythonapi.Py_Exit(0)  # what is forked would else end without finalizing anything


class _Process:
    """A new process that calls functions of modules, as often as it is asked to."""

    def __init__(self):
        self.connection, other = CONTEXT.Pipe()
        self.process = CONTEXT.Process(target=_child, args=(other,))
        self.process.start()
        other.close()

    def call(self, function, arguments):
        """What the function returns; a process that hangs or dies is no more."""
        try:
            self.connection.send((function.__module__, function.__name__, arguments))
            problem, result = self.connection.recv() if self.connection.poll(TIMEOUT) else ("the process hangs", None)
        except (EOFError, OSError):
            problem, result = "the process died", None
        if problem == "the process hangs":
            self.process.kill()
        assert problem is None, problem
        return result

    def end(self):
        """Let the process end, as it must: cleanly. Returns its exit code."""
        with contextlib.suppress(OSError):
            self.connection.send(None)
        self.process.join(TIMEOUT)
        if self.process.is_alive():
            self.process.kill()
            self.process.join()
        return self.process.exitcode


def own_process(function, **arguments):
    """What a function of a module returns, called in a new process, which must also end cleanly."""
    process = _Process()
    try:
        result = process.call(function, arguments)
    finally:
        code = process.end()
    assert code == 0, f"the process ended with exit code {code}"
    return result


def in_own_process(function):
    """Decorate a test: its body runs in a new process, which must also end cleanly."""

    @functools.wraps(function)
    def test(**arguments):
        own_process(function, **arguments)

    return test


_shared = {}  # processes of the file whose tests run now, by the FMU that they have


def in_shared_process(function):
    """As `in_own_process`, for a test that may follow others: those of a file that have the same FMU share a process.

    A test that fails ends it, and the next one gets a new process. `end_shared` asks whether the others ended cleanly.
    """

    @functools.wraps(function)
    def test(**arguments):
        fmu = tuple(str(each) for each in arguments.values() if isinstance(each, Path) or each in tuple(SLAVES))
        process = _shared.pop(fmu, None) or _Process()
        try:
            process.call(function, arguments)
        except BaseException:
            process.end()
            raise
        _shared[fmu] = process

    return test


def end_shared():
    """End the processes of a file after its last test; all must end cleanly."""
    codes = {fmu: process.end() for fmu, process in _shared.items()}
    _shared.clear()
    failed = {fmu: code for fmu, code in codes.items() if code != 0}
    assert not failed, f"processes of this file ended with exit codes: {failed}"
