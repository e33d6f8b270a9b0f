"""Write docs/reference/variables.md from the table of FMI variables: `python docs/make/make_variables.py`."""

from pathlib import Path

from tetherfmu.export.documents import folded, meaning, start
from tetherfmu.export.native.arrays_fmi3 import arrays
from tetherfmu.export.native.host_header import TYPES
from tetherfmu.files.lean import PRESETS, Lean
from tetherfmu.fmi.resources import DEFAULT_OPTIONS
from tetherfmu.runtime.inputs import WIND_AT
from tetherfmu.runtime.variants import TABLE, class_name
from tetherfmu.wiring.fmu import of_tether
from tetherfmu.wiring.selection import GROUPS, in_order
from tetherfmu.wiring.variables import INPUT, LOCAL, OUTPUT, PARAMETER, variables

PAGE = Path(__file__).resolve().parents[1] / "reference" / "variables.md"
POINTS = DEFAULT_OPTIONS["shape_points"]
DYNAMIC, FREE = "dynamic", "dynamic_free"
ZERO = ": 0, "  # before the reason why an output is 0
LETTERS = {variant.name: "".join(filter(str.isupper, class_name(variant.name)[len("Tether") :])) for variant in TABLE}
TEXT = """---
hide-toc: true
---

# Variables

<!-- Written by docs/make/make_variables.py from the sources: edit those, and run it again. -->

For everyone who connects a tether FMU. [Signals and signs](../use/interface.md) explains the exchange.

```{{raw}} html
<p class="filter"><input type="search" placeholder="Filter: winch, force, DF, N/m ..." aria-label="Filter the variables"></p>
<script defer src="../_static/filter.js"></script>
```

The FMUs are {letters}. An FMU in brackets ignores the variable but checks its range.

Value references (VR) are the same in all FMUs. A vector is one array in FMI 3 with the VR of its first element. With K
shape points (`--shape-points`) the VR of parameters increase by 3 (K - {points}). The type is Real (FMI 3:
Float64) unless the VR column says {integer} or Boolean. [Groups](#groups-and-presets) are for lean FMUs.

## Inputs

{inputs}

`wind_at` needs the build option `--wind-points K` ([Wind at points](../use/interface.md#wind-at-points)).

## Outputs

{outputs}

## Local variables

Local variables can be read and plotted, but not connected. K is the build option `--shape-points`, {points} by default.
With `--wind-points` the shape is an output.

{local}

## Parameters

Set parameters before the end of initialization.

{parameters}

With `wind_profile` 3 or 4 `surface_roughness` must be less than `wind_reference_height`. `initial_length` must be at least
0.01 m per segment, and with force control between `shortest_length` and `longest_length`. The build option `--segments`
sets the start value of `segments`.

In FMI 3 the time variable has the VR {time}, in `TetherDynamicFree.fmu` {free_time}.

## In some FMUs

Some FMUs give these variables other meanings:

{meanings}

These FMUs ignore some parameters:

{ignored}

## Groups and presets

{groups}.

The table counts the FMI 2 variables of full FMUs and with each `--preset`:

{presets}

## Names in C

`tetherfmu build --native --header` writes [a C header](../use/importing.md#hosts-in-c-and-c-tested) with the value
references. Each name is `TETHER_` followed by the variable in capitals. FMI 2 appends the index: `TETHER_KITE_POSITION_1`.
To include the headers of several FMUs in one C file, give each its own prefix with `--header-prefix`, such as `LEAN_`.
"""


def table(head, rows):
    """Markdown table of rows of texts."""
    lines = ["|" + "|".join(row) + "|" for row in (head, *rows)]
    return "\n".join([lines[0], "|---" * len(head) + "|", *lines[1:]])


def limits(quantity):
    """The allowed range of a quantity, its unit aside; of an enumeration the meanings of its choices."""
    lowest, highest = (
        f"{limit:g}".replace("e+0", "e").replace("e-0", "e-") for limit in (quantity.minimum, quantity.maximum)
    )
    if quantity.choices or (lowest, highest) == ("-inf", "inf"):
        return quantity.in_words()
    return f">= {lowest}" if highest == "inf" else f"{lowest}…{highest}"


def has(variant, name, causality):
    """Whether a tether has a variable; the wind at points is of one that is built with it."""
    tables = variables(variant.name, POINTS), variables(variant.name, POINTS, wind_points=2)
    return (name, causality) in {(each.name, each.causality) for each in tables[name.startswith(f"{WIND_AT.name}[")]}


