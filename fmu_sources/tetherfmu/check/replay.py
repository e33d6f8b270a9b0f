"""Run an FMU with its evidence set in this process: `python -m tetherfmu.check.replay FILE.fmu RESULT.json`; needs FMPy.

`tetherfmu.check` starts it as a process of its own, so that a crash of the FMU is a finding and not the end of the check.
"""

import csv
import io
import json
import sys
import tempfile
import zipfile
from pathlib import Path, PurePosixPath
from typing import NamedTuple

EVIDENCE_FOLDER = "documentation/evidence/"
OPTIONS = ("StartTime", "StopTime", "StepSize", "RelTol", "AllowedDeviation")


class Evidence(NamedTuple):
    """The evidence set of an FMU."""

    inputs: str  # text of the input file
    reference: dict  # name to list of numbers, "time" among them
    options: dict  # name to number


def evidence_of(path):
    """The evidence set in an FMU, or None; KeyError or ValueError if it is there and cannot be read."""
    with zipfile.ZipFile(path) as opened:
        files = {
            name.rpartition("_")[2]: opened.read(name).decode("utf-8")
            for name in opened.namelist()
            if name.startswith(EVIDENCE_FOLDER) and PurePosixPath(name).suffix in (".csv", ".opt")
        }
    if not files:
        return None
    head, *rows = csv.reader(io.StringIO(files["ref.csv"]))
    columns = zip(*rows, strict=True)
    reference = {name: [float(text) for text in column] for name, column in zip(head, columns, strict=True)}
    given = {name: float(value) for name, value in csv.reader(io.StringIO(files["ref.opt"]), skipinitialspace=True)}
    return Evidence(files["in.csv"], reference, {name: given[name] for name in OPTIONS})


def replay(path, evidence):
    """Run an FMU with the inputs and options of its evidence set: dict of name to list of numbers, as far as it ran."""
    from fmpy import simulate_fmu
    from fmpy.util import read_csv

    with tempfile.TemporaryDirectory() as folder:
        inputs = Path(folder) / "in.csv"
        inputs.write_text(evidence.inputs, encoding="utf-8")
        signals = read_csv(str(inputs))
    options = evidence.options
    result = simulate_fmu(
        str(path),
        fmi_type="CoSimulation",
        start_time=options["StartTime"],
        stop_time=options["StopTime"],
        output_interval=options["StepSize"],
        relative_tolerance=options["RelTol"],
        input=signals,
        output=[name for name in evidence.reference if name != "time"],
    )
    return {name: result[name].tolist() for name in result.dtype.names}


if __name__ == "__main__":
    outcome = replay(sys.argv[1], evidence_of(sys.argv[1]))
    Path(sys.argv[2]).write_text(json.dumps(outcome), encoding="utf-8")
