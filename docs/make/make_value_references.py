"""Write docs/reference/value_references.md from the table of FMI variables: `python docs/make/make_value_references.py`."""

from pathlib import Path

from make_interface import table
from tetherfmu.export.native.arrays import arrays
from tetherfmu.export.native.host_header import TYPES, c_name
from tetherfmu.fmi.resources import DEFAULT_OPTIONS
from tetherfmu.fmi.wiring import of_tether
from tetherfmu.runtime.variables import INPUT, LOCAL, OUTPUT, PARAMETER, variables

PAGE = Path(__file__).resolve().parents[1] / "reference" / "value_references.md"
POINTS = DEFAULT_OPTIONS["shape_points"]
TEXT = """# Value references

<!-- Written by docs/make/make_value_references.py from the sources: edit those, and run it again. -->

For hosts that name variables by number. They are the same in both flavours and in all tethers; only those of the parameters
and of the time depend on the points of the shape, here {points} (`--shape-points`): with K points they are greater by
3 (K - {points}). A vector is one variable of FMI 3, whose value reference is that of its first element in FMI 2; the others
follow it. What the variables mean: [Interface](../use/interface.md).

`tetherfmu build --native --header` writes a C header with the value references of an FMU under the names of the last column
([Hosts in C and C++](../use/importing.md#hosts-in-c-and-c-tested)).

## Inputs

{inputs}

## Outputs

{outputs}

## Local variables

{local}

## Parameters

{parameters}

## A free kite end

`TetherDynamicFree.fmu` has these instead of the inputs `kite_position` and `kite_velocity`, and more parameters:

{free}

In FMI 3 the time has the value reference {time} ({free_time} in `TetherDynamicFree.fmu`).
"""


def wiring(variant):
    """Where the variables of a tether stand."""
    return of_tether(variant, variables(variant, POINTS), POINTS)


def rows(found):
    """Markdown table of `native.arrays.Array`."""
    cells = []
    for each in found:
        count, last = len(each.variables), each.reference + len(each.variables) - 1
        kind, header = each.variables[0].kind, c_name(each.name)
        names = f"`{header}`"
        if each.dimensions:
            ends = [f"`{c_name(each.variables[k].name)}`" for k in (0, -1)]
            names = f"{ends[0]} to {ends[1].replace(header, '')}; {names}"
        references = str(each.reference) if count == 1 else f"{each.reference} to {last}"
        types = f"{TYPES[2][kind]}, {TYPES[3][kind]}"
        cells.append((f"`{each.name}`", references, types, names))
    return table(("variable", "value reference", "type in FMI 2, 3", "in the header: FMI 2; FMI 3"), cells)


def page():
    """Text of docs/reference/value_references.md."""
    wirings = wiring("dynamic"), wiring("dynamic_free")
    driven, free = map(arrays, wirings)
    known = {(each.name, each.reference) for each in driven}
    kinds = INPUT, OUTPUT, LOCAL, PARAMETER
    of = {each: [array for array in driven if array.variables[0].causality == each] for each in kinds}
    return TEXT.format(
        points=POINTS,
        inputs=rows(of[INPUT]),
        outputs=rows(of[OUTPUT]),
        local=rows(of[LOCAL]),
        parameters=rows(of[PARAMETER]),
        free=rows([each for each in free if (each.name, each.reference) not in known]),
        time=wirings[0].ends[2],
        free_time=wirings[1].ends[2],
    )


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
