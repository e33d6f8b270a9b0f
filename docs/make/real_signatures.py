"""Sphinx extension: signatures of the Python API with types, defaults, and all arguments by their names.

What a class hands on to its base (`*arguments`, `**options`) becomes the arguments of the base; inputs that are declared as
a TypedDict (`**inputs`) become keywords, whose default `...` means that they keep their values.
"""

import ast
import inspect
import re
import sys
from dataclasses import is_dataclass
from inspect import Parameter

from numpy.typing import ArrayLike, NDArray

HANDED_ON = "arguments"  # name of the positional arguments that a class hands on
KEPT = type("Kept", (), {"__repr__": lambda self: "..."})()


def text(annotation):
    """A type as it is written."""
    if isinstance(annotation, str):
        written = annotation
    else:
        written = inspect.formatannotation(annotation)
        for alias, name in ((ArrayLike, "ArrayLike"), (NDArray, "NDArray")):
            written = written.replace(inspect.formatannotation(alias), name)
    return re.sub(r"\b(?:[a-z_]\w*\.)+(?=[A-Z]|ndarray)", "", written).replace("Vectors", "Mapping[str, ArrayLike]")


def inputs_of(parameter, module):
    """Keywords of a `**inputs: Unpack[Some]`, or the parameter itself."""
    name = text(parameter.annotation).rpartition("Unpack[")[2].rstrip("]").rpartition(".")[2]
    declared = getattr(sys.modules[module], name, None)
    if not hasattr(declared, "__total__"):
        return [parameter]
    return [
        Parameter(each.target.id, Parameter.KEYWORD_ONLY, default=KEPT, annotation=ast.unparse(each.annotation))
        for kind in (*declared.__orig_bases__, declared)
        if hasattr(kind, "__total__")
        for each in ast.parse(inspect.getsource(kind)).body[0].body
        if isinstance(each, ast.AnnAssign)
    ]


def parameters_of(obj):
    """All parameters of a class or a function."""
    listed = list(inspect.signature(obj).parameters.values())
    if inspect.isclass(obj) and listed and listed[0].name == HANDED_ON:
        own = [each for each in listed if each.kind is Parameter.KEYWORD_ONLY]
        base = parameters_of(obj.__mro__[1])
        names = {each.name for each in own}
        return [*(each for each in base[:-1] if each.name not in names), *own, base[-1]]
    module = obj.__module__
    if listed and listed[-1].kind is Parameter.VAR_KEYWORD:
        listed[-1:] = [each for each in inputs_of(listed[-1], module) if each.name not in {one.name for one in listed[:-1]}]
    return [each for each in listed if not each.name.startswith("_") and each.name != "self"]


def shown(value):
    """A default, a record by its name alone."""
    return f"{type(value).__name__}()" if is_dataclass(value) else repr(value)


def written(parameters):
    """Text of a signature."""
    parts, keywords = [], False
    for each in parameters:
        if each.kind is Parameter.KEYWORD_ONLY and not keywords:
            parts, keywords = [*parts, "*"], True
        stars = {Parameter.VAR_POSITIONAL: "*", Parameter.VAR_KEYWORD: "**"}.get(each.kind, "")
        keywords |= stars == "*"
        kind = "" if each.annotation is Parameter.empty else f": {text(each.annotation)}"
        equals = " = " if kind else "="
        default = "" if each.default is Parameter.empty else f"{equals}{shown(each.default)}"
        parts.append(f"{stars}{each.name}{kind}{default}")
    return f"({', '.join(parts)})"


def real(app, what, name, obj, options, signature, returns):
    """Signature of a class, a function or a method, and what it returns."""
    if not signature or what not in ("class", "exception", "function", "method"):
        return signature, returns
    found = inspect.signature(obj).return_annotation if what in ("function", "method") else inspect.Signature.empty
    return written(parameters_of(obj)), None if found in (inspect.Signature.empty, None, "None") else text(found)


def setup(app):
    """Connect it."""
    app.connect("autodoc-process-signature", real)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
