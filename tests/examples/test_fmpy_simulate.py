"""The way without a script: the commands and the input file of docs/use/start.md, as they stand there."""

import os
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest

from manual import codes, page

G, MASS = 9.81, 500.0


@pytest.mark.skipif(sys.platform == "win32", reason="the commands are those of a shell")
def test_a_lean_fmu_an_input_file_and_an_output_file(tmp_path):
    """The load hangs at rest, then it is 0.25 m/s2 lighter."""
    section = page("use/start").partition("## Without a script")[2].partition("\n## ")[0]
    (build, simulate), (rows,) = codes(section, "bash"), codes(section, "csv")
    (tmp_path / "winch.csv").write_text(rows, encoding="utf-8")
    environment = {**os.environ, "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]])}
    command = ["sh", "-e", "-c", build + simulate]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "Warning: missing input" not in done.stdout + done.stderr
    assert "  reel_out_speed = 0 [m/s]: " in done.stdout
    assert "  kite_start = given: " in done.stdout
    found = pd.read_csv(tmp_path / "crane.csv")
    assert found.time.iloc[-1] == pytest.approx(12.0)
    assert found.kite_tension[found.time < 2.0].to_numpy() == pytest.approx(MASS * G, rel=0.01)
    lighter = found.kite_tension[(found.time > 2.5) & (found.time < 5.9)].mean()
    assert lighter == pytest.approx(MASS * (G - 0.25), rel=0.005)
    assert found.tether_length.iloc[-1] == pytest.approx(40.0 + 2.0 + 6.0, abs=0.01)
