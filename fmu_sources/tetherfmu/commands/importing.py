"""Import files of other programs: settings of KiteUtils.jl become a scene, line files of MoorDyn or CableDyn a system."""

from importlib import import_module
from pathlib import Path

from tetherfmu.console.ending import command, one_line
from tetherfmu.console.options import Parser, file
from tetherfmu.files.toml_files import WrongUse


@command
def main(arguments=None, prog="tetherfmu import"):
    """Write the scene or the system, and report omissions; returns the exit status."""
    parser = Parser(prog=prog)
    about = "settings of KiteUtils.jl (.yaml), or a line file of MoorDyn v2 or CableDyn (.txt, .dat)"
    parser.add_argument("file", type=file, metavar="FILE", help=about)
    about = "file to write (default: the name of FILE with the ending .toml, in this folder)"
    parser.add_argument("--out", type=Path, metavar="FILE.toml", help=about)
    given = parser.parse_args(arguments)
    out = given.out or Path(f"{given.file.stem}.toml")
    if out.exists():
        raise WrongUse(f"{out} exists already; choose another file with --out")
    try:
        made, text, sentences = import_module("tetherfmu.files.imported.reading").imported(given.file)
    except ValueError as problem:
        raise WrongUse(f"{given.file}: {one_line(problem)}") from None
    out.write_text(text, encoding="utf-8")
    commands = {"scene": f"tetherfmu advise {out}", "system": f"tetherfmu build --system {out}"}
    print(f"{out}  a {made.kind}: {commands[made.kind]}")
    print("\n".join(sentences))
    return 0
