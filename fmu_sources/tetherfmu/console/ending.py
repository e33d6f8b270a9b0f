"""How a command ends: its exit status, and one line on stderr unless all is well.

0  done
1  it failed; or what it looks for is not as it should be (a problem of an FMU, no advice that meets a scene)
2  wrong use: what was typed, or a file that was named, cannot be used, or a package that it needs is not installed
130  Ctrl-C
"""

import re
import signal
import sys
import threading
from contextlib import contextmanager
from functools import wraps
from importlib.metadata import PackageNotFoundError, requires

FAILED, WRONG_USE, STOPPED = 1, 2, 130
REQUIREMENT = re.compile(r"([\w-]+).*extra == ['\"](\w+)['\"]")


class WrongUse(ValueError):
    """What a user typed, or wrote into a file, cannot be used; the message says in one line why and what is allowed."""


def command(main):
    """A function that returns an exit status or None, with one line on stderr for what a user can make go wrong."""

    @wraps(main)
    def run(*arguments, **options):
        try:
            return main(*arguments, **options) or 0
        except WrongUse as error:
            return _said(error, WRONG_USE)
        except ModuleNotFoundError as missing:
            if (missing.name or "tetherfmu").startswith("tetherfmu"):
                raise
            return _said(f"{missing.name} is not installed: {remedy(missing.name)}", WRONG_USE)
        except OSError as error:
            return _said(f"{error.filename}: {error.strerror}" if error.filename else error, FAILED)
        except RuntimeError as error:
            return _said(error, FAILED)
        except KeyboardInterrupt as stop:
            return _said("; ".join(["stopped", *stop.args]), STOPPED)

    return run


def _said(text, status):
    """The status, after a text on stderr."""
    print(text, file=sys.stderr)
    return status


def remedy(package):
    """How to install a package that is missing: with the extra of this project that it belongs to."""
    try:
        found = filter(None, map(REQUIREMENT.match, requires("tetherfmu") or ()))
    except PackageNotFoundError:
        found = ()
    extras = sorted(match[2] for match in found if match[1].lower() == package)
    return f'pip install "tetherfmu[{extras[0]}]"' if extras else f"pip install {package}"


@contextmanager
def ctrl_c_waits():
    """Within the block, Ctrl-C is raised by the function that it gets, and nowhere else.

    For FMUs in this process: their library would take the exception for one of their own, tell it, and refuse the step.
    Where Ctrl-C raises nothing, or elsewhere than in the main thread, all stays as it is.
    """
    pressed = []

    def stop_if_pressed():
        if pressed:
            raise KeyboardInterrupt

    before = signal.getsignal(signal.SIGINT)
    if before is not signal.default_int_handler or threading.current_thread() is not threading.main_thread():
        yield stop_if_pressed
        return
    signal.signal(signal.SIGINT, lambda *_: pressed.append(True))
    try:
        yield stop_if_pressed
    finally:
        signal.signal(signal.SIGINT, before)
