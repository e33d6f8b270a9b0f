"""Build the FMUs: `python build_fmus.py [NAME ...] [OPTIONS]`, the same as `tetherfmu build`."""

import sys

from tetherfmu.commands.build import main

if __name__ == "__main__":
    sys.exit(main())
