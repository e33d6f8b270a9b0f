"""A name that does not exist is refused with the one that was probably meant, or with those that there are."""

import inspect
import pickle
import re
from dataclasses import replace
from math import pi

import pytest

from tetherfmu import (
    Environment,
    Ground,
    Line,
    MovingEnd,
    Point,
    Solver,
    Tether,
    TetherDynamic,
    TetherStraight,
    Winch,
    inputs_along,
    tether_of,
)
from tetherfmu.runtime.naming import ELSEWHERE, meant
from tetherfmu.runtime.quantities import quantities
from tetherfmu.wiring.variables import RECORDS

WRONG = {
    "Tether(length=)": (lambda: Tether(length=505.0), "Tether has no argument 'length'; did you mean initial_length?"),
    "Tether(EA=)": (lambda: Tether(EA=505.0), "Tether has no argument 'EA'; did you mean axial_stiffness?"),
    "Tether(xyz=)": (lambda: Tether(xyz=1.0), "Tether has no argument 'xyz'; there are segments, initial_length, diameter,"),
    "Ground(contact=)": (lambda: Ground(contact="flat"), "Ground has no argument 'contact'; did you mean ground_contact?"),
    "Winch(control=)": (lambda: Winch(control="force"), "Winch has no argument 'control'; did you mean winch_control?"),
    "Environment(rho=)": (lambda: Environment(rho=1.2), "Environment has no argument 'rho'; did you mean air_density?"),
    "Solver(rtol=)": (lambda: Solver(rtol=1e-5), "Solver has no argument 'rtol'; did you mean relative_tolerance?"),
    "Point(pos=)": (lambda: Point("a", pos=(0.0, 0.0, 0.0)), "Point has no argument 'pos'; did you mean position?"),
    "Line(speed=)": (lambda: Line("a", "b", "c", speed=1.0), "Line has no argument 'speed'; did you mean reel_out_speed?"),
    "MovingEnd(speed=)": (lambda: MovingEnd(abs, speed=abs), "MovingEnd has no argument 'speed'; there are position"),
    "TetherDynamic(l0=)": (lambda: TetherDynamic(l0=505.0), "no argument 'l0'; did you mean initial_length?"),
    "TetherDynamic(wind=)": (lambda: TetherDynamic(wind=8.0),
        "no argument 'wind'; did you mean wind_profile, wind_reference_height or wind_exponent?"),
    "initialize(wind_speed=)": (lambda: TetherStraight().initialize(wind_speed=8.0),
        "TetherStraight has no input 'wind_speed'; did you mean wind_velocity?"),
    "inputs_along(kite_position=)": (lambda: inputs_along(1, 0.02, kite_position=(0.0, 0.0, 1.0)),
        "inputs_along has no input 'kite_position'; did you mean kite?"),
    "tether_of(length=)": (lambda: tether_of("steel", 0.01, length=5.0), "did you mean initial_length?"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_is_refused_with_what_was_meant(name):
    call, said = WRONG[name]
    with pytest.raises(TypeError) as refused:
        call()
    assert said in str(refused.value)


def test_what_others_call_it_leads_to_names_that_exist():
    """Of a quantity, an input or an argument, a platform or a key of a scene; a name of ours is not translated."""
    from tetherfmu.libraries.ahead_of_time import TARGETS
    from tetherfmu.runtime.inputs import BY_NAME

    ours = {name for record in RECORDS for name, _ in quantities(record)} | set(BY_NAME) | set(TARGETS)
    ours |= {"mass_per_length", "kite_mass", "kite", "ground", "step", "communication_step", "tether_length"}
    assert {each for words in ELSEWHERE.values() for each in words.split()} <= ours
    assert not {*ELSEWHERE} & {name for record in RECORDS for name, _ in quantities(record)}


def test_a_name_that_is_like_none_asks_for_none():
    assert meant("colour", ["segments", "diameter"]) == ""


def test_records_are_made_as_before():
    """By place and by name; they are equal, copied and pickled as records are, and say what they take."""
    assert Tether(12, 30.0) == Tether(segments=12, initial_length=30.0)
    assert pickle.loads(pickle.dumps(Tether(12))) == replace(Tether(), segments=12)
    assert list(inspect.signature(Tether).parameters)[:2] == ["segments", "initial_length"]
    with pytest.raises(TypeError, match="multiple values"):
        Tether(12, segments=3)


def test_a_mass_per_length_is_a_density():
    """m = rho pi d^2/4, of a thin wire that no density of a material gives."""
    wire = Tether(diameter=0.001, mass_per_length=0.14)
    assert wire.density == pytest.approx(0.14 / (pi * 0.001**2 / 4.0), rel=1e-15)
    assert wire.mass_per_length == pytest.approx(0.14, rel=1e-15)
    assert Tether(20, 505.0, 0.001, mass_per_length=0.14) == wire
    for model in (TetherDynamic(diameter=0.001, mass_per_length=0.14), TetherDynamic(wire, mass_per_length=0.14)):
        assert model._records[0][0] == wire
    assert tether_of("steel", 0.001, mass_per_length=0.14).mass_per_length == pytest.approx(0.14, rel=1e-15)


def test_a_wire_of_that_mass_hangs_with_its_weight():
    """At rest the forces on both ends are the weight, m g L."""
    start = TetherDynamic(diameter=0.001, mass_per_length=0.14, initial_length=505.0, gravity=9.81).initialize()
    assert (start.kite_force + start.ground_force)[2] == pytest.approx(-0.14 * 9.81 * 505.0, rel=1e-9)


REFUSED = {
    "both": ({"mass_per_length": 0.1, "density": 700.0}, "mass_per_length and density are both given; give one of them"),
    "nothing": ({"mass_per_length": 0.0}, "mass_per_length is 0.0; it must be at least 1.25664e-08 kg/m and at most 125"),
    "text": ({"mass_per_length": "heavy"}, "mass_per_length is 'heavy'; it must be at least"),
    "with a diameter": ({"mass_per_length": 9.0, "diameter": 0.001}, "at most 7.85398 kg/m with a diameter of 0.001 m"),
    "wrong diameter": ({"mass_per_length": 9.0, "diameter": -1.0}, "diameter is -1.0; it must be at least 1e-06 m"),
}


@pytest.mark.parametrize("name", REFUSED)
@pytest.mark.parametrize("make", [Tether, TetherDynamic])
def test_a_mass_that_cannot_be_is_refused(name, make):
    given, said = REFUSED[name]
    with pytest.raises(ValueError, match=re.escape(said)):
        make(**given)
