"""Files that exist complete or not at all, even with concurrent writers, and the remains of killed processes."""

from contextlib import contextmanager, suppress
from glob import escape
from shutil import rmtree
from time import time
from uuid import uuid4

LEFT_BEHIND = 3600.0  # age [s] of unfinished files that are abandoned


@contextmanager
def whole(path):
    """Path of a new file that replaces `path` when the block ends, and is removed if an exception ends it."""
    clear(path.parent, f"{escape(path.name)}.*.partial")
    unfinished = path.with_name(f"{path.name}.{uuid4().hex}.partial")
    try:
        yield unfinished
        unfinished.replace(path)
    except OSError as error:
        error.filename = str(path)
        raise
    finally:
        unfinished.unlink(missing_ok=True)


def clear(folder, pattern):
    """Remove abandoned files and folders of a pattern in a folder."""
    for path in folder.glob(pattern):
        with suppress(OSError):  # another process may clear, too
            if time() - path.lstat().st_mtime > LEFT_BEHIND:
                rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()
