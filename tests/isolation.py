"""Run code in a process of its own, so that a crash is a failed test and not a dead test run."""

import functools
import importlib
import multiprocessing
import traceback

TIMEOUT = 120.0  # seconds; no test takes longer than a few, compilation included


def _child(connection, module, name, arguments):
    try:
        function = getattr(importlib.import_module(module), name)
        connection.send((None, getattr(function, "__wrapped__", function)(**arguments)))
    except BaseException:
        connection.send((traceback.format_exc(), None))


def own_process(function, **arguments):
    """What a function of a module returns, called in a new process, which must also end cleanly."""
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_child, args=(sender, function.__module__, function.__name__, arguments))
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
