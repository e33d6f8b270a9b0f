"""A process that has imported what examples and pages need, and none of them; it forks one for each piece of code.

Run by `running`. Each line that it reads is a request in JSON: code, arguments, folder, and the files for what the code
prints and for its errors. The answer is a line with the exit status; a negative one is a signal.
"""

import contextlib
import ctypes
import gc
import importlib
import json
import os
import sys
from types import ModuleType

from coarse_figures import draw_coarsely

IMPORTED = ("fmpy.simulation", "matplotlib.pyplot", "scipy.integrate", "scipy.interpolate", "tetherfmu.export.archive")
IMPORTED += ("pandas", "plotly.graph_objects")  # whoever lacks an extra goes without


def run(code, arguments, folder, printed, errors):
    """As `python -c` does, from the folder to the finalization of the interpreter."""
    os.chdir(folder)
    for stream, path in ((1, printed), (2, errors)):
        file = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(file, stream)
        os.close(file)
    sys.argv[:] = ["-c", *arguments]
    sys.path[0] = ""
    sys.modules["__main__"] = ModuleType("__main__")
    failed = ctypes.pythonapi.PyRun_SimpleString(code.encode())  # leaves the process itself when the code asks for that
    ctypes.pythonapi.Py_Exit(1 if failed else 0)


def main():
    for module in IMPORTED:
        with contextlib.suppress(ImportError):
            importlib.import_module(module)
    draw_coarsely()
    gc.freeze()  # what was imported before the fork need not be looked through when a process ends
    for line in sys.stdin:
        process = os.fork()
        if not process:
            os.close(0)
            run(**json.loads(line))
        _, status = os.waitpid(process, 0)
        print(os.waitstatus_to_exitcode(status), flush=True)


main()
