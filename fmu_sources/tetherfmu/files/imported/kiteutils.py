"""Settings of KiteUtils.jl, KiteModels.jl and Tethers.jl (`settings.yaml`) as a scene: a kite parked at its tether.

Of YAML it reads what such files have: sections at the margin, in them indented `key: value`; `#` begins a comment. Rows that
are no such pairs, as of a list over several rows, are passed over.

Air there is rho_0 at 15 degrees Celsius and sea level; at the ground station of the height h and the temperature T it is

    rho_0 288.15/(T + 273.15) exp(-h/8550)

Source: AtmosphericModels.jl, `calc_rho`, `calc_wind_factor`, `ProfileLaw`.
"""

import re
from math import exp, pi

from tetherfmu.files.toml_files import value_of
from tetherfmu.runtime.layout import EXPLOG, LOGARITHMIC, POWER_LAW, UNIFORM
from tetherfmu.runtime.parameters import Environment, Tether

from .written import Imported, number, row

ROW = re.compile(r"(?P<indent>\s*)(?P<key>[\w-]+)\s*:(?:\s+(?P<value>.*))?$")
HAS_IT = re.compile(r"^tether\s*:", re.MULTILINE)
SCALE_HEIGHT, ZERO_CELSIUS, STANDARD = 8550.0, 273.15, 15.0  # [m], [K], temperature of rho_0 [degrees Celsius]
LAWS = {0: UNIFORM, 1: POWER_LAW, 2: LOGARITHMIC, 3: EXPLOG}  # `profile_law`: `wind_profile`
# quantity of a scene: keys that say it, the first that is there counts, and the factor to its unit
TETHER = {
    "initial_length": (("initial.l_tether", "initial.l_tethers"), 1.0),
    "diameter": (("tether.d_tether",), 1e-3),
    "density": (("tether.rho_tether",), 1.0),
    "axial_damping": (("tether.damping", "tether.unit_damping"), 1.0),
    "drag_coefficient": (("tether.cd_tether",), 1.0),
}
ENVIRONMENT = {
    "gravity": (("system.g_earth",), 1.0),
    "wind_reference_height": (("environment.h_ref",), 1.0),
    "wind_exponent": (("environment.alpha",), 1.0),
    "surface_roughness": (("environment.z0",), 1.0),
}
OF_AIR = ("air_density", "wind_profile")
ELEVATION = ("initial.elevation", "initial.elevations")


class Settings:
    """The pairs of a file, as "section.key" -> (row, text), and which of them have been used."""

    def __init__(self, text):
        self.pairs, self.used, section = {}, set(), ""
        for count, line in enumerate(text.splitlines(), start=1):
            found = ROW.match(re.sub(r"(^|\s)#.*", "", line).rstrip())
            if found and not found["indent"]:
                section = found["key"]
            if found and (found["indent"] or found["value"]):
                self.pairs[f"{section}.{found['key']}"] = count, (found["value"] or "").strip().strip("\"'")

    def first(self, *keys, check=lambda value: None):
        """The number of the first of some keys that is there, or all equal ones of a list; None if none is.

        check : raises ValueError for what cannot be. ValueError names the row.
        """
        key = next((key for key in keys if key in self.pairs), None)
        if key is None:
            return None
        self.used.add(key)
        count, text = self.pairs[key]
        with row(count):
            values = {number(key, each) for each in text.strip("[] ").split(",")}
            if len(values) > 1:
                raise ValueError(f"{key} is {text}: several tethers, of which a scene has one; leave one value")
            (value,) = values
            check(value)
            return value

    def all_of(self, table, kind):
        """Dict of quantities of a record that are there, of a table as `TETHER`; ValueError names the row of a wrong one."""
        found = {}
        for name, (keys, factor) in table.items():
            value = self.first(*keys, check=lambda value: value_of(kind, name, factor * value, f"{keys[0]}: "))  # noqa: B023
            if value is not None:
                found[name] = factor * value
        return found

    def left_out(self):
        """Names of what has not been used; of a section of which nothing has its name alone."""
        kept = {key.partition(".")[0] for key in self.used}
        others = ((key, key.partition(".")[0]) for key in self.pairs if key not in self.used)
        return list(dict.fromkeys(key if section in kept else section for key, section in others))


def scene(text):
    """`Imported` of the text of a file; ValueError names the row of what is wrong."""
    settings = Settings(text)
    tether, environment = settings.all_of(TETHER, Tether), settings.all_of(ENVIRONMENT, Environment)
    if "initial_length" not in tether:
        raise ValueError("initial.l_tether, the length of the tether, is missing")
    tether |= stiffness(settings, tether.get("diameter", Tether.diameter))
    environment |= air(settings)
    if (law := settings.first("environment.profile_law")) is not None:
        environment["wind_profile"] = profile(law, settings)
    flight = {"kind": "parked", "distance": tether["initial_length"], "sway": 0.0}
    if (elevation := settings.first(*ELEVATION)) is not None:
        flight["elevation"] = f"{elevation:g} deg"
    tables = {"": {"duration": settings.first("system.sim_time") or 60.0}, "flight": flight}
    tables |= {"tether": tether, "environment": environment}
    tables["wind"] = {"velocity": [settings.first("environment.v_wind") or 0.0, 0.0, 0.0]}
    tables["wanted"] = {"allowed_error": 0.01}
    about = "the motion of the kite, which is parked downwind here, at the end of the tether: give another [flight]"
    left_out = [about, *filter(None, [", ".join(settings.left_out())])]
    defaults = []
    kinds = ("tether", Tether, (*TETHER, "axial_stiffness")), ("environment", Environment, (*ENVIRONMENT, *OF_AIR))
    for section, kind, names in kinds:
        others = (name for name in names if name not in tables[section])
        defaults += [f"{section}.{name} = {getattr(kind, name):g}" for name in others]
    return Imported("scene", tables, left_out, defaults)


def stiffness(settings, diameter):
    """E A of the spring, or where that is 0 or not there, of the modulus; {} without both.  diameter [m]."""
    spring, modulus = settings.first("tether.c_spring", "tether.unit_stiffness"), settings.first("tether.e_tether")
    found = spring or (modulus and modulus * pi / 4.0 * diameter**2)
    return {"axial_stiffness": found} if found else {}


def air(settings):
    """Quantities of the air; {} without its density."""
    density = settings.first("environment.rho_0")
    if density is None:
        return {}
    temperature, height = settings.first("environment.temp_ref"), settings.first("environment.height_gnd") or 0.0
    warm = (STANDARD + ZERO_CELSIUS) / ((STANDARD if temperature is None else temperature) + ZERO_CELSIUS)
    return {"air_density": density * warm * exp(-height / SCALE_HEIGHT), "air_density_scale_height": SCALE_HEIGHT}


def profile(law, settings):
    """`wind_profile` of a `profile_law`; ValueError for those that programs number in two ways, and unknown ones."""
    if law not in LAWS:
        count, text = settings.pairs["environment.profile_law"]
        raise ValueError(
            f"row {count}: environment.profile_law is {text}; it must be 0 (constant), 1 (EXP), 2 (LOG) or 3 (EXPLOG): "
            "what 4 to 6 are depends on the version of AtmosphericModels.jl"
        )
    return LAWS[law]
