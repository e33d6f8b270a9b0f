"""Line files of MoorDyn v2 and decks of CableDyn as systems of tethers.

Both programs read the values of a row by position, regardless of column headings. Slack segments have damping, but no
stiffness. A negative BA is minus the fraction of critical damping of a segment:

    BA = zeta l sqrt(EA w),  l unstretched length of a segment, w mass per length

The bottom reaction is kBot d per length and depth, so a line sinks to the depth w g/(kBot d). Buoyancy is not modelled
for a fluid denser than air; a note states the fraction of weight that each line type would lose.

Source: MoorDyn 2.7.1, docs/inputs.rst, `MoorDyn2.cpp`, `Line::initialize`; CableDyn, doc/driver_format.md.
"""

import re
from contextlib import nullcontext
from math import cos, pi, radians, sin, sqrt

import numpy as np

from tetherfmu.files import system_files as files
from tetherfmu.runtime.parameters import Ground, Tether
from tetherfmu.runtime.quantities import quantities

from .written import Imported, number, row

TITLE = re.compile(r"^\s*-{3,}\s*(.*?)[\s-]*$")
HAS_IT = re.compile(r"^\s*-{3,}\s*LINE ?(TYPES|DICTIONARY)", re.IGNORECASE | re.MULTILINE)
# beginnings of section titles, longer ones first
SECTIONS = {"LINE TYPE": "types", "LINETYPE": "types", "LINE DICTIONARY": "types", "LINE ATTACHMENT": None, "LINE": "lines"}
SECTIONS |= {"POINT": "points", "CONNECT": "points", "BODIES": "bodies", "BODY": "bodies", "SECTIONS": "sections"}
SECTIONS |= {"ROD TYPE": None, "ROD DICTIONARY": None, "ROD": "rods", "FAILURE": "failures"}
SECTIONS |= {"OPTION": "options", "SOLVER OPTION": "options"}
NO_SECTION = ("NEED", "INPUT FILE")  # parts of titles that open no section
OF_A_TYPE = ("Name", "Diam", "Mass/m", "EA", "BA/-zeta", "EI", "Cd", "Ca", "CdAx", "CaAx")  # columns, as the next ones
OF_A_POINT = ("ID", "Attachment", "X", "Y", "Z")
OF_A_LINE = ("ID", "LineType", "AttachA", "AttachB", "UnstrLen", "NumSegs")
OF_A_SECTION = ("LineID", "LineType", "Length", "NumSegs")
OF_A_BODY = ("ID", "Attachment", "X0", "Y0", "Z0", "r0", "p0", "y0")
OF_A_ROD = ("ID", "RodType", "Attachment", "Xa", "Ya", "Za", "Xb", "Yb", "Zb", "NumSegs")
OF_A_FAILURE = ("FailureID", "Point", "Line(s)", "FailTime", "FailTen")
ABOUT_1 = 1.001  # buoyancy over weight above which a line floats
COLUMNS_OF_CABLEDYN, ITS_DRAG = 14, 10  # of a line type with shear and torsion, and where its Cd is
DRIVEN = ("fixed", "fix", "anchor", "coupled", "vessel", "cpld", "ves", "fairlead")
FREE = ("free", "point", "pnt", "connect", "con")
GRAVITY, WATER, STIFF_BOTTOM, ITS_STIFF_BOTTOM = 9.80665, 1025.0, 3e6, 1e5  # defaults of the options
# names of an option
OF_GRAVITY, OF_WATER, OF_BOTTOM, OF_DAMPING = ("g", "gravity"), ("wtrdnsty", "rhow", "rho"), ("kbot", "kb"), ("cbot", "cb")
OF_FRICTION, OF_START = ("frictioncoefficient", "frictionmu"), ("tmaxic", "ictmax")
OF_UNEVEN = ("seafloorfile", "seafloor_file", "bathymetryfile", "bathymetry_file")
OF_NOTHING = ("none", "-", "0")  # values of options that are off
MOST_DAMPING = dict(quantities(Tether))["axial_damping"].maximum
SINKS = dict(quantities(Ground))["ground_sink"]


def system(text):
    """`Imported` from the text of a file; ValueError names the row of a problem."""
    return Deck(text).imported()


