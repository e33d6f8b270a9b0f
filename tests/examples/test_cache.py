"""FMUs that are kept for the user: where, when they are built, and that commands leave the folder one is in alone."""

import sys
from pathlib import Path

import pytest

from shared import cache
from tetherfmu.__main__ import main


@pytest.fixture
def home(tmp_path, monkeypatch):
    """The folder where they are kept in this test."""
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "kept"))
    cache.folder.cache_clear()
    yield tmp_path / "kept" / "tetherfmu"
    cache.folder.cache_clear()


def test_a_flight_writes_its_figures_alone_into_the_folder_one_is_in(home, tmp_path, monkeypatch, capsys):
    """The second one builds nothing; with --fmus they are in the folder that is named."""
    empty = tmp_path / "empty"
    empty.mkdir()
    monkeypatch.chdir(empty)
    flight = ["fly", "--tether", "straight", "--duration", "0.1"]
    assert main(flight) == 0
    (kept,) = home.rglob("*.fmu")
    assert f"{kept} is built" in capsys.readouterr().err
    assert [path.name for path in empty.iterdir()] == ["plots"]
    assert main(flight) == 0
    assert "is built" not in capsys.readouterr().err
    assert main([*flight, "--fmus", "mine"]) == 0
    assert (empty / "mine" / "TetherStraight.fmu").exists()


def test_an_fmu_in_dist_comes_first(home, tmp_path, monkeypatch, fmu_folder):
    (tmp_path / "dist").symlink_to(fmu_folder, target_is_directory=True)
    monkeypatch.chdir(tmp_path)
    assert main(["fly", "--tether", "straight", "--duration", "0.1"]) == 0
    assert not home.exists()


def test_other_sources_have_another_folder(home, tmp_path, monkeypatch):
    before = cache.folder.__wrapped__()
    (tmp_path / "changed.py").write_text("x = 1\n", encoding="utf-8")
    monkeypatch.setattr(cache, "PACKAGE", tmp_path)
    assert cache.folder.__wrapped__() != before
    assert cache.folder.__wrapped__().parent == before.parent == home


@pytest.mark.parametrize(
    ("platform", "variables", "place"),
    [
        ("linux", {"XDG_CACHE_HOME": "/x"}, Path("/x/tetherfmu")),
        ("linux", {"XDG_CACHE_HOME": ""}, Path.home() / ".cache/tetherfmu"),
        ("darwin", {}, Path.home() / "Library/Caches/tetherfmu"),
        ("win32", {"LOCALAPPDATA": "/l"}, Path("/l/tetherfmu")),
    ],
)
def test_they_are_where_the_platform_keeps_such_files(platform, variables, place, monkeypatch):
    monkeypatch.setattr(sys, "platform", platform)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert cache.of_user() == place
