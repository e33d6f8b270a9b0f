"""Inputs, outputs and variants are declared once: the places, names and texts made from the tables fit together."""

import ast
import re
from itertools import pairwise

import pytest

import tetherfmu
from tetherfmu.commands.build import parse
from tetherfmu.console.colours import PALETTE
from tetherfmu.export.archive import SLAVES
from tetherfmu.python import models
from tetherfmu.runtime import enumerations, inputs, layout, outputs, status
from tetherfmu.runtime.parameters import Environment
from tetherfmu.runtime.quantities import quantities
from tetherfmu.runtime.variants import EVERY_VARIANT, TABLE, VARIANTS, class_name, variant_of
from tetherfmu.wiring.variables import PARAMETER, PARAMETERS, variables

every_variant = pytest.mark.parametrize("variant", TABLE, ids=lambda variant: variant.name)


def written_in(module):
    """Names that the statements of a module assign."""
    with open(module.__file__, encoding="utf-8") as file:
        tree = ast.parse(file.read())
    return {node.id for node in ast.walk(tree) if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)}


def test_each_place_has_a_name_of_its_own():
    """A table must not overwrite what `layout` says itself; an output with the name of an input has OUTPUT_ in front."""
    of_inputs = {name.upper(): place for name, place in inputs.PLACES.items()}
    names = {name: f"OUTPUT_{name}" if name in inputs.PLACES else name for name in outputs.PLACES}
    of_outputs = {names[name].upper(): place for name, place in outputs.PLACES.items()}
    assert not of_inputs.keys() & of_outputs.keys()
    assert (of_inputs.keys() | of_outputs.keys()) & written_in(layout) == {"SHAPE"}
    for name, place in (of_inputs | of_outputs).items():
        assert getattr(layout, name) == place


def test_what_is_no_choice_is_below_all_choices():
    """A law of the wind more, or a choice more of any parameter, must not mean wind at the nodes."""
    assert min(number for each in PARAMETERS for number in each.quantity.numbers.values()) == 1
    numbers = {name: number for name, number in vars(enumerations).items() if isinstance(number, int)}
    assert [name for name, number in numbers.items() if number < 1] == ["AT_NODES"]
    declared = dict(quantities(Environment))["wind_profile"].numbers
    laws = {name: numbers[name.upper()] for name in declared}
    assert laws == declared


def test_each_scalar_of_the_parameters_has_a_place_of_its_own():
    """A parameter must not take the name of anything else in `layout`: an input, an output, a number of the state."""
    declared = [each.name.upper() for each in PARAMETERS if hasattr(layout, each.name.upper())]
    others = ["GROUND_IS_FREE", "KITE_IS_FREE", "CALM_LAYER", "WIND_POINTS", "TORN_NOW", "CAN_BREAK"]
    others += [f"WHOLE_{what}" for what in ("STIFFNESS", "DAMPING", "DRAG_WIDTH", "CONTROL")]
    others += ["IS_PORTION", "GIVEN_PORTION", "SHEAVE_MASS", "SHEAVE_FRICTION", "SHEAVE_EFFICIENCY", "PULLS_BACK"]
    others += ["LENGTH_BEYOND", "LEAST_LENGTH", "WINCH_IS_BRAKED", "IS_PARTED", "FIRST_ENDS", "SECOND_BEGINS"]
    others += ["REST_BETWEEN", "FIRST_PASSING", "WHOLE_SHARE", "WHOLE_DENSITY"]
    places = [getattr(layout, name) for name in (*declared, *others)]
    for first in (layout.HELD_BY, layout.HELD_RATIO):
        places += range(first, first + layout.MOST_HOLDERS)
    assert sorted(places) == list(range(layout.PARAMETER_SCALARS))
    taken = {name.upper() for name in (*inputs.PLACES, *outputs.PLACES)} | written_in(layout)
    assert not set(declared) & taken


