"""The page in which one flies a tether: it knows what the FMU declares, asks no other host, and is written and served."""

import http.client
import json
import re
import signal
import socket
import subprocess
import sys
import threading
import tomllib
import urllib.request
from pathlib import Path

import pytest

from tetherfmu.__main__ import main as tetherfmu
from tetherfmu.commands.web import server_of
from tetherfmu.files import scene_files as files
from tetherfmu.libraries.examples import EXAMPLES
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.variants import TABLE, class_name
from tetherfmu.web import page
from tetherfmu.web.declarations import declarations
from tetherfmu.wiring.variables import CALCULATED, INPUT, PARAMETER, variables

KNOWN = json.loads(json.dumps(declarations(), allow_nan=False))  # as the browser reads them
IN_BOTH = [*variables("dynamic_free", 2), *variables("dynamic", 2)]  # a free kite end moves as the driven one is led
OF_THE_FMU = {each.name: each for each in IN_BOTH}


def names_of(causality):
    """Names of the variables of the FMUs with this causality, without indices, in their order."""
    listed = [each.name.partition("[")[0] for each in IN_BOTH if each.causality == causality]
    return [name for name in dict.fromkeys(listed) if not name.startswith("initial_kite_")]


def test_parameters_are_those_of_the_fmu():
    assert [each["name"] for each in KNOWN["parameters"]] == names_of(PARAMETER)
    for each in KNOWN["parameters"]:
        there = OF_THE_FMU[each["name"]]
        assert (each["start"], each["unit"], each["kind"]) == (there.start, there.quantity.unit, there.kind)
        assert (each["meaning"], each["range"]) == (there.quantity.meaning, there.quantity.range())
        if there.quantity.choices:
            assert dict(zip(each["choices"], each["meanings"], strict=True)) == there.quantity.choices
        else:
            assert (each["minimum"], each["maximum"]) == (there.quantity.minimum, there.quantity.maximum)


def test_parameters_are_in_the_order_of_the_kernel():
    """As `variables.PARAMETERS`, which the shells pack: by their numbers."""
    found = [OF_THE_FMU[each["name"]].place for each in KNOWN["parameters"]]
    assert found == list(range(found[0], found[0] + len(found)))


def test_inputs_and_outputs_have_the_places_of_the_fmu():
    assert sorted(each["name"] for each in KNOWN["inputs"]) == sorted(names_of(INPUT))
    assert sorted(each["name"] for each in KNOWN["outputs"]) == sorted(
        [name for causality in CALCULATED for name in names_of(causality)]
    )
    for each in KNOWN["inputs"]:
        first = OF_THE_FMU.get(each["name"]) or OF_THE_FMU[f"{each['name']}[1]"]
        assert (each["unit"], each["start"][0]) == (first.quantity.unit, first.start)
        assert each["place"] == getattr(at, each["name"].upper())
    for each in KNOWN["outputs"]:
        prefix = "OUTPUT_" if each["name"] in names_of(INPUT) else ""
        assert each["place"] == getattr(at, prefix + each["name"].upper())


def test_sliders_run_within_the_limits():
    flights = [each for kind in KNOWN["flights"].values() for each in kind["quantities"]]
    for each in [*KNOWN["parameters"], *KNOWN["wind"], *KNOWN["hand"], *KNOWN["wind_velocity"], *flights]:
        if "usual" not in each:
            continue
        low, high, logarithmic = each["usual"]
        assert low < high, each["name"]
        assert each["minimum"] is None or low >= each["minimum"]
        assert each["maximum"] is None or high <= each["maximum"]
        assert low > 0.0 or not logarithmic
        assert low <= each["start"] <= high, each["name"]


def test_variants_are_those_of_the_fmus():
    assert [each["class"] for each in KNOWN["variants"]] == [class_name(each.name) for each in TABLE]


@pytest.mark.parametrize("path", sorted((EXAMPLES / "scenes").glob("*.toml")), ids=lambda path: path.stem)
def test_scenes_are_those_of_the_files(path):
    table = tomllib.loads(path.read_text(encoding="utf-8"))
    known, scene = KNOWN["scenes"][path.stem], files.load(path)
    kind = {"series": "log"}.get(table["flight"]["kind"], table["flight"]["kind"])
    assert (known["kind"], known["duration"]) == (kind, scene.duration)
    for name, value in known["flight"].items():
        assert value == getattr(scene.flight, name)
    of_scene = {**vars(scene.tether), **vars(scene.environment), **vars(scene.ground)}
    plain = {each["name"]: each["start"] for each in KNOWN["parameters"]}
    assert {name: {**plain, **known["parameters"]}[name] for name in of_scene} == {**of_scene}
    if kind != "log":  # which has its wind in its columns
        assert known["wind"].get("velocity", [0.0, 0.0, 0.0]) == list(scene.wind.velocity)


