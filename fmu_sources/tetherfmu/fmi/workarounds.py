"""Workarounds for PythonFMU's library (docs/contributors/fmus.md): lost references, the end of a process."""

import ctypes
import os
import sys
from contextlib import suppress
from functools import lru_cache
from pathlib import Path


def hold(*objects):
    """Increment the reference count of each object permanently: PythonFMU's library releases one that it does not own.

    One of the globals of the launcher script per instance; one of the slave, its class and its log when it refuses to start.
    """
    for each in objects:
        ctypes.pythonapi.Py_IncRef(ctypes.py_object(each))


def leave_search_path(resources):
    """Take the resources of an FMU off the search path: the library puts them there for each instance and leaves them."""
    with suppress(ValueError):
        sys.path.remove(resources)


@lru_cache
def free_interpreter_once(resources):
    """Let a Linux process end cleanly with PythonFMU's library loaded.

    At exit the library frees its interpreter state in a static destructor and then again in its unload function. An exit
    handler registered now runs before both and removes the state. glibc never unloads the library, because it has unique
    symbols; `RTLD_NODELETE` ensures this for others, so that the handler stays valid.
    """
    if sys.platform != "linux":
        return
    for path in Path(resources).parent.glob("binaries/linux64/*.so"):
        with suppress(OSError, AttributeError):  # not loaded from there, or a C library of another kind
            library = ctypes.CDLL(str(path), mode=os.RTLD_NOW | os.RTLD_NOLOAD | os.RTLD_NODELETE)
            handler = ctypes.cast(library.finalizePythonInterpreter, ctypes.c_void_p)
            ctypes.CDLL(None).__cxa_atexit(handler, None, None)