def letters(name, causality):
    """A cell for each FMU: its letters if it has a variable, in brackets where it ignores it."""
    cells = [LETTERS[variant.name] if has(variant, name, causality) else "" for variant in TABLE]
    return [f"({cell})" if name in variant.ignored else cell for variant, cell in zip(TABLE, cells, strict=True)]


def wiring(variant):
    """Where the variables of a tether stand."""
    return of_tether(variant, DEFAULT_OPTIONS | {"shape_points": POINTS})


def references():
    """Value references by name and causality."""
    found = {}
    for array in (*arrays(wiring(DYNAMIC)), *arrays(wiring(FREE))):
        last = array.reference + len(array.variables) - 1
        key = array.name, array.variables[0].causality
        found[key] = str(array.reference) if last == array.reference else f"{array.reference}-{last}"
    return found


def with_those_of_the_free_end(causality):
    """Variables of a causality of the two dynamic tethers."""
    listed = {v.name: v for v in in_order(variables(DYNAMIC, POINTS)) if v.causality == causality}
    listed |= {v.name: v for v in in_order(variables(FREE, POINTS)) if v.causality == causality}
    if causality == INPUT:
        at_points = variables(DYNAMIC, 0, wind_points=2)
        listed |= {v.name: v for v in at_points if v.name.startswith(f"{WIND_AT.name}[")}
    return listed.values()


def rows_of(causality):
    """Table of the variables of a causality."""
    head = ["name", "unit", "start", "allowed", *LETTERS.values(), "VR", "group", "meaning"]
    placed, rows = references(), []
    for name, each in folded(with_those_of_the_free_end(causality)):
        first, key = each[0], name.partition("[")[0]
        kind = "" if first.kind == "Real" else f" {first.kind}"
        begins = start(each) if first.start is not None else ""
        allowed = limits(first.quantity) if causality == PARAMETER else ""
        place = placed.get((key, causality), "") + kind
        has_it = letters(first.name, causality)
        rows.append([f"`{name}`", first.quantity.unit, begins, allowed, *has_it, place, f"`{first.group}`", meaning(each)])
    shown = [k for k in range(len(head)) if any(row[k] for row in rows)]
    return table([head[k] for k in shown], [[row[k] for k in shown] for row in rows])


def by_tether(field, last_column):
    """Table of what a field of `variants.Variant` says of variables, equal texts in one row; of a 0 only why it is 0."""
    fmus, names = {}, {}
    for variant in TABLE:
        for name, text in getattr(variant, field).items():
            fmus.setdefault((name, text[max(text.find(ZERO), 0) :].lstrip(": ")), []).append(LETTERS[variant.name])
    for (name, text), found in fmus.items():
        names.setdefault((" ".join(found), text), []).append(f"`{name}`")
    rows = [(", ".join(listed), found, text) for (found, text), listed in names.items()]
    return table(("name", "FMU", last_column), rows)


def presets():
    """Table of how many variables FMI 2 counts with each preset."""
    rows = []
    for preset in (None, *PRESETS):
        counts = []
        for variant in (DYNAMIC, FREE):
            full = variables(variant, POINTS)
            missing = Lean(preset=preset).left_out(full)
            counts.append(str(sum(each.name not in missing for each in full)))
        rows.append((f"`{preset}`" if preset else "full", *counts))
    return table(("preset", class_name(DYNAMIC), class_name(FREE)), rows)


def page():
    """Text of docs/reference/variables.md."""
    kinds = {"inputs": INPUT, "outputs": OUTPUT, "local": LOCAL, "parameters": PARAMETER}
    return TEXT.format(
        letters=", ".join(f"{LETTERS[each.name]} `{class_name(each.name)}`" for each in TABLE),
        integer=", ".join(f"{kind} (FMI 3: {TYPES[3][kind]})" for kind in ("Integer", "Enumeration")),
        **{key: rows_of(causality) for key, causality in kinds.items()},
        meanings=by_tether("meanings", "meaning"),
        ignored=by_tether("ignored", "why"),
        groups="; ".join(f"`{key}`: {what}" for key, what in GROUPS.items()),
        presets=presets(),
        points=POINTS,
        time=wiring(DYNAMIC).ends[2],
        free_time=wiring(FREE).ends[2],
    )


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
