"""The C header of a native FMU for its hosts: value references, sizes, choices and the guid or instantiation token.

Hosts in C and C++ include it instead of reading the model description.
"""

import re
from functools import partial

from tetherfmu.runtime import __version__
from tetherfmu.wiring.variables import INPUT, LOCAL, OUTPUT, PARAMETER

from ..documents import meaning
from ..texts import filled
from .arrays_fmi3 import arrays
from .c_tables import c_text

PREFIX = "TETHER_"
HEADS = {INPUT: "inputs", OUTPUT: "outputs", LOCAL: "local variables", PARAMETER: "parameters"}
TYPES = {  # of FMI, for the kinds of variables
    2: {"Real": "Real", "Integer": "Integer", "Enumeration": "Integer", "Boolean": "Boolean"},
    3: {"Real": "Float64", "Integer": "Int32", "Enumeration": "Int64", "Boolean": "Boolean"},
}


def c_name(name, prefix=PREFIX):
    """A name in C for a variable or an element: TETHER_KITE_POSITION_1 for kite_position[1]."""
    return prefix + re.sub(r"\W+", "_", name.rstrip("]")).upper()


def text(file, identifier, wiring, fmi, token, prefix):
    """Text of the header of a native FMU.

    file : name of the FMU without ending.  identifier : model identifier.  wiring : `wiring.fmu.Wiring`.  fmi : 2 or 3.
    token : guid of FMI 2, instantiation token of FMI 3.  prefix : of the names.
    """
    listed, named = arrays(wiring), partial(c_name, prefix=prefix)
    parts = [_enumeration(HEADS[causality], _references(wiring, listed, fmi, causality, named)) for causality in HEADS]
    if fmi == 3:
        time = (named("time"), wiring.ends[2], "Float64 [s]: simulation time")
        parts.append(_enumeration("independent", [time]))
    sizes = ((f"{named(each.name)}_SIZE", len(each.variables), "") for each in listed if each.dimensions)
    numbered = ((named(each.name), *pair) for each in wiring.shown for pair in each.quantity.numbers.items())
    choices = ((f"{name}_{choice.upper()}", number, "") for name, choice, number in numbered)
    parts += [_enumeration("numbers of values", sizes), _enumeration("choices", choices)]
    return filled(
        "host_header.h",
        file=file,
        fmi=fmi,
        version=__version__,
        guard=re.sub(r"\W", "_", f"{prefix}{file}_{token.strip('{}')}_h", flags=re.ASCII).upper(),
        prefix=prefix,
        identifier=c_text(identifier),
        token_name="GUID" if fmi == 2 else "INSTANTIATION_TOKEN",
        token=c_text(token),
        body="\n\n".join(filter(None, parts)),
    )


def write(fmu, identifier, wiring, fmi, token, prefix):
    """Write the header of a native FMU beside it; fmu : its path.  Other arguments as for `text`."""
    made = text(fmu.stem, identifier, wiring, fmi, token, prefix)
    fmu.with_suffix(".h").write_text(made, encoding="utf-8", newline="\n")


def _references(wiring, listed, fmi, causality, named):
    """Names, value references and comments of the variables of a causality: in FMI 3 of arrays, in FMI 2 of all elements."""
    if fmi == 3:
        found = [(each.name, each.reference, each.variables) for each in listed]
    else:
        found = [(each.name, each.place, (each,)) for each in wiring.shown]
    for name, reference, variables in found:
        first = variables[0]
        if first.causality == causality:
            unit = f" [{first.quantity.unit}]" if first.quantity.unit else ""
            yield named(name), reference, f"{TYPES[fmi][first.kind]}{unit}: {meaning(variables)}"


def _enumeration(head, rows):
    """A C enumeration of triples (name, number, comment), or an empty text if there are none."""
    lines = [f"    {name} = {number},{f' /* {comment} */' if comment else ''}" for name, number, comment in rows]
    lines[-1:] = [line.replace(",", "", 1) for line in lines[-1:]]
    return "\n".join([f"enum {{ /* {head} */", *lines, "};"]) if lines else ""
