"""Files of an FMU besides the model: page, pictures, licences, evidence set, OSP's groups."""

import re
from html import escape
from importlib.metadata import PackageNotFoundError, distribution, metadata

from tetherfmu.fmi.model_description import start_text
from tetherfmu.fmi.resources import DEFAULT_OPTIONS
from tetherfmu.libraries.sources import PACKAGE
from tetherfmu.python import models
from tetherfmu.runtime import __version__
from tetherfmu.runtime.variants import BY_NAME
from tetherfmu.wiring import selection
from tetherfmu.wiring.variables import INPUT, LOCAL, OUTPUT, PARAMETER, table_of

from . import evidence, lean_evidence, osp, related_files
from .texts import ASSETS, asset, filled

LICENCE = PACKAGE.parents[1] / "LICENSE"  # in a checkout; a wheel has it among its metadata
EVIDENCE_FOLDER = "documentation/evidence"
OSP_FOLDER = "extra/com.open-simulation-platform"


def documents(name, variant, description, options, given, native=None):
    """All files other than the model of a tether: dict of their path in the archive to bytes.

    name : of the FMU.  variant : one of `variants.EVERY_VARIANT`.  description : of the model, one paragraph.
    options : `BuildOptions`; an FMU for one purpose has its own page, and no evidence set.  given : result of its
    `of_slave`.
    native : version of FMI (2 or 3) of an FMU without Python; None for PythonFMU's.
    """
    given, sets, title = DEFAULT_OPTIONS | given, {}, name
    table = table_of(variant, given)
    if options.purpose:
        title, body = f"{name}, {options.purpose.name}", options.purpose.page
    else:
        made = lean_evidence.of_tether(getattr(models, name), table, given["left_out"], options.wind_points)
        kinds = {each.kind for each in made}
        more = filled("evidence_of_winch.txt", name=name) if kinds.issuperset(evidence.GIVEN) else ""
        words = {"scene": evidence.SCENES[BY_NAME[variant].kite_is_free], "more": more}
        sets = evidence.files(name, made, native == 3, model=name, **words) if made else {}
        shared = asset("physics/chain_in_motion.html") if BY_NAME[variant].has_waves else ""
        physics = (physics_of(variant) + shared).strip()
        coupling = asset("free_kite.html" if BY_NAME[variant].kite_is_free else "driven_kite.html").strip()
        body = filled("tether.html", name=name, physics=physics, coupling=coupling, **about(description, native))
    groups = osp.model_description(selection.shown(table, given["left_out"]))
    beside = files_beside(name, page(title, body, table, given["left_out"]), sets, options.platforms, groups, native)
    return beside | {"documentation/figure.png": (ASSETS / "figure.png").read_bytes()}


def physics_of(variant):
    """Section of the page on the physics of a variant; ValueError if nobody has written it yet."""
    file = f"physics/{variant}.html"
    if not (ASSETS / file).exists():
        raise ValueError(f"the tether {variant} has no page of its physics: write {PACKAGE.name}/export/assets/{file}")
    return asset(file)


def files_beside(name, page_of, sets, platforms, groups, native=None):
    """Files other than the model of a tether or a system: dict of their path in the archive to bytes.

    page_of : returns the text of the page for the paths of the other files.  sets : texts of the evidence sets, dict by file
    name.  platforms : as in `of_every_fmu`.  groups : text of the file for the Open Simulation Platform, for FMI 2.
    """
    texts = of_every_fmu(platforms, native)
    if native != 3:
        texts[f"{OSP_FOLDER}/{osp.file_name(name)}"] = groups
    if sets:
        own = {f"{EVIDENCE_FOLDER}/{file}": text for file, text in sets.items()}
        texts |= own | {related_files.MANIFEST: related_files.manifest(own)}
    texts["documentation/index.html"] = page_of(texts)
    icon = "terminalsAndIcons/icon.png" if native == 3 else "model.png"
    return {icon: (ASSETS / "model.png").read_bytes(), **{path: text.encode("utf-8") for path, text in texts.items()}}


NO_PACKAGES = "No package has to be installed in it: the FMU carries its compiled\n   models."


def of_every_fmu(platforms, native=None, packages=NO_PACKAGES):
    """Texts on host requirements, and licences: dict of path in the archive to text.

    platforms : names of the supported platforms.  native : as in `documents`.  packages : requirements of its Python.
    """
    host = "native_dependencies.txt" if native else "externalDependencies.txt"
    own_licence = LICENCE.read_text(encoding="utf-8") if LICENCE.exists() else licence_of("tetherfmu")
    texts = {
        "documentation/externalDependencies.txt": filled(host, platforms=", ".join(platforms), packages=packages),
        "documentation/licenses/license.txt": own_licence,
    }
    if native:
        texts["documentation/licenses/FMI.txt"] = asset("FMI.txt")
    else:
        texts["documentation/licenses/PythonFMU.txt"] = licence_of("pythonfmu")
        texts["documentation/licenses/CPPFMU.txt"] = asset("CPPFMU.txt")
    return texts


