"""The example prints what its FMU finds implausible, in one line."""

from running import EXAMPLES, run_python


def test_a_tether_that_is_too_short(fmu_folder, tmp_path):
    options = ["--fmu", fmu_folder / "TetherStraight.fmu", "--length", "100", "--duration", "1", "--out", tmp_path]
    done = run_python(EXAMPLES / "first_flight" / "circular_flight.py", *options)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("stretched by 400 %, where any rope is broken") == 1
    assert done.stdout.count("%%") == 0
