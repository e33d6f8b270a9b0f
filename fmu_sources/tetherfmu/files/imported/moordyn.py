"""Line files of MoorDyn v2 as systems of tethers: line types, points, lines, options.

MoorDyn reads the values of a row by their places, whatever the heads of the columns say. Slack segments have damping, but no
stiffness. Where BA is negative it is minus the part of critical damping of a segment:

    BA = zeta l sqrt(EA w),  l unstretched length of a segment, w mass per length

Source: MoorDyn, docs/inputs.rst, `Line::initialize`.
"""

import re
from math import sqrt

from tetherfmu.files import system_files as files

from .written import Imported, number, row

TITLE = re.compile(r"^\s*-{3,}\s*(.*?)[\s-]*$")
HAS_IT = re.compile(r"^\s*-{3,}\s*LINE (TYPES|DICTIONARY)", re.IGNORECASE | re.MULTILINE)
# what the title of a section begins with
SECTIONS = {"LINE TYPE": "types", "LINE DICTIONARY": "types", "POINT": "points", "CONNECTION": "points", "LINE": "lines"}
SECTIONS |= {"OPTION": "options", "SOLVER OPTION": "options"}
OF_A_TYPE = ("Name", "Diam", "Mass/m", "EA", "BA/-zeta", "EI", "Cd")  # columns that are needed, as the next two
OF_A_POINT = ("ID", "Attachment", "X", "Y", "Z")
OF_A_LINE = ("ID", "LineType", "AttachA", "AttachB", "UnstrLen", "NumSegs")
OF_VERSION_1 = {"can", "cat", "fx", "nodeanch"}  # heads of columns
DRIVEN, FREE = ("fixed", "fix", "anchor", "coupled", "vessel", "cpld", "ves"), ("free", "point", "pnt", "connect", "con")
GRAVITY, WATER, STIFF_BOTTOM = 9.80665, 1025.0, 3e6  # where the options do not say it: [m/s2], [kg/m3], [Pa/m]
OF_WATER = ("wtrdnsty", "rhow", "rho")  # names of an option
OF_FLUID = "buoyancy and added mass: of the fluid of {:g} kg/m3 drag alone acts on the lines"


def system(text):
    """`Imported` of the text of a file; ValueError names the row of what is wrong."""
    found, others = sections(text)
    for need in ("types", "points", "lines"):
        if not found[need]:
            raise ValueError(f"it has no {need} (v2: sections LINE TYPES, POINTS and LINES)")
    options, left_out = {}, [f"section {each}" for each in others]
    for count, words in found["options"]:
        with row(count):
            columns(words, ("value", "option"))
            options[words[1].lower()] = count, words[0]
    types = {words[0]: (count, type_of(count, words, left_out)) for count, words in found["types"]}
    tables = {"": {}}
    for count, words in found["points"]:
        with row(count):
            columns(words, OF_A_POINT)
            name = f"p{words[0]}"
            tables[f"points.{name}"] = point_of(words, left_out)
            files.point_of(name, tables[f"points.{name}"])
    for count, words in found["lines"]:
        with row(count):
            columns(words, OF_A_LINE)
            name = f"line{words[0]}"
            tables[f"lines.{name}"] = line_of(words, types, tables)
            files.line_of(name, tables[f"lines.{name}"])
    defaults = [] if "g" in options else [f"g = {GRAVITY}"]
    return Imported("system", tables | surroundings(options, left_out), left_out, defaults)


def sections(text):
    """Rows of the known sections below their heads, dict of lists of pairs (number, words), and titles of the others."""
    found, others, section = {name: [] for name in set(SECTIONS.values())}, [], None
    for count, line in enumerate(text.splitlines(), start=1):
        title = TITLE.match(line)
        if title:
            name = title[1].upper()
            section = next((SECTIONS[each] for each in SECTIONS if name.startswith(each)), None)
            heads = 0 if section == "options" else 1
            if section is None and count > 1 and name not in ("", "END", "NEED THIS LINE"):
                others.append(name)
        elif section and line.split():
            words = re.split("[!#%]", line)[0].split()
            if heads:
                old = OF_VERSION_1 & {each.lower() for each in line.split()}
                if old:
                    heads = ", ".join(sorted(old))
                    raise ValueError(f"row {count}: columns {heads} are of MoorDyn v1; write the file for v2")
                heads = 0
            elif words and not words[0].startswith("("):
                found[section].append((count, words))
    return found, others


