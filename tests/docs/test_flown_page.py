"""The page that `tetherfmu web` writes, in Chromium: its numbers are those of the Python models, it needs no other host.

Needs Chromium with its driver, as test_site.py.
"""

import shlex
import sys
import tomllib
from collections import deque

import numpy as np
import pytest

import chromium
from tetherfmu import StepRefused, Tether, TetherDynamic
from tetherfmu.__main__ import main as tetherfmu
from tetherfmu.commands import build
from tetherfmu.files import scene_files as files
from tetherfmu.libraries.examples import EXAMPLES, example
from tetherfmu.runtime.variants import VARIANTS
from tetherfmu.study.measuring.start import tether_at_start

DESK, STEP = 1400, 0.02  # width of the window [px], communication step of the page [s]
SCENES = ("circle", "figure_of_eight", "reel", "landing", "launch", "parked", "towing", "logged")
pytestmark = chromium.needed


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    assert tetherfmu(["web", "--out", str(folder)]) == 0
    with chromium.served(folder) as served:
        yield f"{served}/index.html"


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    with chromium.started(DESK, tmp_path_factory.mktemp("chromium")) as driver:
        yield driver


def load(browser, link):
    """Open a link and wait until the tethers fly."""
    browser.get("about:blank")  # another hash alone loads nothing
    browser.get(link)
    chromium.wait_until(browser, "window.tetherfmu")


def opened(browser, address, settings=""):
    """Open the page with settings, stopped at the start."""
    load(browser, f"{address}#{settings}")
    browser.execute_script("tetherfmu.run(false); tetherfmu.fly(true)")


def flown(browser, steps):
    """Advance by so many steps; forces on the kite [N] and at the station by variant, each (3,)."""
    found = browser.execute_script(
        "const { simulation } = tetherfmu;"
        "for (let k = 0; k < arguments[0]; k++) simulation.advance();"
        "return Object.fromEntries(simulation.flown.map(each =>"
        "  [each.name, [each.tether.vector('kite_force'), each.tether.vector('ground_force')]]))",
        steps,
    )
    return {name: np.array(forces) for name, forces in found.items()}


def in_python(variant, scene, steps):
    """The same forces of a Python model in a scene."""
    tether = tether_at_start(scene, variant=variant, first=scene.inputs(STEP)[0])
    tether.fly(scene.inputs(STEP)[:steps], STEP, every=0)
    end = tether.outputs()
    return np.array([end.kite_force, end.ground_force])


def test_it_flies_without_an_error_and_without_another_host(address, browser):
    browser.get_log("performance")
    opened(browser, address)
    browser.execute_script("tetherfmu.run(true)")
    chromium.wait_until(browser, "tetherfmu.simulation.time > 1.0")
    rate = browser.execute_script("return tetherfmu.fps")
    print(f"{rate:.0f} frames a second with two variants of 20 segments and a finer one", file=sys.stderr)
    assert chromium.errors(browser) == []
    asked = [each["request"]["url"] for each in chromium.messages(browser, "Network.requestWillBeSent")]
    host = address.rpartition("/")[0]
    assert f"{host}/tetherfmu.wasm" in asked
    assert [url for url in asked if not url.startswith((f"{host}/", "data:", "about:"))] == []


@pytest.mark.parametrize("name", ["circle", "landing", "logged"])
def test_forces_are_those_of_the_python_models(address, browser, name):
    """To 1e-6 of the force: velocities of the page are differences, its sinh and log those of JavaScript."""
    steps = 400
    opened(browser, address, f"scene={name}&show={','.join(VARIANTS)}")
    here, scene = flown(browser, steps), files.load(EXAMPLES / "scenes" / f"{name}.toml")
    for variant in VARIANTS:
        there = in_python(variant, scene, steps)
        assert np.allclose(here[variant], there, rtol=0.0, atol=1e-6 * np.abs(there).max()), variant


