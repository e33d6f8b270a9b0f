"""Circle and parked kite in turbulence as SSP files: the wind at the points of the tether is that of the box there."""

import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmpy.ssp.ssd import read_ssd

from example_fmus.test_ssp import TURBULENT
from isolation import own_process
from tetherfmu.libraries.examples import example
from tetherfmu.wind import frozen_turbulence as frozen
from tetherfmu.wind import wind_boxes as boxes

STEP, STEPS = 0.02, 100
every_system = pytest.mark.parametrize("name", TURBULENT)


@pytest.fixture(scope="session")
def systems(built_once):
    return built_once("ssp", lambda folder: example("shared.ssp").write_all(folder))  # as for test_ssp.py


@every_system
def test_connections(systems, name):
    """All points of the tether and the wind at them are connected, in both ways."""
    system = read_ssd(str(systems / f"{name}.ssp")).system
    ends = [(c.startElement, c.startConnector, c.endElement, c.endConnector) for c in system.connections]
    points = [f"[{k},{i}]" for k in range(1, 22) for i in (1, 2, 3)]
    assert {("wind", f"wind_at{each}", "tether", f"wind_at{each}") for each in points} <= set(ends)
    assert {("tether", f"shape{each}", "wind", f"shape{each}") for each in points} <= set(ends)
    assert not [each for each in ends if each[2:] == ("tether", "wind_velocity[1]")]
    winds = [each for each in ends if each[2:] == ("kite", "wind_velocity[1]")]
    assert winds == ([("wind", "kite_wind[1]", "kite", "wind_velocity[1]")] if "parked" in name else [])


def flown(path, folder, steps):
    """Fly a system in FMPy, all FMUs from the same communication point: rows of shape, wind there, position, tension."""
    from runtime.host import Host

    system = read_ssd(path).system
    with zipfile.ZipFile(path) as archive:
        archive.extractall(folder)
    hosts = {part.name: Host(Path(folder) / part.source, own_folder=True) for part in system.elements}
    inputs = {}
    for each in system.connections:
        inputs.setdefault(each.endElement, []).append((each.startElement, each.startConnector, each.endConnector))

    def exchange():
        values = {}
        for taker, wanted in inputs.items():
            values[taker] = {end: hosts[giver].get(start) for giver, start, end in wanted}
        for taker, given in values.items():
            hosts[taker].set(**given)

    for host in hosts.values():
        host.enter_initialization(None)
    for _ in range(3):  # as many as there are loops
        exchange()
    for host in hosts.values():
        host.fmu.exitInitializationMode()
    rows = []
    for _ in range(steps):
        exchange()
        before = hosts["tether"].get("shape")
        for host in hosts.values():
            host.step(STEP)
        names = ("wind_at", "kite_position")
        rows.append([before, *(hosts["wind"].get(name) for name in names[:1]), hosts["tether"].get("ground_tension")])
    return rows


@every_system
def test_flight(systems, tmp_path, name):
    """The wind that the tether gets next is that of the box where its points are, to what they move in a step."""
    rows = own_process(flown, path=str(systems / f"{name}.ssp"), folder=str(tmp_path), steps=STEPS)
    given = example("wind.turbulence_systems")
    (tmp_path / "box.npz").write_bytes(given.box())
    field = frozen.FrozenTurbulence(frozen.MeanWind(8.0, 0.0, 10.0, 0.14), boxes.open_box(tmp_path / "box.npz"))
    tension = np.array([row[2] for row in rows])
    assert np.all(np.isfinite(tension))
    assert tension.min() > 100.0  # taut: neither fell down
    for k in (STEPS // 2, STEPS - 1):
        expected = field.at(STEP * (k + 1), np.reshape(rows[k][0], (-1, 3)))
        found = np.reshape(rows[k][1], (-1, 3))
        # 25 m/s carry a point 0.5 m in a step, on a grid of 10 m on which the wind changes by some m/s
        np.testing.assert_allclose(found, expected, atol=0.4)
        assert found[:, 0].std() > 0.5
