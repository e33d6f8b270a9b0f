"""`tetherfmu tutorial`: list the lessons, run them, copy them and all other examples to a folder of the user's."""

import argparse
import ast
import re
import shutil
from importlib import import_module
from pathlib import Path

from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, folder
from tetherfmu.files.toml_files import WrongUse
from tetherfmu.runtime.naming import meant_or_all

LESSONS = Path(__file__).resolve().parent
NEEDED = (  # what to install for the copied files
    'all of them: pip install "tetherfmu[examples]"',
    'the examples of first_flight and power_system/pumping_cycle.py with --html: pip install "tetherfmu[html]"',
    "first_flight/logged_flight.py, coupling/coupling_limits.py, tutorial/tether_13.py, tetherfmu advise SCENE: "
    'pip install "tetherfmu[study]"',
)
LINK_TO_DOCS = re.compile(r"\[([^]]*)\]\(\.\./docs/[^)]*\)")  # of a README, which leads nowhere from a copy


def lessons():
    """Dict name -> file of all lessons, in their order; the numbered ones are called by their number."""
    files = [*sorted(LESSONS.glob("tether_*.py")), *sorted(LESSONS.glob("quasi_steady_*.py"))]
    return {path.stem.removeprefix("tether_"): path for path in files}


def lesson(text):
    """Type of a lesson, by its name or its number, or of all."""
    name = text.removesuffix(".py").removeprefix("tether_")
    name = name.zfill(2) if name.isdecimal() else name
    if name not in (*lessons(), "all"):
        hint = meant_or_all(text, (*lessons(), "all"), "choose from {}")
        raise argparse.ArgumentTypeError(f"there is no lesson {text!r}{hint}")
    return name


def parse(arguments, prog):
    """Command line options; wrong ones end the program with status 2."""
    parser = Parser(prog=prog)
    option = parser.add_argument
    option(
        "lessons", nargs="*", type=lesson, metavar="LESSON", help="lessons to run, such as 06b, or all (default: list them)"
    )
    option("--out", type=folder, metavar="DIR", help="folder of the figures (default: plots)")
    option("--show", action="store_true", help="open figures and animations in windows")
    option("--animate", action="store_true", help="write animations as GIF files")
    option("--save-frames", action="store_true", help="write animations as HTML pages with their frames in a folder")
    option("--copy", type=folder, metavar="DIR", help="copy the lessons and all other examples to this folder")
    option("--overwrite", action="store_true", help="replace files in the folder of --copy")
    given = parser.parse_args(arguments)
    running = given.out or given.show or given.animate or given.save_frames
    if given.copy and (given.lessons or running):
        parser.error("--copy excludes LESSON and its options")
    if given.overwrite and not given.copy:
        parser.error("--overwrite requires --copy DIR")
    if running and not given.lessons:
        parser.error(f"which LESSON? choose from {', '.join(lessons())}, or all")
    return given


def copy(place, overwrite):
    """Copy all examples; WrongUse names a file that would be replaced against the user's will."""
    origin = LESSONS.parent
    found = (path.relative_to(origin) for path in sorted(origin.rglob("*")) if path.is_file())
    files = [file for file in found if "__pycache__" not in file.parts]
    there = next((place / file for file in files if (place / file).exists()), None)
    if there and not overwrite:
        raise WrongUse(f"{there} exists already; --overwrite replaces it and all others")
    for file in files:
        (place / file).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(origin / file, place / file)
    readme = place / "README.md"
    readme.write_text(LINK_TO_DOCS.sub(r"\1", readme.read_text(encoding="utf-8")), encoding="utf-8")
    print(f"{len(files)} files are in {place}. They need:")
    print("\n".join(f"  {each}" for each in NEEDED))


def run(given):
    """Run lessons one after the other; returns the exit status, that of the first one that failed."""
    options = [] if given.out is None else ["--out", str(given.out)]
    options += [f"--{name.replace('_', '-')}" for name in ("show", "animate", "save_frames") if getattr(given, name)]
    known = lessons()
    for name in known if "all" in given.lessons else given.lessons:
        status = import_module(known[name].stem).main(options, f"tetherfmu tutorial {name}")
        if status:
            return status
    return 0


@command
def main(arguments=None, prog="tetherfmu tutorial"):
    """Do what the command line says; returns the exit status."""
    given = parse(arguments, prog)
    if given.copy:
        return copy(given.copy, given.overwrite)
    if given.lessons:
        return run(given)
    known = lessons()
    width = max(map(len, known))
    for name, path in known.items():  # with what it asks
        about = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))
        print(f"{name:<{width}}  {about.splitlines()[0]}")
    print('tetherfmu tutorial LESSON runs one (pip install "tetherfmu[examples]"), tetherfmu tutorial --copy DIR copies all')
    return 0