def columns(words, needed):
    """ValueError if a row has not what is needed."""
    if len(words) < len(needed):
        raise ValueError(f"it has {len(words)} columns; it must have at least {len(needed)}: {' '.join(needed)}")


def type_of(count, words, left_out):
    """Quantities of a line type, with BA as it is; what it leaves out is added to a list."""
    with row(count):
        columns(words, OF_A_TYPE)
        several = [name for name, each in zip(OF_A_TYPE, words, strict=False) if "|" in each]
        if several:
            left_out.append(f"line type {words[0]}: all but the first number of {', '.join(several)}")
        values = [number(name, each.partition("|")[0]) for name, each in zip(OF_A_TYPE[1:], words[1:], strict=False)]
        diameter, mass, stiffness, damping, bending, drag = values
        if bending:
            left_out.append(f"line type {words[0]}: bending stiffness EI")
        if any(each.strip("0.") for each in words[8:9]):
            left_out.append(f"line type {words[0]}: drag along the line CdAx")
    found = {"diameter": diameter, "mass_per_length": mass, "axial_stiffness": stiffness, "axial_damping": damping}
    return found | {"drag_coefficient": drag, "slack_stiffness_ratio": 0.0}


def point_of(words, left_out):
    """Table of a point."""
    position = [number(name, each) for name, each in zip(OF_A_POINT[2:], words[2:5], strict=True)]
    mass, *others = [number("Mass, Volume, CdA, Ca", each) for each in words[5:9]] or [0.0]
    if any(others):
        left_out.append(f"point {words[0]}: volume, drag and added mass")
    kind = words[1].lower()
    if kind in DRIVEN:
        return {"position": position}
    if kind in FREE:  # starts where it is in equilibrium, as there
        return {"mass": mass}
    raise ValueError(f"Attachment is {words[1]!r}; it must be Fixed, Coupled or Free: bodies and rods have no place here")


def line_of(words, types, tables):
    """Table of a line; tables : those of the points."""
    if words[1] not in types:
        raise ValueError(f"LineType is {words[1]!r}; there are {', '.join(types)}")
    ends = [f"p{each}" for each in words[2:4]]
    for name, end in zip(words[2:4], ends, strict=True):
        if f"points.{end}" not in tables:
            raise ValueError(f"it is attached to {name}, which is no point of this file")
    length, segments = number("UnstrLen", words[4]), number("NumSegs", words[5])
    if not segments >= 1.0 or segments % 1.0:
        raise ValueError(f"NumSegs is {words[5]}; it must be a whole number of at least 1")
    found = {"from": ends[0], "to": ends[1], "initial_length": length, "segments": int(segments)} | types[words[1]][1]
    if found["axial_damping"] < 0.0:
        wave = sqrt(found["axial_stiffness"] * found["mass_per_length"])
        found["axial_damping"] *= -length / segments * wave
    return found


def surroundings(options, left_out):
    """Tables of environment and ground; what is left out of the options is added to a list."""
    used = set()

    def option(default, *names):
        """The number of the first of some names that is there."""
        used.update(names)
        for name in (each for each in names if each in options):
            count, text = options[name]
            with row(count):
                return number(name, text)
        return default

    density, depth = option(WATER, *OF_WATER), option(0.0, "wtrdpth")
    environment = {"gravity": option(GRAVITY, "g"), "air_density": density}
    left_out.append(OF_FLUID.format(density))
    tables = {"environment": environment}
    friction = option(0.0, "frictioncoefficient")
    if depth > 0.0 and option(STIFF_BOTTOM, "kbot") > 0.0:
        tables["ground"] = {"contact": "flat", "height": -depth, "friction": friction}
        left_out.append("stiffness and damping of the bottom: ground.sink sets how stiff it is")
    others = [name for name in options if name not in used]
    if others:
        left_out.append(f"options {', '.join(others)}")
    return tables
