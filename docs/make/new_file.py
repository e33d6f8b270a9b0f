"""Type of an option of the scripts that write pages: a file to write to."""

import argparse
from pathlib import Path

from tetherfmu.console.options import folder


def new_file(ending):
    """Type of an option that is a file to write to, with this ending of its name."""

    def checked(text):
        if Path(text).is_dir():
            raise argparse.ArgumentTypeError(f"{text!r} is a folder; it must be a file")
        if Path(text).suffix != ending:
            raise argparse.ArgumentTypeError(f"{text!r} is not possible; the name of the file must end in {ending}")
        folder(str(Path(text).parent))
        return Path(text)

    return checked
