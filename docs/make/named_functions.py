"""Names of functions on the pages of equations, such as `segment.tension`: which modules they mean."""

import re
from pathlib import Path

PACKAGE = Path(__file__).resolve().parents[2] / "fmu_sources" / "tetherfmu"
FOLDERS = ("[a-z]*.py", "runtime/[a-z]*.py", "kernels/**/[a-z]*.py")
#: modules that compute, by the name that the pages call them
MODULES = {
    path.stem: ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts)
    for folder in FOLDERS
    for path in PACKAGE.glob(folder)
}
NAME = re.compile(rf"({'|'.join(MODULES)})\.(\w+)")
FOLDER, PAGES = "models", ("theory", "numerics")