@pytest.mark.parametrize("name", SCENES)
def test_ends_move_as_in_the_scene(address, browser, name):
    """Positions to rounding, velocities to the error of the differences: 1e-9 of a fast kite."""
    opened(browser, address, f"scene={name}")
    times = [0.0, 0.37, 5.0, 11.9, 19.3]
    here = browser.execute_script("return arguments[0].map(time => tetherfmu.simulation.driver.motion(time))", times)
    there = files.load(EXAMPLES / "scenes" / f"{name}.toml").flight.motion(np.array(times))
    for key, expected, tolerance in (
        ("kite", there.kite, 1e-10),
        ("kiteVelocity", there.kite_velocity, 1e-7),
        ("ground", there.ground, 1e-10),
        ("groundVelocity", there.ground_velocity, 1e-7),
        ("reeled", there.reeled, 1e-10),
        ("reelOutSpeed", there.reel_out_speed, 1e-7),
    ):
        assert np.allclose([each[key] for each in here], expected, rtol=0.0, atol=tolerance), key


def test_a_log_of_ones_own_is_flown_and_a_wrong_one_told(address, browser, tmp_path):
    """It becomes a scene; its wind is that of its columns."""
    opened(browser, address, "scene=circle")
    text = (EXAMPLES / "scenes" / "logged_flight.csv").read_text(encoding="utf-8")
    for name, content in (("mine.csv", text), ("wrong.csv", text.replace("reel_out_speed", "speed", 1))):
        (tmp_path / name).write_text(content, encoding="utf-8")
        browser.find_element("id", "log").send_keys(str(tmp_path / name))
        chromium.wait_until(browser, f"document.getElementById('about').textContent.includes('{name}')")
    assert "wrong.csv: unknown column 'speed'; known are time, kite_position[1]" in browser.find_element("id", "about").text
    browser.execute_script("tetherfmu.run(false); tetherfmu.fly()")
    flown(browser, 25)
    kite, wind, file = browser.execute_script(
        "const { settings, simulation: { given } } = tetherfmu;"
        "return [given.kite_position, given.wind_velocity, document.getElementById('toml').textContent]"
    )
    scene = files.load(EXAMPLES / "scenes" / "logged.toml")
    assert np.allclose(kite, scene.flight.motion(np.array([0.48])).kite[0], rtol=0.0, atol=1e-10)
    assert np.allclose(wind, scene.wind(np.array([0.48]))[0], rtol=0.0, atol=1e-10)
    assert 'file = "mine.csv"' in file


def said(browser):
    browser.execute_script("tetherfmu.speak()")
    return browser.execute_script("return document.getElementById('said').innerText")


def test_a_refused_parameter_is_told_as_by_the_model(address, browser):
    opened(browser, address, "scene=circle&p.segments=300&p.initial_length=1&show=dynamic")
    with pytest.raises(ValueError, match="initial_length") as refused:
        TetherDynamic(Tether(initial_length=1.0, segments=300)).initialize(kite_position=(0.5, 0.0, 0.0))
    assert f"TetherDynamic: {refused.value}" in said(browser)


@pytest.mark.parametrize("control", [1, 2, 3], ids=["speed", "force", "length"])
@pytest.mark.parametrize("name", ["", "circle", "reel", "pointer", "free"])
def test_no_input_of_the_winch_is_given_where_it_has_no_effect(address, browser, name, control):
    """Not even as the page opens, with the scene that it has without any."""
    opened(browser, address, f"p.winch_control={control}" + (f"&scene={name}" if name else ""))
    browser.execute_script("for (let k = 0; k < 100; k++) tetherfmu.simulation.advance()")
    assert "has no effect" not in said(browser)


