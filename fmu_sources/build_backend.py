"""The build backend of this project: setuptools', with compiled libraries for all platforms and the examples in its wheels.

An editable installation has neither: it uses the checkout, and compiles what it needs at first use.
"""

import shutil
import tomllib
from pathlib import Path

from setuptools import build_meta
from setuptools.build_meta import *  # noqa: F403 (the hooks of a build backend)
from setuptools.command.build_py import build_py
from setuptools.command.sdist import sdist

from tetherfmu.libraries import ready, webassembly
from tetherfmu.libraries.ahead_of_time import TARGETS
from tetherfmu.libraries.c_kernels import c_kernels
from tetherfmu.libraries.sources import PACKAGE

BACKEND = "fmu_sources/build_backend.py"  # this file
BESIDE_THE_PACKAGE = ("docs", "examples", "tests", "build_fmus.py", "CHANGELOG.md", "CITATION.cff", BACKEND)
NOT_COPIED = shutil.ignore_patterns("__pycache__", "*.jsonl", "*.ll.gz")


def get_requires_for_build_wheel(config_settings=None):
    """What compiles the kernels, as the extra `build` of pyproject.toml names it."""
    project = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]
    return [*build_meta.get_requires_for_build_wheel(config_settings), *project["optional-dependencies"]["build"]]


def build_wheel(*arguments, **options):
    """As setuptools does it, in a folder that is new and does not stay."""
    try:
        shutil.rmtree("build", ignore_errors=True)
        return build_meta.build_wheel(*arguments, **options)
    finally:
        shutil.rmtree("build", ignore_errors=True)


class WholeCheckout(sdist):
    """Takes what a checkout has beside the package, too: the project can be tested and released from its sdist."""

    def make_distribution(self):
        """Make the archive; the folder that it is made of does not stay, also if Ctrl-C ends this."""
        try:
            super().make_distribution()
        finally:
            shutil.rmtree(self.distribution.get_fullname(), ignore_errors=True)

    def make_release_tree(self, base_dir, files):
        """Fill the folder that becomes the archive."""
        super().make_release_tree(base_dir, files)
        for name in BESIDE_THE_PACKAGE:
            origin, place = PACKAGE.parents[1] / name, Path(base_dir) / name
            if origin.is_dir():
                shutil.copytree(origin, place, ignore=NOT_COPIED)
            else:
                shutil.copy(origin, place)


class BuildWithLibraries(build_py):
    """Copies the package, and what a wheel has more."""

    def run(self):
        """Fill the folder that becomes the wheel."""
        super().run()
        if self.editable_mode:
            return
        package = Path(self.build_lib) / PACKAGE.name
        in_wheel = package / ready.IN_WHEEL.relative_to(PACKAGE)
        files = [webassembly.with_libraries(), *map(c_kernels, ready.LIBRARIES)]
        for variant, folder in ready.folders(ready.LIBRARIES, list(TARGETS)).items():
            shutil.copytree(folder, ready.place(in_wheel, variant), ignore=NOT_COPIED)
        for path in files:
            folder = in_wheel / path.parent.name
            folder.mkdir()
            shutil.copy(path, folder)
        examples = PACKAGE.parents[1] / "examples"
        shutil.copytree(examples, package / examples.name, ignore=NOT_COPIED)