class Deck:
    """The rows of a file by section, and their conversion."""

    def __init__(self, text):
        self.found, self.others = sections(text)
        for need in ("types", "points", "lines"):
            if not self.found[need]:
                raise ValueError(f"it has no {need} (v2: sections LINE TYPES, POINTS and LINES)")
        self.is_of_cabledyn = bool(self.found["sections"]) or "CABLEDYN" in text.upper()
        self.left_out, self.used, self.places = [], set(), {}
        self.options = dict(option_of(*each) for each in self.found["options"])
        self.density = self.option(WATER, *OF_WATER)
        self.gravity = self.option(GRAVITY, *OF_GRAVITY)
        self.types, self.of_types, self.has_lines = {}, {}, {}  # quantities of line types, their omissions, types in use
        for count, words in self.found["types"]:
            before, self.left_out = self.left_out, []
            self.types[words[0]] = self.type_of(count, words)
            self.of_types[words[0]], self.left_out = self.left_out, before
        self.tables = {"": {}}

    def option(self, default, *names):
        """The number of the first of some names that is there; 0 if it is switched off."""
        self.used.update(names)
        for name in (each for each in names if each in self.options):
            count, text = self.options[name]
            with row(count):
                return 0.0 if text.lower() in OF_NOTHING else number(name, text)
        return default

    def imported(self):
        """`Imported` of all rows."""
        for count, words in self.found["points"]:
            with row(count):
                columns(words, OF_A_POINT)
                self.add_point(f"p{words[0]}", *self.point_of(count, words))
        lengths = {}
        for count, words in self.found["sections"]:
            with row(count):
                columns(words, OF_A_SECTION)
                lengths.setdefault(words[0], []).append((count, words[1:4]))
        for count, words in self.found["lines"]:
            with row(count):
                self.add_line(words, lengths.pop(words[0], None))
        for (count, _), *_ in lengths.values():
            raise ValueError(f"row {count}: the section belongs to a line that is not in this file")
        for count, words in self.found["failures"]:
            with row(count):
                columns(words, OF_A_FAILURE)
                self.add_failure(count, words)
        self.leave_out()
        defaults = [] if any(each in self.options for each in OF_GRAVITY) else [f"g = {GRAVITY}"]
        defaults += [] if any(each in self.options for each in OF_WATER) else [f"density of the fluid = {WATER:g}"]
        tables = self.tables | self.surroundings()
        if "ground" in tables and self.option(0.0, "wtrdpth") < -tables["ground"]["height"]:
            defaults.append(f"bottom at the lowest point, z = {tables['ground']['height']:g} m")
        return Imported("system", tables, self.left_out, defaults)

    def type_of(self, count, words):
        """Quantities of a line type, with BA as written."""
        with row(count):
            columns(words, OF_A_TYPE, "MoorDyn v1 has no EI: write the file for v2")
            drag = ITS_DRAG if len(words) == COLUMNS_OF_CABLEDYN else OF_A_TYPE.index("Cd")
            values = [number(name, each) for name, each in zip(OF_A_TYPE[1:3], words[1:3], strict=True)]
            (stiffness, *slow), (damping, *fast) = (self.parts(k, words[k]) for k in (3, 4))
            values += [number(name, words[k]) for name, k in (("EI", 5), ("Cd", drag))]
            diameter, mass, bending, across = values
            if slow or fast:
                damping = fast[0] if fast else damping
                self.leave(count, f"line type {words[0]}: creep; EA is the static {stiffness:g} N, BA is {damping:g}")
            if damping > MOST_DAMPING:
                raise ValueError(f"BA is {damping:g} N.s; it must be at most {MOST_DAMPING:g} N.s")
            if bending:
                self.leave(count, f"line type {words[0]}: bending stiffness EI, {bending:g} N m2")
            more = [
                each for k, each in enumerate(words[6:], start=6) if k != drag and each.strip("0.") not in ("", "e+", "e-")
            ]
            area = pi / 4.0 * diameter**2
            if mass and (lost := self.density * area / mass):
                floats = ": it floats there, and hangs here" if lost > ABOUT_1 else ""
                self.leave(count, f"line type {words[0]}: buoyancy, {100.0 * lost:.3g} % of its weight{floats}")
            if more:
                self.leave(count, f"line type {words[0]}: drag along the line, added mass and lift: {', '.join(more)}")
        found = {"diameter": diameter, "mass_per_length": mass, "axial_stiffness": stiffness, "axial_damping": damping}
        return found | {"drag_coefficient": across, "slack_stiffness_ratio": 0.0}

    def parts(self, k, text):
        """Numbers of a column separated by bars; ValueError for the name of a file with a curve."""
        try:
            return [number(OF_A_TYPE[k], each) for each in text.split("|")]
        except ValueError:
            raise ValueError(
                f"{OF_A_TYPE[k]} is {text!r}; it must be a number: a tether has one stiffness and one damping, no curve"
            ) from None

    def point_of(self, count, words):
        """Table of a point and where it is [m]."""
        position = [number(name, each) for name, each in zip(OF_A_POINT[2:], words[2:5], strict=True)]
        mass, volume, *others = [number("Mass, Volume, CdA, Ca", each) for each in [*words[5:9], 0.0, 0.0][:4]]
        if volume:
            lift = f"volume {volume:g} m3, which carries {self.density * self.gravity * volume:.4g} N"
            self.leave(count, f"point {words[0]}: {lift}")
        if any(others):
            self.leave(count, f"point {words[0]}: drag and added mass")
        kind, of_body = words[1].lower(), re.fullmatch(r"body(\d+)", words[1], re.IGNORECASE)
        if of_body:
            position = self.on_body(of_body[1], position)
        elif kind in FREE:
            if self.option(1.0, *OF_START) > 0.0:  # relaxed there before the start: it starts in equilibrium here, too
                return {"mass": mass}, position
            return {"position": position, "mass": mass}, position
        elif kind not in DRIVEN:
            raise ValueError(f"Attachment is {words[1]!r}; it must be Fixed, Coupled, Free or Body with a number")
        if mass:
            self.leave(count, f"point {words[0]}: mass {mass:g} kg, which its driver carries")
        return {"position": position}, position

    def on_body(self, name, place):
        """Position of a point on a body at this place [m]; ValueError unless the body is fixed or driven."""
        for count, words in self.found["bodies"]:
            if words[0] == name:
                columns(words, OF_A_BODY)
                if words[1].lower() not in DRIVEN:
                    raise ValueError(
                        f"it is on body {name}, which is {words[1]} in row {count}: points only have a mass "
                        "here; only points of a body that is Fixed or Coupled can be driven"
                    )
                where = [number(key, each) for key, each in zip(OF_A_BODY[2:], words[2:8], strict=True)]
                return (np.array(where[:3]) + turned(*map(radians, where[3:])) @ place).tolist()
        raise ValueError(f"it is on body {name}, which is not in this file")

    def add_point(self, name, table, place):
        """Add the table of a point, which the reader of systems must accept."""
        if f"points.{name}" in self.tables:
            raise ValueError(f"the point {name.removeprefix('p')} appears twice")
        self.tables[f"points.{name}"], self.places[name] = table, place
        files.point_of(name, table)

    def add_line(self, words, lengths):
        """Add the tables of a line, in sections that are joined in free points where the file has any for it.

        lengths : list of pairs (row, [type, length, segments]), or None.
        """
        if lengths is None:
            columns(words, OF_A_LINE)
            lengths, ends = [(None, [words[1], *words[4:6]])], words[2:4]
        else:
            columns(words, ("ID", "NodeA", "NodeB"))
            ends = words[1:3]
        name, names = f"line{words[0]}", [self.end_of(each) for each in ends]
        joints = [f"{name}_{k}_{k + 1}" for k in range(1, len(lengths))]
        for joint in joints:
            self.add_point(joint, {"mass": 0.0}, [0.0, 0.0, 0.0])
        stations = [names[0], *joints, names[1]]
        for k, (count, given) in enumerate(lengths):
            own = f"{name}_{k + 1}" if joints else name
            if f"lines.{own}" in self.tables:
                raise ValueError(f"the line {words[0]} appears twice")
            table = {"from": stations[k], "to": stations[k + 1]} | self.line_of(*given)
            with row(count) if count else nullcontext():
                files.line_of(own, table)
            self.tables[f"lines.{own}"] = table

    def end_of(self, text):
        """Name of the point at which a line ends, possibly a rod's end."""
        rod = re.fullmatch(r"r(?:od)?(\d+)([ab])", text, re.IGNORECASE)
        name = (
            f"r{rod[1]}{rod[2].lower()}" if rod else "p" + re.sub(r"^(p|point|c|con)(?=\d)", "", text, flags=re.IGNORECASE)
        )
        if rod and f"points.{name}" not in self.tables:
            self.add_point(name, *self.end_of_rod(rod[1], rod[2].lower()))
        if f"points.{name}" not in self.tables:
            raise ValueError(f"it is attached to {text}, which is not a point of this file")
        return name

    def end_of_rod(self, name, end):
        """Table of the end "a" or "b" of a rod and where it is [m]; ValueError unless the rod is held or driven."""
        for count, words in self.found["rods"]:
            if words[0] == name:
                columns(words, OF_A_ROD)
                if words[2].lower() not in DRIVEN:
                    raise ValueError(
                        f"it is attached to rod {name}, which is {words[2]} in row {count}: there are no rods here; only "
                        "ends of a rod that is Fixed or Coupled can be driven"
                    )
                first = 3 if end == "a" else 6
                place = [number(OF_A_ROD[k], words[k]) for k in range(first, first + 3)]
                return {"position": place}, place
        raise ValueError(f"it is attached to rod {name}, which is not in this file")

    def line_of(self, kind, length, segments):
        """Quantities of a line."""
        if kind not in self.types:
            raise ValueError(f"LineType is {kind!r}; there are {', '.join(self.types)}")
        self.has_lines[kind] = None
        length, count = number("UnstrLen", length), number("NumSegs", segments)
        if not count >= 1.0 or count % 1.0:
            raise ValueError(f"NumSegs is {segments}; it must be a whole number of at least 1")
        found = {"initial_length": length, "segments": int(count)} | self.types[kind]
        if found["axial_damping"] < 0.0:
            wave = sqrt(found["axial_stiffness"] * found["mass_per_length"])
            found["axial_damping"] *= -length / count * wave
        return found

    def add_failure(self, count, words):
        """Make a line break at the tension at which it detaches; other parts of a failure are omitted."""
        name, lines = words[0], words[2].split(",")
        time, force = (number(key, each) for key, each in zip(OF_A_FAILURE[3:], words[3:5], strict=True))
        if time > 0.0:
            self.leave(count, f"failure {name}: at {time:g} s; set the input release of the line then")
        if force <= 0.0:
            return
        if len(lines) > 1:
            self.leave(count, f"failure {name}: of the lines {words[2]} at once, at {force:g} N")
            return
        point = self.end_of(words[1])
        found = [
            table
            for key, table in self.tables.items()
            if re.fullmatch(rf"lines\.line{re.escape(lines[0])}(_\d+)?", key) and point in (table["from"], table["to"])
        ]
        if not found:
            raise ValueError(f"failure {name} is of line {lines[0]}, which does not end at {words[1]}")
        found[0]["breaking_force"] = force
        self.leave(count, f"failure {name}: the place; the line breaks where it is first pulled with {force:g} N")

    def surroundings(self):
        """Tables of environment and ground."""
        tables = {"environment": {"gravity": self.gravity, "air_density": self.density}}
        deep = self.option(None, "wtrdpth")
        bottom = self.option(ITS_STIFF_BOTTOM if self.is_of_cabledyn else STIFF_BOTTOM, *OF_BOTTOM)
        friction = self.option(0.0, *OF_FRICTION)
        lowest = -min(place[2] for place in self.places.values())
        depth = None if deep is None and self.is_of_cabledyn else max(deep or 0.0, lowest)
        if depth is None or not bottom > 0.0:
            return tables
        if not self.gravity > 0.0:
            self.left_out.append("the bottom: without gravity there is no ground")
            return tables
        used = (self.types[name] for name in self.has_lines)
        sinks = [each["mass_per_length"] * self.gravity / (bottom * each["diameter"]) for each in used]
        sink = min(max(min(sinks), SINKS.minimum), SINKS.maximum)
        tables["ground"] = {"contact": "flat", "height": -depth, "friction": friction, "sink": sink}
        self.left_out.append("damping of the bottom")
        if files_of_bottom := [name for name in OF_UNEVEN if name in self.options]:
            self.leave(self.options[files_of_bottom[0]][0], f"the bottom of {files_of_bottom[0]}: the ground is flat here")
        return tables

    def leave_out(self):
        """Report unused parts of the file: sections by their rows, points without a line, options."""
        ends = {
            end for key, table in self.tables.items() if key.startswith("lines.") for end in (table["from"], table["to"])
        }
        for name in [key.removeprefix("points.") for key in self.tables if key.startswith("points.")]:
            if name not in ends:
                del self.tables[f"points.{name}"]
                self.left_out.append(f"point {name.removeprefix('p')}, at which no line ends")
        self.left_out[:0] = [each for name in self.has_lines for each in self.of_types[name]]
        if idle := [name for name in self.types if name not in self.has_lines]:
            self.left_out.append(f"line types {', '.join(idle)}, which no line has")
        for name in ("bodies", "rods"):
            self.left_out += [f"row {count}: {name}, {' '.join(words[:3])}" for count, words in self.found[name]]
        self.left_out += [f"section {title}{rows_of(rows)}" for title, rows in self.others.items()]
        self.used.update(("wtrdpth", *OF_BOTTOM, *OF_DAMPING, *OF_FRICTION, *OF_START))  # `surroundings` reads them
        others = [f"{name} (row {count})" for name, (count, _) in self.options.items() if name not in self.used]
        if others:
            self.left_out.append(f"options {', '.join(others)}")

    def leave(self, count, what):
        """Note that a part of a row is omitted."""
        self.left_out.append(f"row {count}: {what}")


