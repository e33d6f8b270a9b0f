"""Settings (`settings.yaml`) of KiteUtils.jl, KiteModels.jl, SymbolicAWEModels.jl and Tethers.jl: a kite at its tether.

Sections have pairs of a key and a value; as in KiteUtils.jl a key may stand in any section. One tether makes a scene,
several lines from the ground to the kite a system.

Air there is rho_0 at 15 degrees Celsius and sea level; at the ground station of the height h and the temperature T it is

    rho_0 288.15/(T + 273.15) exp(-h/8550)

The inertia J of the winch is given at the motor; with gear ratio n and drum radius r it is J (n/r)^2 at the rope. Friction
is given at the rope.

Source: KiteUtils.jl 0.11, `Settings`, `wind_vec_from_angles`; AtmosphericModels.jl, `calc_rho`, `calc_wind_factor`,
`ProfileLaw`; WinchModels.jl, `calc_coulomb_friction`, `calc_viscous_friction`.
"""

import re
from math import cos, exp, hypot, pi, radians, sin

import yaml

from tetherfmu.files.toml_files import value_of
from tetherfmu.runtime.layout import EXPLOG, LOGARITHMIC, POWER_LAW, UNIFORM
from tetherfmu.runtime.parameters import Environment, Tether, Winch

from .written import Imported, number, row

HAS_IT = re.compile(r"^tether\s*:", re.MULTILINE)
SCALE_HEIGHT, ZERO_CELSIUS, STANDARD = 8550.0, 273.15, 15.0  # [m], [K], temperature of rho_0 [degrees Celsius]
LAWS = {0: UNIFORM, 1: POWER_LAW, 2: LOGARITHMIC, 3: EXPLOG}  # `profile_law`: `wind_profile`
# quantity: its keys in different versions, at most one per file, and the factor to its unit
TETHER = {
    "diameter": (("d_tether",), 1e-3),
    "density": (("rho_tether",), 1.0),
    "axial_damping": (("axial_damping", "unit_damping", "damping"), 1.0),
    "drag_coefficient": (("cd_tether",), 1.0),
}
ENVIRONMENT = {
    "gravity": (("g_earth",), 1.0),
    "wind_reference_height": (("h_ref",), 1.0),
    "wind_exponent": (("alpha",), 1.0),
    "surface_roughness": (("z0",), 1.0),
}
OF_AIR = ("air_density", "wind_profile")
LENGTHS, STIFFNESS = ("l_tethers", "l_tether"), ("axial_stiffness", "unit_stiffness", "c_spring")
DIAMETERS = ("power_tether_diameter", "steering_tether_diameter")  # of the first line, of the others
ELEVATION = 60.0  # default elevation of the kite [degrees]
DRUM = ("inertia_total", "gear_ratio", "drum_radius")


class Settings:
    """The pairs of a file, as "section.key" -> (row, text, list of texts), and the set of used ones.

    ValueError names a row that is not YAML, or repeats a key.
    """

    def __init__(self, text):
        self.pairs, self.used, self.partly = {}, set(), {}
        for section, node in pairs_in(composed(text)):
            for own, value in pairs_in(node) or [(section, node)]:
                key, count = f"{in_text(section, text)}.{in_text(own, text)}", own.start_mark.line + 1
                if key in self.pairs:
                    raise ValueError(f"row {count}: {key} is in row {self.pairs[key][0]}, too; keep one of them")
                parts = value.value if isinstance(value, yaml.SequenceNode) else [value]
                self.pairs[key] = count, in_text(value, text), [in_text(each, text) for each in parts]

    def keys(self, *names):
        """Keys with one of these names in any section, in the order of the names."""
        return [key for name in names for key in self.pairs if key.partition(".")[2] == name]

    def all(self, *names):
        """Key, row and numbers (a list) of a quantity with several possible names; None if it is absent.

        ValueError names a row without a number, or two contradicting rows.
        """
        found = []
        for key in self.keys(*names):
            self.used.add(key)
            count, _, texts = self.pairs[key]
            with row(count):
                found.append((key, count, [number(key, each) for each in texts]))
        for key, count, values in found[1:]:
            if values != found[0][2]:
                raise ValueError(
                    f"row {count}: {key} is {self.pairs[key][1]}, and {found[0][0]} in row {found[0][1]} is "
                    f"{self.pairs[found[0][0]][1]}; they are names of one quantity: keep one of them"
                )
        return found[0] if found else None

    def first(self, *names, check=lambda value: None):
        """The number of a quantity, the first one of a list; None if it is not there.  check : raises ValueError."""
        found = self.all(*names)
        if found is None:
            return None
        key, count, values = found
        with row(count):
            check(values[0])
        if any(each not in (0.0, values[0]) for each in values):
            self.partly[f"all but the first of {key}"] = None
        return values[0]

    def flag(self, name):
        """Whether a key is present and true; ValueError names a row that is neither true nor false."""
        for key in self.keys(name):
            self.used.add(key)
            count, text, _ = self.pairs[key]
            if text.lower() not in ("true", "false"):
                raise ValueError(f"row {count}: {key} is {text!r}; it must be true or false")
            return text.lower() == "true"
        return False

    def all_of(self, table, kind):
        """Dict of quantities of a record that are there, of a table as `TETHER`; ValueError names the row of a wrong one."""
        found = {}
        for quantity, (names, factor) in table.items():
            key = next(iter(self.keys(*names)), "")
            value = self.first(*names, check=lambda value: value_of(kind, quantity, factor * value, f"{key}: "))  # noqa: B023
            if value is not None:
                found[quantity] = factor * value
        return found

    def left_out(self):
        """Names of unused pairs; only the name of a section that is entirely unused."""
        kept = {key.partition(".")[0] for key in self.used}
        others = ((key, key.partition(".")[0]) for key in self.pairs if key not in self.used)
        return list(dict.fromkeys([*self.partly, *(key if section in kept else section for key, section in others)]))


