"""What takes long is told on stderr, on a terminal only."""

import os
import sys

import pytest

from tetherfmu.__main__ import main


@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no such terminals")
@pytest.mark.parametrize("terminal", [True, False])
def test_only_a_terminal_is_told_what_begins(fmu_folder, terminal, monkeypatch):
    reader, writer = os.openpty() if terminal else os.pipe()
    fmu, said = fmu_folder / "TetherStraight.fmu", b""
    with os.fdopen(writer, "w") as stream:
        monkeypatch.setattr(sys, "stderr", stream)
        assert main(["check", str(fmu)]) == 0
        print("end", file=stream, flush=True)
        while b"end" not in said:
            said += os.read(reader, 1000)
    assert said.decode().splitlines() == [f"checking {fmu} ...", "end"][not terminal :]
