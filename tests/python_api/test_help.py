"""`help` of each public name: what it is, its arguments with units, and examples that run."""

import doctest
import importlib
import inspect

import pytest

import tetherfmu
from tetherfmu.runtime.quantities import quantities

PUBLIC = [name for name in tetherfmu.__all__ if name not in ("__version__", "MATERIALS")]
MODULES = ("python.energy", "python.models", "python.results", "wiring.lines", "records.materials", "records.paths")
MODULES += ("records.problems", "wiring.winches", "runtime.outputs", "runtime.parameters")
MODULES += ("wind.frozen_turbulence", "wind.wind_boxes")


@pytest.mark.parametrize("name", MODULES)
def test_examples_run(name):
    result = doctest.testmod(importlib.import_module(f"tetherfmu.{name}"))
    assert result.failed == 0
    assert result.attempted > 0


@pytest.mark.parametrize("name", PUBLIC)
def test_every_public_name_says_what_it_is(name):
    found = getattr(tetherfmu, name)
    assert len(inspect.getdoc(found)) > 60
    assert ">>>" in inspect.getdoc(found)
    for member, method in vars(found).items() if inspect.isclass(found) else ():
        if not member.startswith("_") and callable(method):
            assert inspect.getdoc(method), f"{name}.{member}"


@pytest.mark.parametrize("record", [tetherfmu.Tether, tetherfmu.Environment, tetherfmu.Solver])
def test_records_tell_units_meanings_and_ranges(record):
    found = list(quantities(record))
    assert len(found) >= 4
    for name, quantity in found:
        section = record.__doc__.partition(f"\n{name} : ")[2]
        assert quantity.meaning in section
        assert quantity.in_words() in section
        assert not quantity.unit or f"[{quantity.unit}]" in section


@pytest.mark.parametrize("name", [name for name in PUBLIC if inspect.isfunction(getattr(tetherfmu, name))])
def test_functions_have_types(name):
    signature = inspect.signature(getattr(tetherfmu, name))
    assert signature.return_annotation is not inspect.Signature.empty
    assert all(each.annotation is not inspect.Parameter.empty for each in signature.parameters.values())