def sections(text):
    """Rows of the known sections below their heads, dict of lists of pairs (number, words), and dict of the others' rows."""
    found, others, section, rows = {name: [] for name in filter(None, SECTIONS.values())}, {}, None, None
    for count, line in enumerate(text.splitlines(), start=1):
        title = TITLE.match(line)
        words = [each.rstrip(",") for each in re.split(r"[!#%]|(?:^|\s)--(?!-)", line)[0].split()]  # commas as of Fortran
        if title:
            name = title[1].upper()
            section = next((SECTIONS[each] for each in SECTIONS if name.startswith(each)), None)
            heads = 0 if section == "options" else 1
            rows = found[section] if section else others.setdefault(name, [])
            if not section and (count == 1 or name in ("", "END") or any(each in name for each in NO_SECTION)):
                rows = others.pop(name) and None
        elif line.split() and rows is not None:
            if not heads and words and not words[0].startswith("("):
                rows.append((count, words))
            heads = 0
    return found, {name: rows for name, rows in others.items() if rows}


def columns(words, needed, why=""):
    """ValueError if a row lacks a required column."""
    if len(words) < len(needed):
        why = why and f"; {why}"
        raise ValueError(f"it has {len(words)} columns; it must have at least {len(needed)}: {' '.join(needed)}{why}")


def option_of(count, words):
    """Name of an option, in small letters, and pair (row, value).

    The name comes second; where words and numbers are its value, as in CableDyn, it is the last word before the dash.
    """
    with row(count):
        columns(words, ("value", "option"))
    if is_number(words[1]) and not is_number(words[0]):
        before = words[: words.index("-")] if "-" in words else words
        return [each for each in before if not is_number(each)][-1].lower(), (count, words[0])
    return words[1].lower(), (count, words[0])


def is_number(text):
    """Whether a text is a number."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def turned(roll, pitch, yaw):
    """Rotation matrix of a body: about x, then the turned y, then the turned z, by angles [rad]."""
    a, b, c = (np.array(((cos(each), -sin(each)), (sin(each), cos(each)))) for each in (roll, pitch, yaw))
    x, y, z = np.eye(3), np.eye(3), np.eye(3)
    x[1:, 1:], y[::2, ::2], z[:2, :2] = a, b.T, c
    return x @ y @ z


def rows_of(rows):
    """Their numbers, in words."""
    first, last = rows[0][0], rows[-1][0]
    return f", rows {first} to {last}" if last > first else f", row {first}"
