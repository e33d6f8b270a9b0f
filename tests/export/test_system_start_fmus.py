"""Free points that the FMU of a system puts in equilibrium when its initialization ends, in all flavours.

No point of the file is driven: which of them are given, and which are sought, is a matter of parameters.
"""

import pytest

from isolation import in_shared_process
from runtime.host import STEP, Host, blob_of, restore
from tetherfmu import TetherSystem

from .flavours import build_all, every_flavour

FILE = """
name = "Chain"

[points]
top = {position = [0, 0, 60], mass = 2e3}
knot = {mass = 3.0}
load = {mass = 20.0}

[lines.upper]
from = "top"
to = "knot"
initial_length = 20.0
segments = 3

[lines.lower]
from = "knot"
to = "load"
initial_length = 15.0
segments = 2
"""
WIND, LOADS = (9.0, 2.0, 0.0), {"top": (0.0, 0.0, 2.1e4), "knot": (30.0, 0.0, 0.0), "load": (0.0, -40.0, 10.0)}
GIVEN, EQUILIBRIUM = 1, 2


@pytest.fixture(scope="session")
def chains(built_once):
    """Folder with the file, and an FMU of each flavour in a folder of its own."""

    def build(folder):
        (folder / "chain.toml").write_text(FILE)
        build_all(folder, folder / "chain.toml")

    return built_once("system_chains", build)


def started(host, **values):
    """Initialize with wind and loads."""
    return host.start(wind_velocity=WIND, **{f"{name}.load": load for name, load in LOADS.items()}, **values)


def motion(outputs):
    """Positions and velocities of the points among the outputs of an FMU."""
    return {name: value for name, value in outputs.items() if name.endswith((".position", ".velocity"))}


def as_fmu(outputs):
    """The same of `SystemOutputs`."""
    points = outputs.points.items()
    return {f"{name}.{what}": getattr(point, what).tolist() for name, point in points for what in ("position", "velocity")}


@every_flavour
@in_shared_process
def test_points_are_sought_with_the_inputs_of_the_start(chains, native):
    system = TetherSystem.from_file(chains / "chain.toml")
    start = as_fmu(system.initialize(WIND, loads=LOADS))
    host = started(Host(chains / str(native) / "Chain.fmu"))
    assert (host.get("top.start"), host.get("knot.start"), host.get("load.start")) == (GIVEN, EQUILIBRIUM, EQUILIBRIUM)
    assert motion(host.outputs()) == start
    blob = blob_of(host)
    rows = []
    for _ in range(5):
        host.step(STEP)
        rows.append(host.outputs())
        assert motion(rows[-1]) == as_fmu(system.step(STEP))
    restore(host, blob)
    host.time = 0.0
    host.step(STEP)
    assert host.outputs() == rows[0]
    host.fmu.reset()
    assert motion(started(host).outputs()) == start


@every_flavour
@in_shared_process
def test_a_point_that_is_given_starts_there(chains, native):
    positions = {"knot": (3.0, 0.0, 41.0), "load": None}
    system = TetherSystem.from_file(chains / "chain.toml")
    expected = as_fmu(system.initialize(WIND, loads=LOADS, positions=positions))
    host = Host(chains / str(native) / "Chain.fmu")
    calm = system.initialize().points["load"].position.tolist()
    assert host.get("load.initial_position") == calm
    started(host, **{"knot.start": GIVEN, "knot.initial_position": positions["knot"]})
    assert motion(host.outputs()) == expected


REFUSED = {
    "torn": ({"upper.axial_stiffness": 1.0, "lower.axial_stiffness": 1.0, "air_density": 50.0}, "for the free point"),
    "nothing given": (
        {"top.start": EQUILIBRIUM},
        "no point of the system is driven or has a position: give one where it starts",
    ),
    "no number": ({"knot.load[2]": float("nan")}, "the input knot.load is [30.0, nan, 0.0]"),
    "no choice": ({"knot.start": 3}, "knot.start is 3; it must be one of 1 (given), 2 (equilibrium)"),
}


@every_flavour
@pytest.mark.parametrize("refused", REFUSED.values(), ids=REFUSED)
@in_shared_process
def test_what_has_no_equilibrium_is_refused_in_words(chains, native, refused):
    values, says = refused
    loads = {f"{name}.load": load for name, load in LOADS.items()}
    host = Host(chains / str(native) / "Chain.fmu")
    host.refuses_to_start(says, wind_velocity=WIND, **loads, **values)