WORDS_ON_FILES = {  # in documentation/index.html, by the end of a path in the archive
    f"{EVIDENCE_FOLDER}/README.txt": "Evidence set: inputs, reference and options of a run that an importer can repeat",
    "externalDependencies.txt": "What the host must have",
    "licenses/license.txt": "Licence of TetherFMU",
    "licenses/PythonFMU.txt": "Licence of PythonFMU",
    "licenses/CPPFMU.txt": "Licence of CPPFMU",
    "licenses/FMI.txt": "Licence of the headers of FMI",
    "OspModelDescription.xml": "Connections for the Open Simulation Platform",
    related_files.MANIFEST: "The evidence set for tools, after a draft of FMI's layered standard for related files",
}


def listed(paths):
    """HTML list of the files that `WORDS_ON_FILES` has words on."""
    lines = []
    for end, words in WORDS_ON_FILES.items():
        for path in (each for each in paths if each.endswith(end)):
            place = path.removeprefix("documentation/")
            shown = f'<a href="{place}">{words}</a>' if place != path else f"{words}: <code>{path}</code>"
            lines.append(f"<li>{shown}</li>")
    return "\n".join(lines)


def about(description, native=None):
    """Texts of the page of an FMU of a tether or a system: dict of words."""
    flavour = "native" if native else "with PythonFMU"
    words = {"fmi": native or 2, "flavour": flavour, "version": __version__, "description": escape(description)}
    return words | {"manual": manual()}


def manual():
    """Link to the project and its manual, as the metadata of the package have it; empty while they have no address."""
    try:
        addresses = metadata("tetherfmu").get_all("Project-URL") or ()
    except PackageNotFoundError:  # in a checkout that is not installed
        addresses = ()
    known = [each.partition(", ")[2] for each in addresses if not each.endswith(".invalid")]
    return f' The <a href="{escape(known[0])}">project</a> has the manual.' if known else ""


def page(title, body, table, left_out=(), hint="<p>Set them before the initialization ends.</p>\n"):
    """Function of the paths of the other files that returns the text of documentation/index.html.

    body : HTML above the tables of the variables in `table`.  left_out : names of omitted variables.
    hint : HTML above the parameters.
    """
    own = selection.shown(table, frozenset(left_out))
    local, fixed = rows(own, LOCAL, unit, meaning), [each for each in table if each.name in left_out]
    fixed = "\n".join(rows(fixed, causality, unit, start, meaning) for causality in (INPUT, PARAMETER)).strip()
    tables = filled(
        "tables.html",
        hint=hint,
        inputs=rows(own, INPUT, unit, start, meaning),
        outputs=rows(own, OUTPUT, unit, meaning),
        local=filled("local.html", rows=local) if local else "",
        parameters="\n".join(_in_groups(own)),
        constants=filled("constants.html", rows=fixed) if fixed else "",
    )
    shown = {"title": escape(title), "style": asset("page.css").strip(), "body": body.strip(), "tables": tables.rstrip()}
    return lambda paths: filled("page.html", files=listed(paths), **shown)


def _in_groups(listed):
    """Rows of an HTML table of parameters, with a heading above each group."""
    groups = {}
    for each in listed:
        if each.causality == PARAMETER:
            groups.setdefault("first" if selection.own_name(each.name) in selection.FIRST else each.group, []).append(each)
    for group, variables in groups.items():
        if any(each.group for each in variables):  # an example has no groups
            yield f'<tr><th colspan="5">{selection.GROUPS.get(group, "what is set first")}</th></tr>'
        yield rows(variables, PARAMETER, unit, start, allowed, meaning)


def folded(listed):
    """Pairs (name, variables) with the components of a vector in one pair, and the whole shape in another."""
    found = {}
    for variable in listed:
        found.setdefault(variable.name.partition("[")[0], []).append(variable)
    indices = {1: "", 3: "[1..3]"}
    return [(name + indices.get(len(each), "[1..K,1..3]"), each) for name, each in found.items()]


def unit(each):
    """Unit of a variable or of a vector of them."""
    return each[0].quantity.unit or "-"


def start(each):
    """Start value of a variable or of a vector of them; of the points of a tether the first and the last."""
    if len(each) > 3:
        return f"{start(each[:3])} to {start(each[-3:])}"
    return ", ".join(start_text(variable) for variable in each)


def allowed(each):
    """Range of a variable, of an enumeration with the meanings of its choices."""
    return each[0].quantity.in_words()


def meaning(each):
    """Meaning of a variable or of a vector of variables."""
    text = each[0].quantity.meaning
    return text if len(each) == 1 else re.sub(r"^point 1 of \d+", "points", text.removesuffix(", x"))


def rows(table, causality, *columns):
    """Rows of an HTML table of the variables of a causality; columns : functions that return a text for a variable."""
    found = []
    for name, each in folded([variable for variable in table if variable.causality == causality]):
        cells = "".join(f"<td>{escape(text_of(each))}</td>" for text_of in columns)
        found.append(f"<tr><td><code>{name}</code></td>{cells}</tr>")
    return "\n".join(found)


def licence_of(package):
    """Licence text of an installed package with parts in the FMU."""
    metadata = distribution(package)
    return metadata.read_text("licenses/LICENSE") or metadata.read_text("LICENSE")
