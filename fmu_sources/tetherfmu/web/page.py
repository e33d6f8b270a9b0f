"""Write the page: one HTML, one script made of modules, one WebAssembly file. It needs a server and no other host."""

import json
import re
from graphlib import TopologicalSorter
from pathlib import Path
from string import Template

from tetherfmu.runtime import __version__

from .declarations import declarations

ASSETS = Path(__file__).with_name("assets")
IMPORT = re.compile(r'^import \{ ([^}]*) \} from "\./(\w+)\.js";\n', re.MULTILINE)
EXPORT = re.compile(r"^export (?=(?:async )?(?:const|function|class) (\w+))", re.MULTILINE)
PAGE, SCRIPT, KERNELS = "index.html", "page.js", "tetherfmu.wasm"


def modules():
    """Modules of the script by name: dict of name to text, each after its imports."""
    texts = {path.stem: path.read_text(encoding="utf-8") for path in sorted((ASSETS / "script").glob("*.js"))}
    needed = {name: [each for _, each in IMPORT.findall(text)] for name, text in texts.items()}
    return {name: texts[name] for name in TopologicalSorter(needed).static_order()}


def script():
    """The script: each module a function that returns its exports, so that names remain local."""
    parts = []
    for name, text in modules().items():
        inside = EXPORT.sub("", IMPORT.sub(r"const { \1 } = \2;\n", text)).strip()
        exported = ", ".join(EXPORT.findall(text))
        parts.append(f"const {name} = (() => {{\n{inside}\nreturn {{ {exported} }};\n}})();\n")
    head = f"// TetherFMU {__version__}, MIT licence. Made of the modules in tetherfmu/web/assets/script.\n"
    return head + "\n".join(parts)


def html():
    """The page with its style and the declarations of the tethers."""
    known = json.dumps(declarations(), separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    template = Template((ASSETS / "index.html").read_text(encoding="utf-8"))
    style = (ASSETS / "page.css").read_text(encoding="utf-8").strip()
    return template.substitute(style=style, version=__version__, declarations=known)


def write(folder, kernels):
    """Write the page into a folder, which is made if it is missing; returns the files.

    kernels : contents of the WebAssembly file, bytes.  OSError if a file cannot be written.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    contents = {PAGE: html().encode("utf-8"), SCRIPT: script().encode("utf-8"), KERNELS: kernels}
    for name, content in contents.items():
        (folder / name).write_bytes(content)
    return [folder / name for name in contents]