def composed(text):
    """The node of a text in YAML, None of an empty one; ValueError names the row of an error."""
    try:
        return yaml.compose(text, yaml.SafeLoader)
    except yaml.MarkedYAMLError as error:
        count, problem = (error.problem_mark or error.context_mark).line + 1, error.problem or error.context
    except yaml.reader.ReaderError as error:
        count, problem = text.count("\n", 0, error.position) + 1, error.reason
    except RecursionError:
        raise ValueError("is no file of settings: its lists are nested too deeply") from None
    raise ValueError(f"row {count}: it is not YAML: {problem}")


def pairs_in(node):
    """Pairs (key, value) of a node, both nodes, a list; empty for other nodes."""
    return node.value if isinstance(node, yaml.MappingNode) else []


def in_text(node, text):
    """Text of a node: a scalar without quotes, otherwise the source text."""
    is_scalar = isinstance(node, yaml.ScalarNode)
    return node.value if is_scalar else text[node.start_mark.index : node.end_mark.index].strip()


def imported(text):
    """`Imported` of the text of a file: a scene, or with several tethers a system; ValueError names the row."""
    settings = Settings(text)
    lengths = lengths_of(settings)
    tether, environment = settings.all_of(TETHER, Tether), settings.all_of(ENVIRONMENT, Environment)
    tether["initial_length"] = lengths[0]
    tether |= stiffness(settings, tether.get("diameter", Tether.diameter))
    environment |= air(settings)
    if (law := settings.first("profile_law")) is not None:
        environment["wind_profile"] = profile(law, settings)
    elevation = settings.first("elevations", "elevation")
    wind, drum = wind_of(settings), drum_of(settings)
    if len(lengths) > 1:
        kind, tables = "system", system(settings, lengths, tether, environment, elevation)
        about = f"the wind, an input of the FMU: wind_velocity = {wind}; where on the kite each line ends"
        said = tables["lines.line1"]
    else:
        kind, tables, said = "scene", scene(settings, tether, environment, elevation, wind), tether
        about = "the motion of the kite, which is parked downwind here, at the end of the tether: give another [flight]"
    defaults = [] if elevation is not None else [f"elevation of the kite = {ELEVATION:g} deg"]
    for section, record, given, names in (
        ("tether", Tether, said, (*TETHER, "axial_stiffness")),
        ("environment", Environment, environment, (*ENVIRONMENT, *OF_AIR)),
    ):
        defaults += [f"{section}.{name} = {getattr(record, name):g}" for name in names if name not in given]
    left_out, notes = [about, *filter(None, [", ".join(settings.left_out())])], []
    if not settings.first(*STIFFNESS) and "axial_stiffness" in said:
        zero = settings.all(*STIFFNESS)
        why = f"{zero[0]} is 0" if zero else "the file has no axial_stiffness"
        notes.append(f"{why}: the stiffness is e_tether times the area, {said['axial_stiffness']:.6g} N")
    spare = []
    if drum and kind == "scene":
        spare.append(("winch", {"force": ""} | {name.removeprefix("winch_"): value for name, value in drum.items()}))
        notes.append("the winch of the file is a comment, [winch]: it needs a force, with which the winch pulls")
    elif drum:
        names = ", ".join(f"{name} = {value:.6g}" for name, value in drum.items())
        notes.append(f'the winch of the file, {names}: a line takes it beside winch_control = "force"')
    return Imported(kind, tables, left_out, defaults, notes, spare)