@pytest.mark.filterwarnings("ignore:a segment is stretched")
def test_a_refused_step_is_told_as_by_the_model_and_the_tether_stays(address, browser):
    """A winch that reels 2 m of tether in at 20 m/s is refused in the step that would end below the shortest segments."""
    opened(browser, address, "scene=pointer&f.distance=2&p.initial_length=2.1&h.reel_out_speed=-20&show=dynamic")
    browser.execute_script("for (let k = 0; k < 10; k++) tetherfmu.simulation.advance()")
    tether = TetherDynamic(Tether(initial_length=2.1))
    kite = browser.execute_script("return tetherfmu.simulation.given.kite_position")
    tether.initialize(kite_position=kite, reel_out_speed=-20.0)
    with pytest.raises(StepRefused) as refused:
        deque((tether.step(STEP) for _ in range(10)), maxlen=0)
    sentence = said(browser)
    assert f"TetherDynamic: {refused.value}" in sentence
    assert "the reel_out_speed -20.0 m/s over a step of 0.02 s" in sentence


@pytest.mark.parametrize(("typed", "value"), [("20000", "20.0"), ("4 mm", "'4 mm'"), (" ", "''")])
def test_a_number_that_cannot_be_is_told_beside_its_slider_as_it_was_typed(address, browser, typed, value):
    opened(browser, address, "scene=circle")
    told = browser.execute_script(
        "const row = [...document.querySelectorAll('.quantity')].find(each => each.innerText.startsWith('diameter'));"
        "const number = row.querySelector('.value input');"
        f"number.value = '{typed}'; number.dispatchEvent(new Event('change'));"
        "return [row.querySelector('.problem').innerText, tetherfmu.settings.values.diameter]"
    )
    assert told == [f"diameter is {value}; it must be at least 1e-06 m and at most 10 m", 0.004]


def test_a_restored_flight_continues_bit_for_bit(address, browser):
    opened(browser, address, "scene=free&show=quasi_steady,reference")
    flown(browser, 60)
    browser.execute_script("tetherfmu.save()")
    first = flown(browser, 60)
    browser.execute_script("tetherfmu.restore()")
    again = flown(browser, 60)
    assert first.keys() == again.keys()
    assert all(np.array_equal(first[name], again[name]) for name in first)
    link = browser.execute_script("tetherfmu.restore(); return tetherfmu.linkTo(tetherfmu.pairs())")
    load(browser, link)
    browser.execute_script("tetherfmu.run(false); tetherfmu.open([...new URLSearchParams(location.hash.slice(1))])")
    shared = flown(browser, 60)
    assert all(np.array_equal(first[name], shared[name]) for name in first)


def test_the_wing_is_that_of_the_examples(address, browser):
    """Lift and drag on the free kite, to rounding."""
    opened(browser, address, "scene=free")
    flown(browser, 300)
    position, velocity, load, memory = browser.execute_script(
        "const { simulation } = tetherfmu, { position, velocity } = simulation.kite();"
        "const memory = structuredClone(simulation.driver.memory.wing);"
        "simulation.advance();"
        "return [position, velocity, simulation.given.kite_load, [memory.heading, simulation.driver.memory.wing]]"
    )
    wing = example("fmus.aerodynamics")
    values = {**vars(wing.Wing()), **vars(files.Environment())}
    known = type("Known", (), values)
    heading = wing.turned(memory[0], wing.unit(position), 0.0)
    felt = wing.apparent_wind(position, velocity, (9.0, 0.0, 0.0), known)
    expected = wing.load(position, heading, felt, memory[1]["steering"], memory[1]["depower"], known)
    assert np.allclose(load, expected, rtol=1e-12, atol=1e-9)


