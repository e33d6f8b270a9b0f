"""The examples on tethers at rest: each runs in a process of its own, prints its forces, draws, and ends cleanly."""

import re

import numpy as np

from running import assert_is_drawn, run

HALF_NODE = 0.08925189330624916 * 853.0240324867758 / 44.0  # weight of an end node of 22 segments [N]
PUBLISHED = {  # forces on the ground station and on the kite [N]: exact catenary; chain, without its end nodes
    "catenary": [1.97642, 1.97642, -1.57910, -1.97642, -1.97642, -74.55491],
    "22 segments": [1.92751, 1.92751, 0.04248 - HALF_NODE, -1.92751, -1.92751, -72.71586 - HALF_NODE],
}


def test_catenary(fmu_folder, tmp_path):
    printed = run(fmu_folder, f"from at_rest import catenary; catenary.main(['--out', {str(tmp_path)!r}])")
    lines = (line.partition(":") for line in printed.splitlines())
    found = {name: [float(each) for each in re.findall(r"-?\d+\.\d{3}", said)] for name, _, said in lines}
    assert list(found) == ["catenary", "5 segments", "22 segments"]
    for name, expected in PUBLISHED.items():
        assert np.allclose(found[name], expected, atol=1e-3)  # printed with three digits
    assert_is_drawn(tmp_path / "catenary.png")


def test_forces_over_wind_and_slack(fmu_folder, tmp_path):
    """Dynamic and quasi-steady forces are the same; the lines come close where the tether is taut; wind pulls."""
    printed = run(
        fmu_folder,
        f"""
import numpy as np
from at_rest.forces_over_wind_and_slack import main, survey
main(["--out", {str(tmp_path)!r}])
forces = survey(slacks=(-0.01, 0.02), winds=(0.0, 10.0, 20.0))
assert np.array_equal(forces["dynamic"], forces["quasi_steady"])
assert np.allclose(forces["catenary"][0], forces["dynamic"][0], rtol=0.01)
assert np.allclose(forces["straight"][0], forces["dynamic"][0], rtol=0.1)
assert all((np.diff(each[:, 1:, 1], axis=1) > 0.0).all() for each in forces.values())
""",
    )
    names = [line.split(":")[0] for line in printed.splitlines() if "the load on the shape" not in line]
    assert names == ["dynamic", "quasi_steady", "catenary", "straight"]
    assert_is_drawn(tmp_path / "forces_over_wind_and_slack.png")
