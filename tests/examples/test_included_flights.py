"""The flights that `tetherfmu fly --list` names fly without a warning: their ropes do not push, hang through or tear."""

import pytest

from tetherfmu.__main__ import main as tetherfmu
from tetherfmu.files.named import named_scenes, named_systems


@pytest.mark.parametrize("name", [*named_scenes(), *named_systems()])
def test_an_included_flight_warns_of_nothing(name, tmp_path, capfd, monkeypatch):
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", lambda *given, **options: None)
    assert tetherfmu(["fly", name, "--out", str(tmp_path)]) == 0
    said = capfd.readouterr().err
    assert "cannot" not in said
    assert "check" not in said
    assert "ground_height" not in said
