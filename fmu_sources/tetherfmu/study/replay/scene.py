"""A measured flight as a scene for the advisor, and for an FMU that has its values."""

import json
import re

import numpy as np

from tetherfmu.console.ending import FAILED
from tetherfmu.console.progress import now
from tetherfmu.export import archive
from tetherfmu.export.build_options import BuildOptions
from tetherfmu.files.toml_files import GROUND
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.kernel_library import this_platform
from tetherfmu.runtime.quantities import quantities
from tetherfmu.study.advice import scene_build

from .driven_tethers import words
from .readings import WIND

FILE, SERIES = "scene.toml", "flight.csv"
FROM_SERIES = ("segments", "initial_length")  # of a tether: omitted in the table [tether]
# required output, allowed error, and reason
TAUT = ("kite_force", "ground_force"), 0.05, "The tether is taut for most of the time: its forces count."
HANGING = "The tether is slack for most of the time: its forces change from moment to moment, so its shape counts."
SLACK = ("shape",), 0.03, HANGING
MOST = 0.5  # slack fraction of the time above which its shape counts
UNUSUAL = re.compile(r"[^\w .~-]", re.ASCII)  # characters that some hosts cannot have in the path of an FMU


def series(made):
    """Inputs of a tether along a `Replay`, a DataFrame with the column `time` from 0 on, and the number of omitted times.

    The winch follows the length that drove it, or the result of the finest tether; with speed control the speed. Times
    without this value are omitted: a missing reading, or a refused step.
    """
    flight, times = made.flight, made.flight.times
    table = flight.signals().assign(time=np.round(times - times[0], 9))
    if not table[[*WIND]].any(axis=None):
        table = table.drop(columns=[*WIND])
    if made.lead == "speed":
        table["reel_out_speed"] = flight.measured("reel_out_speed", times)
    else:
        found = flight.length(times) if made.lead == "length" else made.finest[1].table.tether_length.to_numpy()
        table["winch_length"] = found
    known = table.dropna()
    return known, len(table) - len(known)


def toml(made, name):
    """Text of the scene file of a `Replay`; name : of its log."""
    (table, left_out), (outputs, allowed, why) = series(made), SLACK if made.is_slack.mean() > MOST else TAUT
    found, variant = made.flight.log.map, words(made.finest[0])
    length = {"tension": f"that of the {variant} tether under the measured tension", "length": "that of the log"}
    name, about = UNUSUAL.sub("_", name), " ".join((found.about or found.name).split())
    lines = [f"# The measured flight {name} ({about}).", f"# {why}"]
    if made.lead in length:
        lines.append(f"# The length in {SERIES} is {length[made.lead]}.")
    if left_out:
        lines.append(f"# {left_out} times are left out, at which it is not known.")
    lines += [f"name = {quoted(name)}", f"duration = {float(table.time.iloc[-1])!r} # s", ""]
    lines += ["[flight]", 'kind = "series"', f"file = {quoted(SERIES)}", ""]
    lines += section("tether", found.tether, FROM_SERIES)
    if made.lead == "speed":
        lines.insert(-1, f"initial_length = {float(made.finest[1].table.tether_length.iloc[0])!r} # m")
    lines += section("environment", found.environment)
    if found.ground.ground_contact == at.FLAT:
        lines += section("ground", found.ground)
    names = ", ".join(map(quoted, outputs))
    return "\n".join([*lines, "[wanted]", f"outputs = [{names}]", f"allowed_error = {allowed}", ""])


def section(name, record, without=()):
    """Lines of a table of a scene file with all quantities of a record, an enumeration by its name, and an empty line."""
    lines = [f"[{name}]"]
    for key, declared in quantities(record):
        if key not in without:
            value = getattr(record, key)
            text = quoted(list(declared.choices)[value - 1]) if declared.choices else repr(float(value))
            unit = f" # {declared.unit}" if declared.unit else ""
            lines.append(f"{key.removeprefix(GROUND) if name == 'ground' else key} = {text}{unit}")
    return [*lines, ""]


def quoted(text):
    """A text as TOML has it."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007F")


def build(place):
    """Build the advised FMU for the scene in a folder, and print its path; returns 1 if nothing meets the requirements.

    Its start values are the values of the scene, see `advice.scene_build`.  SceneError if the scene fails.
    """
    now("flying the scene with candidates and a finer model")
    text, met, name, options = scene_build.advised(place / FILE, BuildOptions.shape_points, (this_platform(),))
    print(text)
    if not met:
        return FAILED
    print(archive.build(name, place, options))
    return 0


def write(made, place, name):
    """Write the scene and its series to a folder; returns their paths."""
    (place / FILE).write_text(toml(made, name), encoding="utf-8")
    series(made)[0].to_csv(place / SERIES, index=False, float_format="%.9g")
    return [place / FILE, place / SERIES]
