"""FMUs that break and let go: Booleans in both flavours and both versions of FMI, numbers as those of the Python API."""

import numpy as np
import pytest

from isolation import in_shared_process
from runtime.host import Host, blob_of, description_of, extract_all, restore
from tetherfmu import Line, Point, Tether, TetherDynamic, TetherDynamicFree, TetherSystem
from tetherfmu.files.system_files import load

STEP, STEPS = 0.02, 25
FLAVOURS = {"pythonfmu": (), "native": ("--native",), "fmi3": ("--native", "--fmi", "3")}
FILE = """
name = "Hoist"
[points.top]
position = [0.0, 0.0, 30.0]
[points.load]
mass = 200.0
[lines.rope]
from = "top"
to = "load"
segments = 4
initial_length = 20.0
breaking_force = 1e6
"""
every_flavour = pytest.mark.parametrize("flavour", list(FLAVOURS))


@pytest.fixture(scope="session")
def fmus(built_once):
    """Folder with a folder of FMUs for each flavour."""
    from tetherfmu.commands.build import main

    def build(folder):
        file = folder / "hoist.toml"
        file.write_text(FILE)
        for flavour, options in FLAVOURS.items():
            out = ["--out", str(folder / flavour), *options]
            assert main(["TetherDynamic", "TetherDynamicFree", *out]) == 0
            assert main(["--system", str(file), *out]) == 0
            extract_all(folder / flavour)

    return built_once("fmus_that_break", build)


def kite(k):
    """A kite end that flies away."""
    return {"kite_position": (300.0, 0.0, 400.0 + 0.1 * k), "kite_velocity": (0.0, 0.0, 5.0)}


def of_python(outputs):
    return [*outputs.ground_force, *outputs.kite_force, outputs.max_tension, outputs.break_time, float(outputs.broken)]


def of_host(host):
    """The same; Booleans are read by functions of their own."""
    names = ("ground_force", "kite_force", "max_tension", "break_time", "broken")
    assert host.get("broken") in (True, False)
    return np.hstack([host.get(name) for name in names]).tolist()


@every_flavour
@pytest.mark.parametrize("event", ["break", "release"])
@in_shared_process
def test_a_driven_tether(fmus, flavour, event):
    force = 1500.0 if event == "break" else 0.0
    tether = TetherDynamic(initial_length=500.5, breaking_force=force)
    tether.initialize(**kite(0))
    expected = [of_python(tether.step(STEP, release=event == "release" and k == 10, **kite(k))) for k in range(STEPS)]
    assert expected[0][-1] == 0.0
    assert expected[-1][-1] == 1.0
    host = Host(fmus / flavour / "TetherDynamic.fmu").start(initial_length=500.5, breaking_force=force, **kite(0))
    found, blob = [], None
    for k in range(STEPS):
        host.step(STEP, release=event == "release" and k == 10, **kite(k))
        found.append(of_host(host))
        blob = blob if k != 2 else blob_of(host)
    assert found == expected
    assert any("broke" in each for each in host.messages) == (event == "break")
    restore(host, blob)
    host.time = 3 * STEP
    for k in range(3, STEPS):
        host.step(STEP, release=event == "release" and k == 10, **kite(k))
        assert of_host(host) == expected[k]
    late = blob_of(host)
    restore(host, late)
    assert blob_of(host) == late


@every_flavour
@in_shared_process
def test_a_released_kite(fmus, flavour):
    free = TetherDynamicFree()
    free.initialize()
    host = Host(fmus / flavour / "TetherDynamicFree.fmu").start()
    for k in range(STEPS):
        outputs = free.step(STEP, release=k >= 5)
        host.step(STEP, release=k >= 5)
        assert list(host.get("kite_position")) == outputs.kite_position.tolist()
        assert of_host(host) == of_python(outputs)
    assert outputs.broken


@every_flavour
@in_shared_process
def test_a_load_of_a_system(fmus, flavour):
    points = [Point("top", (0.0, 0.0, 30.0)), Point("load", None, mass=200.0)]
    system = TetherSystem(points, [Line("rope", "top", "load", Tether(segments=4, initial_length=20.0, breaking_force=1e6))])
    assert load(fmus / "hoist.toml").lines[0].tether.breaking_force == 1e6
    system.initialize()
    host = Host(fmus / flavour / "Hoist.fmu").start()
    for k in range(STEPS):
        outputs = system.step(STEP, releases={"rope": k >= 5})
        host.step(STEP, **{"rope.release": k >= 5})
        assert list(host.get("load.position")) == outputs.points["load"].position.tolist()
        assert list(host.get("load.velocity")) == outputs.points["load"].velocity.tolist()
        assert host.get("rope.broken") == outputs.lines["rope"].broken
        assert host.get("rope.break_time") == outputs.lines["rope"].break_time
    assert outputs.lines["rope"].break_time == pytest.approx(0.1)


@every_flavour
@in_shared_process
def test_booleans_in_the_description(fmus, flavour):
    variables = {each.name: each for each in description_of(fmus / flavour / "TetherDynamic.fmu").modelVariables}
    for name, causality in (("release", "input"), ("broken", "output")):
        assert variables[name].type == "Boolean"
        assert (variables[name].causality, variables[name].variability) == (causality, "discrete")
    assert variables["release"].start == "false"
    host = Host(fmus / flavour / "TetherDynamic.fmu")
    host.refuses(lambda: host.fmu.setBoolean([host.reference["broken"]], [True]), "broken")
