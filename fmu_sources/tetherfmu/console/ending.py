"""End of a command: its exit status, and one line on stderr unless it succeeds.

0  success
1  failure; or a negative result (a problem of an FMU, no advice that meets the requirements)
2  wrong use: invalid arguments, an unusable file, or a required package that is not installed
130  Ctrl-C
"""

import errno
import re
import sys
from functools import cache, wraps

from tetherfmu.files.toml_files import WrongUse

FAILED, WRONG_USE, STOPPED = 1, 2, 130
DISK = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)  # errors of writing to a file that is open
DISTRIBUTIONS = {"yaml": "pyyaml"}  # packages that are installed by another name than they are imported
REQUIREMENT = re.compile(r"([\w-]+).*extra == ['\"](\w+)['\"]")


class WorkersLost(RuntimeError):
    """The worker processes, or the cluster, of a command are gone; the message says which in one line."""


def command(main):
    """Wraps a function that returns an exit status or None: user errors become one line on stderr."""

    @wraps(main)
    def run(*arguments, **options):
        opened = last_opened()
        try:
            return main(*arguments, **options) or 0
        except WrongUse as error:
            return _said(error, WRONG_USE)
        except ModuleNotFoundError as missing:
            if (missing.name or "tetherfmu").startswith("tetherfmu"):
                raise
            package = missing.name.partition(".")[0]
            package = DISTRIBUTIONS.get(package, package)
            return _said(f"{package} is not installed: {remedy(package)}", WRONG_USE)
        except OSError as error:
            file = error.filename or (opened[-1] if error.errno in DISK else None)
            return _said(f"{file}: {error.strerror}" if file else error, FAILED)
        except RuntimeError as error:
            return _said("stopped", STOPPED) if is_stop(error) else _said(error, FAILED)
        except KeyboardInterrupt as stop:
            return _said("; ".join(["stopped", *stop.args]), STOPPED)

    return run


@cache
def last_opened():
    """A list with the file that was opened last to be written: a disk that is full is an error without a name."""
    found = [None]

    def note(event, facts):
        if event == "open" and isinstance(facts[1], str) and facts[1].strip("rbt"):
            found[-1] = facts[0]

    sys.addaudithook(note)
    return found


def is_stop(error):
    """Whether an error comes from Ctrl-C: a lock that it interrupts may be released twice, which is a RuntimeError."""
    return isinstance(error.__context__, KeyboardInterrupt)


def one_line(error):
    """Message of an error in one line."""
    return " ".join(str(error).split())


def _said(text, status):
    """The status, after a text on stderr."""
    print(text, file=sys.stderr)
    return status


def remedy(package):
    """How to install a package that is missing: with the extra of this project that it belongs to."""
    from importlib.metadata import PackageNotFoundError, requires  # rarely needed, slow to import

    try:
        found = filter(None, map(REQUIREMENT.match, requires("tetherfmu") or ()))
    except PackageNotFoundError:
        found = ()
    extras = sorted(match[2] for match in found if match[1].lower() == package)
    return f'pip install "tetherfmu[{extras[0]}]"' if extras else f"pip install {package}"