def test_the_wing_knows_the_laws_of_the_wind():
    """By their numbers, each with its formula; any other is an error."""
    script = (page.ASSETS / "script" / "wing.js").read_text(encoding="utf-8")
    declared = re.search(r"const (UNIFORM = [^;]*); // choices of `wind_profile`", script)[1]
    laws = {name.lower(): int(number) for name, number in re.findall(r"(\w+) = (\d+)", declared)}
    (wanted,) = (each for each in KNOWN["parameters"] if each["name"] == "wind_profile")
    assert list(laws) == wanted["choices"]
    assert list(laws.values()) == list(range(1, 1 + len(laws)))
    assert re.findall(r"air\.wind_profile === (\w+)\) return", script) == [name.upper() for name in laws]
    assert "throw new Error(`wind_profile is ${air.wind_profile}, a law that wing.js does not know`)" in script


def test_modules_of_the_script_import_what_is_exported():
    texts = page.modules()
    for name, text in texts.items():
        for wanted, origin in page.IMPORT.findall(text):
            exported = set(page.EXPORT.findall(texts[origin]))
            assert set(wanted.split(", ")) <= exported, f"{name} imports from {origin}"
        assert "import " not in page.IMPORT.sub("", text)


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """Folder with the page, written by the command in a folder that has nothing else."""
    folder = tmp_path_factory.mktemp("empty") / "new" / "page"
    assert tetherfmu(["web", "--out", str(folder)]) == 0
    return folder


def test_the_page_has_three_files_and_no_other_host(written):
    assert sorted(path.name for path in written.iterdir()) == ["index.html", "page.js", "tetherfmu.wasm"]
    assert (written / "tetherfmu.wasm").stat().st_size < 400_000
    for name in ("index.html", "page.js"):
        text = (written / name).read_text(encoding="utf-8")
        assert not re.search(r"(https?:)?//[\w.-]+\.\w+/|\bhttps?:|@import|url\(", text)
        assert len(text) < 150_000
    assert "default-src 'none'" in (written / "index.html").read_text(encoding="utf-8")


def test_kernels_are_those_of_the_variants(written):
    kernels = (written / "tetherfmu.wasm").read_bytes()
    for each in TABLE:
        library = each.library or each.name
        for verb in ("segments", "pack", "complete", "initialize", "advance"):
            assert f"{library}_{verb}".encode() in kernels


def test_the_server_serves_the_page(written):
    server = server_of(written, 0)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        with urllib.request.urlopen(f"http://127.0.0.1:{server.server_port}/tetherfmu.wasm") as answer:
            assert answer.headers["Content-Type"] == "application/wasm"
            assert answer.read() == (written / "tetherfmu.wasm").read_bytes()
    finally:
        server.shutdown()
        server.server_close()


def test_the_server_shows_files_of_its_folder_only(tmp_path, capfd):
    """No list of a folder, nothing behind a link that leads out of it, and no traceback on paths that no file has."""
    place = tmp_path / "page"
    (place / "inner").mkdir(parents=True)
    (place / "index.html").write_text("page")
    (tmp_path / "secret.html").write_text("secret")
    (place / "link.html").symlink_to(tmp_path / "secret.html")
    (place / "up").symlink_to(tmp_path)
    server = server_of(place, 0)
    threading.Thread(target=server.serve_forever, daemon=True).start()

    def status(path):
        client = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=60.0)
        client.request("GET", path)
        return client.getresponse().status

    try:
        assert [status(path) for path in ("/", "/index.html", "/?a=b")] == [200] * 3
        wrong = ("/%00", "/a%00b", "/inner/", "/inner", "/link.html", "/up/secret.html", "/../secret.html", f"/{'a' * 5000}")
        assert [status(path) for path in wrong] == [404] * len(wrong)
    finally:
        server.shutdown()
        server.server_close()
    assert capfd.readouterr().err == ""


def test_a_port_that_is_taken_is_told(tmp_path, capsys):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        assert tetherfmu(["web", "--out", str(tmp_path), "--serve", "--port", port]) == 2
    said = capsys.readouterr().err
    assert f"port {port} cannot be used" in said
    assert said.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(sys.platform == "win32", reason="sends a signal")
def test_ctrl_c_ends_the_server_quietly(written):
    listening = "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler)"  # also in the background
    code = f"{listening}; from tetherfmu.__main__ import main; sys.exit(main(sys.argv[1:]))"
    command = [sys.executable, "-c", code, "web", "--out", str(written), "--serve"]
    paths = {"PYTHONPATH": str(Path(page.__file__).parents[2]), "PATH": ""}
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=paths) as process:
        lines = [process.stdout.readline() for _ in range(4)]
        assert re.fullmatch(r"http://127\.0\.0\.1:\d+/  until Ctrl-C\n", lines[-1])
        process.send_signal(signal.SIGINT)
        assert (process.stdout.read(), process.stderr.read().strip(), process.wait(60)) == ("", "", 0)
