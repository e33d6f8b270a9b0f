"""Run code in a process of its own, so that a crash is a failed test and not a dead test run.

Where the system can fork, the process is forked from one that has imported the packages and has loaded no FMU. It ends as
every Python process does: exit handlers, finalization of the interpreter, exit handlers of C.
"""

import ctypes
import functools
import gc
import importlib
import multiprocessing
import traceback

TIMEOUT = 900.0  # seconds, for what hangs; the slowest test takes some ten of them, compilation half a minute
FORKS = "forkserver" in multiprocessing.get_all_start_methods()
CONTEXT = multiprocessing.get_context("forkserver" if FORKS else "spawn")
if FORKS:
    CONTEXT.set_forkserver_preload(["fmpy", "hypothesis.stateful", "lxml.etree", "pytest", "tetherfmu.export.archive"])


def _child(connection, module, name, arguments):
    gc.freeze()  # what was imported before the fork need not be looked through when this process ends
    try:
        function = getattr(importlib.import_module(module), name)
        connection.send((None, getattr(function, "__wrapped__", function)(**arguments)))
    except BaseException:
        connection.send((traceback.format_exc(), None))
    if FORKS:
        ctypes.pythonapi.Py_Exit(0)  # what is forked would else end without finalizing anything


def own_process(function, **arguments):
    """What a function of a module returns, called in a new process, which must also end cleanly."""
    receiver, sender = CONTEXT.Pipe(duplex=False)
    process = CONTEXT.Process(target=_child, args=(sender, function.__module__, function.__name__, arguments))
    process.start()
    sender.close()
    try:
        problem, result = receiver.recv() if receiver.poll(TIMEOUT) else ("the process hangs", None)
    except EOFError:
        problem = "the process died"
    process.join(TIMEOUT if problem != "the process hangs" else 0.0)
    if process.is_alive():
        process.kill()
        process.join()
    assert problem is None, problem
    assert process.exitcode == 0, f"the process ended with exit code {process.exitcode}"
    return result


def in_own_process(function):
    """Decorate a test: its body runs in a new process, which must also end cleanly."""

    @functools.wraps(function)
    def test(**arguments):
        own_process(function, **arguments)

    return test