@pytest.mark.parametrize("name", [*SCENES, "hanging_load"])
def test_what_is_taken_home_can_be_built(address, browser, name):
    changes = "p.diameter=0.006&p.axial_damping=500&w.gust=0.3&p.ground_contact=2&p.ground_height=-90"
    opened(browser, address, f"scene={name}&{changes}")
    command, text, parameters = browser.execute_script(
        "return ['command', 'toml', 'parameters'].map(id => document.getElementById(id).textContent)"
    )
    program, verb, *arguments = shlex.split(command)
    assert (program, verb) == ("tetherfmu", "build")
    wanted = build.parse(arguments)
    assert "TetherDynamic" in "".join(wanted.names)
    scene = files.read(tomllib.loads(text), EXAMPLES / "scenes", name)
    settings = browser.execute_script("return tetherfmu.settings")
    for record in (scene.tether, scene.environment, scene.ground):
        for key, value in vars(record).items():
            if key != "segments":
                assert settings["values"][key] == value, key
    if name != "logged":  # whose flight and wind are those of its file
        assert vars(scene.flight) == settings["flight"]
        assert (scene.wind.gust, list(scene.wind.velocity)) == (0.3, settings["wind"]["velocity"])
    starts = dict(build.starts_of(wanted.diameter, None))
    told = dict(line.split(" = ") for line in parameters.splitlines() if not line.startswith("#"))
    for key, value in settings["values"].items():
        if key in ("axial_stiffness", "axial_damping", "diameter"):
            assert float(told.get(key, starts.get(key))) == pytest.approx(value, rel=1e-12)


def test_the_kite_follows_the_pointer_smoothly(address, browser):
    """To the side of the pointer, on the sphere, with a velocity that is the rate of the position."""
    from selenium.webdriver import ActionChains

    opened(browser, address, "scene=pointer")
    view = browser.find_element("id", "view")
    ActionChains(browser).move_to_element_with_offset(view, 150, -60).perform()
    motion = browser.execute_script(
        "const { simulation } = tetherfmu, found = [];"
        "for (let k = 0; k < 400; k++) { simulation.advance(); found.push(simulation.given); }"
        "return found.map(each => [each.kite_position, each.kite_velocity])"
    )
    position, velocity = np.array(motion).transpose(1, 0, 2)
    assert np.linalg.norm(position[-1] - position[0]) > 10.0
    assert np.allclose(np.linalg.norm(position, axis=1), 100.0, rtol=1e-12)
    assert np.linalg.norm(velocity, axis=1).max() < 1.5 * 30.0  # 30 m/s in elevation, and in azimuth
    rate = (position[1:] - position[:-1]) / STEP  # mean velocity of a step: second order in it
    assert np.allclose(rate, 0.5 * (velocity[1:] + velocity[:-1]), atol=0.05)
    goal = browser.execute_script(
        "const box = document.getElementById('view').getBoundingClientRect(), { camera } = tetherfmu.view;"
        "return camera.onSphere([0, 0, 0], 100, box.width / 2 + 150, box.height / 2 - 60)"
    )
    assert np.allclose(position[-1], goal, atol=2.0)


def test_keys_and_buttons_fly_pause_and_turn(address, browser):
    from selenium.webdriver.common.keys import Keys

    opened(browser, address, "scene=circle")
    view = browser.find_element("id", "view")
    before = browser.execute_script("return tetherfmu.view.camera.azimuth")
    view.send_keys(Keys.ARROW_RIGHT, Keys.ARROW_UP, "+")
    assert browser.execute_script("return tetherfmu.view.camera.azimuth") == pytest.approx(before + 0.06)
    view.send_keys(" ")
    assert browser.execute_script("return tetherfmu.runs") is True
    browser.find_element("id", "play").click()
    assert browser.execute_script("return tetherfmu.runs") is False
    browser.find_element("css selector", "tr[data-tether=straight] input").click()
    assert browser.execute_script("return tetherfmu.settings.shown").count("straight") == 1
    assert "TetherStraight" in browser.find_element("id", "command").text


@pytest.fixture
def phone(browser):
    """The browser as a phone."""
    chromium.show_in(browser, chromium.PHONE["width"])
    yield browser
    chromium.show_in(browser, DESK)


def test_it_fits_a_phone(address, phone):
    opened(phone, address, f"scene=landing&show={','.join(VARIANTS)},reference")
    wide, viewport = phone.execute_script("return [document.documentElement.scrollWidth, innerWidth]")
    assert wide <= viewport == chromium.PHONE["width"]
    assert chromium.errors(phone) == []