@pytest.mark.parametrize(("table", "end"), [(inputs, layout.INPUTS), (outputs, layout.outputs_size(1))])
def test_arrays_have_no_gap(table, end):
    places = [*table.PLACES.values(), end]
    sizes = [table.BY_NAME[name].size for name in table.PLACES]
    assert [after - before for before, after in pairwise(places)] == sizes
    assert places[0] == 0


@every_variant
def test_a_variant_speaks_of_what_exists(variant):
    known = {each.name for each in variables(variant.name, 3)}
    parameters = {each.name for each in variables(variant.name, 3) if each.causality == PARAMETER}
    assert set(variant.ignored) <= parameters
    assert set(variant.meanings) <= set(outputs.BY_NAME)
    assert {name.partition("[")[0] for name in variant.depends_on} <= set(outputs.BY_NAME)
    for each in variables(variant.name, 3):
        assert set(each.depends_on or ()) <= known
    assert variant.colour in PALETTE


def test_colours_tell_variants_apart():
    assert len({variant.colour for variant in TABLE}) == len(TABLE)


def test_the_record_says_of_each_output_what_it_is():
    documented = tetherfmu.Outputs.__doc__
    for each in outputs.OUTPUT_TABLE:
        section = documented.partition(f"\n{each.name} : ")[2].partition("\n")
        kind = {"Integer": "int", "Real": "float", "Boolean": "bool"}[each.kind]
        assert section[0] == {(): kind, (3,): "(3,) array", ("points", 3): "(points, 3) array"}[each.shape]
        assert section[2].startswith(f"    {each.quantity.meaning}")
    with pytest.raises(TypeError, match=f"missing {len(outputs.OUTPUT_TABLE)} required"):  # declarations are no defaults
        tetherfmu.Outputs()


def test_status_codes_have_a_sentence_each_and_no_gap():
    """The C shell finds a sentence by its place."""
    codes = [each for name, each in vars(status).items() if name.isupper() and isinstance(each, int)]
    assert sorted(codes) == sorted(status.SENTENCES) == list(range(len(codes)))


# --- a variant by any of its names: in the code, on the command line, as a class, as an FMU


every_name = pytest.mark.parametrize("variant", EVERY_VARIANT)


@every_name
def test_every_spelling(variant):
    words = variant.split("_")
    for text in (variant, "-".join(words), " ".join(words), "".join(words), variant.upper(), class_name(variant)):
        assert variant_of(text) == variant
    assert variant_of(f"tether_{variant}") == variant


@pytest.mark.parametrize("text", ["", "tether", "dynamics", "quasi", "TetherDynamic.fmu", "all", "dynamic catenary"])
def test_another_text_is_named(text):
    with pytest.raises(ValueError, match="no tether is called") as refusal:
        variant_of(text)
    assert f"called {text};" in str(refusal.value)
    (hint,) = re.findall("; (did you mean|choose from) ", str(refusal.value))
    if hint == "choose from":
        assert all(variant in str(refusal.value) and class_name(variant) in str(refusal.value) for variant in EVERY_VARIANT)


@every_name
def test_one_list_for_all(variant):
    assert getattr(models, class_name(variant)).variant == variant
    assert SLAVES[class_name(variant)] == variant


def test_a_list_without_free_ends():
    """As the example asks that flies a driven kite."""
    with pytest.raises(ValueError, match="no tether is called dynamic-free; did you mean dynamic") as refusal:
        variant_of("dynamic-free", VARIANTS)
    assert "TetherDynamicFree" not in str(refusal.value)


def test_builder_takes_every_spelling(capsys):
    assert parse(["quasi-steady", "dynamic", "TetherStraight", "dynamic-free"]).names == [
        "TetherQuasiSteady",
        "TetherDynamic",
        "TetherStraight",
        "TetherDynamicFree",
    ]
    with pytest.raises(SystemExit):
        parse(["elastic"])
    assert "no tether is called elastic; choose from straight (TetherStraight)" in capsys.readouterr().err
