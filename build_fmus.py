"""Build the FMUs: `python build_fmus.py [NAME ...] [OPTIONS]`, the same as `tetherfmu build`."""

import sys

from tetherfmu.__main__ import main as tetherfmu


def main(arguments=None):
    """Build; returns the exit status."""
    return tetherfmu(["build", *(sys.argv[1:] if arguments is None else arguments)])


if __name__ == "__main__":
    sys.exit(main())
