"""The FMU of turbulent wind in a host: its wind is that of the sampler, its file is part of its state, refusals in words."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description
from fmpy.fmi1 import FMICallException

from example_fmus.example_slaves import Model, example_fmus
from example_fmus.test_wind_boxes import some_numbers, turbsim
from isolation import in_own_process
from runtime.host import Host, blob_of, restore
from tetherfmu.wind import frozen_turbulence as frozen
from tetherfmu.wind import wind_boxes as boxes

REFERENCE = Path(__file__).resolve().parents[1] / "reference"
MANN, TURBSIM = str(REFERENCE / "mann_u.turb"), str(REFERENCE / "pyconturb.bts")
GRID = {"points_along": 16, "points_across": 4, "points_upwards": 8}
GRID |= {"spacing_along": 5.0, "spacing_across": 10.0, "spacing_upwards": 8.0}
SHAPE = np.linspace((3.0, 1.0, 0.0), (40.0, -5.0, 60.0), 21) + np.random.default_rng(4).normal(size=(21, 3))
KITE = (40.0, -5.0, 60.0)


def sampler(file, **more):
    box = boxes.open_box(file, (16, 4, 8), (5.0, 10.0, 8.0))
    return frozen.FrozenTurbulence(frozen.MeanWind(9.0, 0.2, 6.0, 0.15), box, **more)


@pytest.mark.parametrize("file", [MANN, TURBSIM])
def test_the_wind_is_that_of_the_sampler(file):
    """At the end of a step, where a moving point then is; the mean along the tether is that of its segments."""
    given = {"mean_speed": 9.0, "wind_direction": 0.2, "wind_exponent": 0.15, "wind_points": 2, **GRID}
    shape = {f"shape[{k + 1},{i + 1}]": SHAPE[k, i] for k, i in np.ndindex(21, 3)}
    model = Model("TurbulentWind", file, kite_position=KITE, box_origin=(2.0, 3.0, -4.0), **given, **shape)
    wind = sampler(file, origin=(2.0, 3.0, -4.0))
    for k in range(50):
        kite = np.add(KITE, (0.5 * k, 0.0, 0.1 * k))
        at_points = wind.at(0.1 * k, SHAPE)
        got = [model.get(f"wind_at[{m},{i}]") for m in range(1, 22) for i in (1, 2, 3)]
        np.testing.assert_allclose(got, at_points.ravel(), rtol=0.0, atol=1e-12)  # some m/s
        mean = 0.5 * (at_points[1:] + at_points[:-1]).mean(axis=0)
        np.testing.assert_allclose(model.get("wind_velocity"), mean, rtol=0.0, atol=1e-12)
        if k != 1:  # in the first step it knows no rate of its inputs
            np.testing.assert_allclose(model.get("kite_wind"), wind.at(0.1 * k, kite[None])[0], rtol=0.0, atol=1e-9)
        assert model.step(0.1, kite_position=kite)


def test_points_on_the_line_to_the_kite():
    """Where `shape` is not connected, and whatever it is."""
    model = Model("TurbulentWind", MANN, kite_position=KITE, mean_speed=9.0, wind_direction=0.2, wind_exponent=0.15, **GRID)
    expected = sampler(MANN).at(0.0, np.linspace((0.0, 0.0, 0.0), KITE, 21))
    np.testing.assert_allclose(model.get("wind_velocity"), np.trapezoid(expected, axis=0) / 20.0, rtol=1e-12)
    np.testing.assert_allclose(model.get("kite_wind"), expected[-1], rtol=1e-12)


def test_without_a_file_it_is_the_mean_wind():
    model = Model("TurbulentWind", kite_position=(0.0, 0.0, 300.0), wind_exponent=0.14, wind_direction=math.pi / 3.0)
    for _ in range(3):
        speed = 8.0 * (300.0 / 6.0) ** 0.14
        np.testing.assert_allclose(model.get("kite_wind"), (0.5 * speed, math.sqrt(0.75) * speed, 0.0), rtol=1e-12)
        assert model.step(0.1)


def test_the_file_is_a_string_parameter(tmp_path):
    """With the start value that its builder was given; the first outputs depend on it."""
    path = example_fmus.build("TurbulentWind", tmp_path, [("file", MANN), ("mean_speed", 9.5), *GRID.items()])
    description = read_model_description(str(path))
    (file,) = [variable for variable in description.modelVariables if variable.type == "String"]
    assert (file.name, file.causality, file.variability, file.start) == ("file", "parameter", "fixed", MANN)
    assert all(file in unknown.dependencies for unknown in description.initialUnknowns)
    assert {"wind_at[21,3]", "kite_wind[1]"} <= {unknown.variable.name for unknown in description.initialUnknowns}


def started(folder, **values):
    return Host(folder / "TurbulentWind.fmu").start(kite_position=KITE, **values)


def rows(host, begin, end):
    found = []
    for k in range(begin, end):
        host.time = 0.1 * k
        host.step(0.1, **{"kite_position[1]": KITE[0] + math.sin(k)})
        found.append(host.all_outputs())
    return found


@in_own_process
def test_a_state_brings_its_file(example_folder):
    """To another instance, which had none, bit for bit."""
    host, other = started(example_folder, file=TURBSIM), started(example_folder)
    rows(host, 0, 5)
    blob = blob_of(host)
    expected = rows(host, 5, 20)
    assert np.ptp(np.array(expected)[:, 3]) > 1.0  # it is turbulent
    restore(other, blob)
    assert other.get("file").decode() == TURBSIM
    assert rows(other, 5, 20) == expected
    for wrong in (blob[:-1], blob[:-9] + b"x" + blob[-8:], blob[:-8] + b"\xff" * 8, blob[:4], b""):
        restore(other, wrong)
        assert "the previous state is kept" in other.messages[-1]
        with pytest.raises(FMICallException):
            other.fmu.doStep(2.0, 0.1)
    restore(other, blob)
    assert rows(other, 5, 20) == expected


@in_own_process
def test_a_file_that_is_not_there_stops_the_initialization(example_folder):
    host = Host(example_folder / "TurbulentWind.fmu")
    with pytest.raises(FMICallException):
        host.start(file="/no/box 100%s.bts")
    said = "".join(host.messages).replace("%%", "%")  # a message is a format of printf
    assert "'/no/box 100%s.bts' cannot be opened: No such file or directory" in said


@in_own_process
def test_the_file_is_fixed_after_the_initialization(example_folder):
    host = started(example_folder, file=TURBSIM)
    host.refuses(lambda: host.set(file=MANN), "file cannot be set to")
    host.refuses(lambda: host.fmu.getString([0]), "value reference 0 (kite_position[1]) cannot be read")
    host.refuses(lambda: host.fmu.setString([0], ["x"]), "value reference 0 (kite_position[1]) cannot be set to 'x'")
    assert host.get("file").decode() == TURBSIM
    rows(host, 0, 3)


def test_a_name_that_is_too_long_is_refused():
    model = Model("TurbulentWind")
    model.slave.phase = 0
    model.slave.set_string([len(model.slave.table)], ["x" * 5000])
    assert model.messages == ["file has a name of 5000 bytes; it must have at most 4096"]
    assert model.slave.file == ""


def test_a_file_that_vanishes_is_named_where_it_is_opened_again(tmp_path):
    """A state of another instance needs it; once it is back, the step is done."""
    path = tmp_path / "box.bts"
    path.write_bytes(Path(TURBSIM).read_bytes())
    first, second = Model("TurbulentWind", path), Model("TurbulentWind")
    first.step(0.1)
    state = first.slave.state_to_bytes()
    path.rename(tmp_path / "gone.bts")
    second.slave.state_from_bytes(state)
    before = second.slave.state_to_bytes()
    second.time = 0.1
    assert not second.step(0.1)
    assert re.search(r"box\.bts' cannot be opened: No such file or directory$", second.messages[-1])
    assert second.slave.state_to_bytes() == before
    (tmp_path / "gone.bts").rename(path)
    assert second.step(0.1)
    assert first.step(0.1)
    assert second.slave.state_to_bytes() == first.slave.state_to_bytes()


def test_a_step_out_of_the_box_is_refused():
    """The box of 75 m, 9 m/s: its end comes to x = 0 after 8.33 s. Nothing has changed, and the way back is free."""
    model = Model(
        "TurbulentWind", MANN, outside=2, kite_position=(0.0, 0.0, 40.0), mean_speed=9.0, wind_exponent=0.0, **GRID
    )
    done = [model.step(1.0) for _ in range(9)]
    assert done == [True] * 8 + [False]
    assert (
        "does not reach the point (0, 0, 40) m at 9 s: along the wind it is at 0 m; the box is from 6 to 81 m"
        in model.messages[-1]
    )
    assert model.step(0.25)


def test_the_ground_station_outside_of_the_box_is_refused_at_the_start():
    with pytest.raises(
        ValueError, match=r"does not reach the point \(0, 0, 0\) m at 0 s: upwards it is at 0 m; the box is from 20 to 80"
    ):
        Model("TurbulentWind", TURBSIM, outside=2, kite_position=(0.0, 0.0, 40.0))


@in_own_process
def test_the_fmu_warns_of_a_seam_once(example_folder, tmp_path):
    path = turbsim(tmp_path / "box.bts", some_numbers(), kind=7)
    host = Host(example_folder / "TurbulentWind.fmu").start(file=str(path), outside=3, kite_position=(0.0, 0.0, 30.0))
    host.step(0.1)
    host.step(0.1)
    assert sum("says that it is not periodic" in each for each in host.messages) == 1
