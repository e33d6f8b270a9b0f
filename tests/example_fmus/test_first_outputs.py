"""First outputs depend on no more than what is declared: each input and parameter is changed, and the outputs watched."""

from pathlib import Path

import pytest

from example_fmus.example_slaves import Model, example_fmus

# nothing is without effect: wind blows, the kite flies aside, the air thins, the profile has all laws, steering has no limit
FIRST = {
    "wind_velocity[1]": 8.0, "wind_profile": 4, "kite_velocity[2]": 9.0, "initial_kite_velocity[2]": 9.0, "steering": 0.3,
    "depower": 0.4, "initial_heading": 0.5, "heading": -2.3, "air_density_scale_height": 8000.0, "apparent_wind_speed": 15.0,
    "ground_tension": 900.0, "initial_speed": 1.0, "kite_position[2]": 40.0,
    "path": 2, "wind_direction": 0.3, "wind_points": 2, "spacing_along": 5.0, "spacing_across": 10.0, "spacing_upwards": 8.0,
    "look_ahead": 0.9, "course_gain": 0.05, "winch_speed": 0.5, "steepest": 1.0,
}  # fmt: skip
# what is of the file of turbulent wind and fits no other; what is refused beyond it
GRID = {"points_along": 16, "points_across": 4, "points_upwards": 8, "outside": 1}
BOX = Path(__file__).resolve().parents[1] / "reference" / "mann_u.turb"


def outputs(name, **changes):
    """First outputs by name."""
    known = {variable.name: variable for variable in example_fmus.table_of(name)}
    first = {each: value for each, value in FIRST.items() if each in known and known[each].causality != "output"}
    file = {"file": BOX, **GRID} if name == "TurbulentWind" else {}
    model = Model(name, **{**first, **file, **changes})
    return {each: model.get(each) for each, variable in known.items() if variable.causality == "output"}


@pytest.mark.parametrize("name", list(example_fmus.SLAVES))
def test_first_outputs_depend_on_what_is_declared(name):
    before, found = outputs(name), {}
    for variable in example_fmus.table_of(name):
        if variable.causality != "output" and variable.name not in GRID:
            value = FIRST.get(variable.name, variable.start)
            changed = value % len(variable.quantity.choices) + 1 if variable.quantity.choices else 0.9 * value + 0.01
            for each, now in outputs(name, **{variable.name: changed}).items():
                if now != before[each]:
                    found.setdefault(each, set()).add(variable.name)
    declared = {each.name: set(each.depends_on) for each in example_fmus.table_of(name) if each.causality == "output"}
    for each, names in found.items():
        assert names <= declared[each], each
    idle = set.union(*declared.values()) - set.union(*found.values(), set())
    # before the first step nothing turns, and the motor stays within its limits
    assert idle <= {"turning", "turning_by_weight", "torque_limit", "largest_acceleration", *GRID}
