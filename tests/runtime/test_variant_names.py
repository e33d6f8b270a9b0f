"""A variant by any of its names: in the code, on the command line, as a class, as an FMU."""

import re

import pytest

from tetherfmu.commands.build import parse
from tetherfmu.export.archive import SLAVES
from tetherfmu.python import models
from tetherfmu.runtime.variants import EVERY_VARIANT, VARIANTS, class_name, variant_of

every_variant = pytest.mark.parametrize("variant", EVERY_VARIANT)


@every_variant
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


@every_variant
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