def lengths_of(settings):
    """Lengths of the tethers [m]: where all but the first are 0, as for models of one tether, the first alone."""
    found = settings.all(*LENGTHS)
    if found is None:
        elsewhere = "kite.struc_geometry_path" in settings.pairs
        where = "; SymbolicAWEModels.jl has it in the file kite.struc_geometry_path" if elsewhere else ""
        raise ValueError(f"initial.l_tethers (l_tether), the length of the tether, is missing{where}")
    key, count, lengths = found
    with row(count):
        for length in lengths if any(lengths[1:]) else lengths[:1]:
            value_of(Tether, "initial_length", length, f"{key}: ")
    return lengths if any(lengths[1:]) else lengths[:1]


def scene(settings, tether, environment, elevation, wind):
    """Tables of a scene; elevation [degrees] or None, wind [m/s]."""
    angle = f"{ELEVATION if elevation is None else elevation:g} deg"
    flight = {"kind": "parked", "distance": tether["initial_length"], "elevation": angle, "sway": 0.0}
    tables = {"": {"duration": settings.first("sim_time") or 60.0}, "flight": flight}
    tables |= {"tether": tether, "environment": environment, "wind": {"velocity": wind}}
    return tables | {"wanted": {"allowed_error": 0.01}}


def system(settings, lengths, tether, environment, elevation):
    """Tables of a system with lines from the ground to the kite, at the distance of the longest line."""
    angle, distance = radians(ELEVATION if elevation is None else elevation), max(lengths)
    tables = {"": {}, "points.ground": {"position": [0.0, 0.0, 0.0]}}
    tables["points.kite"] = {"position": [distance * cos(angle), 0.0, distance * sin(angle)]}
    segments = settings.first("segments", check=lambda value: value_of(Tether, "segments", int(value), "system.segments: "))
    for count, length in enumerate(lengths):
        own = {"initial_length": length} | ({"segments": int(segments)} if segments else {})
        if diameter := settings.first(DIAMETERS[min(count, 1)]):
            own |= {"diameter": 1e-3 * diameter} | stiffness(settings, 1e-3 * diameter)
        tables[f"lines.line{count + 1}"] = {"from": "ground", "to": "kite"} | tether | own
    return tables | {"environment": environment}


def wind_of(settings):
    """Wind at the reference height [m/s], x downwind: from `wind_vec` if `use_wind_vec` is true, else from `v_wind`."""
    if settings.flag("use_wind_vec"):
        found = settings.all("wind_vec")
        if found is None or len(found[2]) != 3:
            raise ValueError("environment.use_wind_vec is true; wind_vec must be three numbers")
        return [hypot(*found[2][:2]), 0.0, found[2][2]]
    speed, upwind = settings.first("v_wind") or 0.0, radians(settings.first("upwind_elevation") or 0.0)
    return [speed * cos(upwind), 0.0, -speed * sin(upwind) if upwind else 0.0]


def drum_of(settings):
    """Quantities of the winch at the rope, as `Winch` names them; those that the file has."""
    found = {}
    if all(settings.all(name) for name in DRUM):
        inertia, ratio, radius = (settings.first(name) for name in DRUM)
        if not radius > 0.0:
            raise ValueError(f"row {settings.all('drum_radius')[1]}: winch.drum_radius is {radius:g} m; it must be above 0")
        found["winch_mass"] = inertia * (ratio / radius) ** 2
    for name, key in (("winch_friction", "f_coulomb"), ("winch_damping", "c_vf")):
        if (value := settings.first(key)) is not None:
            found[name] = value
    for name, value in found.items():
        value_of(Winch, name, value, "winch: ")
    return found


def stiffness(settings, diameter):
    """E A of the spring, or where that is 0 or not there, of the modulus; {} without both.  diameter [m]."""
    spring = settings.first(*STIFFNESS, check=lambda value: value and value_of(Tether, "axial_stiffness", value, "tether: "))
    if spring:
        return {"axial_stiffness": spring}
    modulus = settings.first("e_tether")
    return {"axial_stiffness": modulus * pi / 4.0 * diameter**2} if modulus else {}


def air(settings):
    """Quantities of the air; {} without its density."""
    density = settings.first("rho_0")
    if density is None:
        return {}
    temperature, height = settings.first("temp_ref"), settings.first("height_gnd") or 0.0
    warm = (STANDARD + ZERO_CELSIUS) / ((STANDARD if temperature is None else temperature) + ZERO_CELSIUS)
    return {"air_density": density * warm * exp(-height / SCALE_HEIGHT), "air_density_scale_height": SCALE_HEIGHT}


def profile(law, settings):
    """`wind_profile` of a `profile_law`; ValueError for ambiguous numbers and unknown laws."""
    if law not in LAWS:
        key, count, _ = settings.all("profile_law")
        raise ValueError(
            f"row {count}: {key} is {settings.pairs[key][1]}; it must be 0 (constant), 1 (EXP), 2 (LOG) or 3 (EXPLOG): "
            "what 4 to 6 are depends on the version of AtmosphericModels.jl"
        )
    return LAWS[law]
