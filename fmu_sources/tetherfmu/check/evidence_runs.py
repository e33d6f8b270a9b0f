"""The evidence sets of an FMU, and a run with them in this process, which the FMU may end (`apart.py`); needs FMPy."""

import csv
import io
import zipfile
from contextlib import suppress
from itertools import pairwise
from math import prod
from pathlib import PurePosixPath
from shutil import rmtree
from typing import NamedTuple

EVIDENCE_FOLDER = "documentation/evidence/"
OPTIONS = ("StartTime", "StopTime", "StepSize", "RelTol", "AllowedDeviation")
INTERVAL = "OutputIntervalLength"  # the step


class Evidence(NamedTuple):
    """An evidence set of an FMU."""

    inputs: str  # text of the input file
    outputs: list  # names of the variables, without "time"; in FMI 3 of arrays
    reference: dict  # name to list of numbers, including "time"; array elements are name[1], name[2], ...
    options: dict  # name to number
    starts: dict  # of parameters, name to number


def evidence_of(path):
    """The evidence sets in an FMU, dict by kind, "" first; KeyError or ValueError if one is unreadable.

    The kind is the part of the file names between the name of the FMU and their ending: the winch input is a speed in
    "", a force in "force", a length in "length".
    """
    files = {}
    with zipfile.ZipFile(path) as opened:
        for name in opened.namelist():
            if name.startswith(EVIDENCE_FOLDER) and PurePosixPath(name).suffix in (".csv", ".opt"):
                of_set, _, ending = PurePosixPath(name).name.rpartition("_")
                files.setdefault(of_set, {})[ending] = opened.read(name).decode("utf-8")
    shortest = min(files, key=len, default="")
    return {of_set.removeprefix(shortest).strip("_"): read(files[of_set]) for of_set in sorted(files, key=len)}


def read(files):
    """`Evidence` of the texts of its files, by the ends of their names."""
    head, *rows = csv.reader(io.StringIO(files["ref.csv"]))
    columns = zip(*rows, strict=True)
    reference = {}
    for name, column in zip(head, columns, strict=True):
        reference |= by_element(name, [[float(number) for number in cell.split(" ")] for cell in column])
    given = {name: float(value) for name, value in csv.reader(io.StringIO(files["ref.opt"]), skipinitialspace=True)}
    options = {name: given[name] for name in OPTIONS}
    starts = {name: value for name, value in given.items() if name not in (*options, INTERVAL)}
    return Evidence(files["in.csv"], head[1:], reference, options, starts)


def by_element(name, rows):
    """Values of a variable, a list for each time, as a dict of the name of each element to its list of numbers."""
    columns = list(zip(*rows, strict=True))
    names = [name] if len(columns) == 1 else [f"{name}[{i}]" for i in range(1, len(columns) + 1)]
    return {name: list(column) for name, column in zip(names, columns, strict=True)}


def signals_of(text):
    """Columns of an input file in FMPy's form, a structured array; several numbers in a cell are an array.

    FMPy (0.3.32) splits names at commas, even within quotes, such as "wind_at[1,2]".
    """
    import numpy as np

    head, *rows = csv.reader(io.StringIO(text))
    cells = [[tuple(map(float, cell.split(" "))) for cell in row] for row in rows]
    kinds = [(name, float, (len(cell),) if len(cell) > 1 else ()) for name, cell in zip(head, cells[0], strict=True)]
    return np.array([tuple(cell if len(cell) > 1 else cell[0] for cell in row) for row in cells], dtype=kinds)


def replay(path, evidence):
    """Run an FMU with the inputs and options of an evidence set: dict of name to list of numbers, as far as it ran."""
    from fmpy import simulate_fmu

    signals, options = signals_of(evidence.inputs), evidence.options
    if any(signals.dtype[name].shape for name in signals.dtype.names):
        return step_by_step(path, signals, evidence)
    result = simulate_fmu(
        str(path),
        fmi_type="CoSimulation",
        start_time=options["StartTime"],
        stop_time=options["StopTime"],
        output_interval=options["StepSize"],
        relative_tolerance=options["RelTol"],
        input=signals,
        output=evidence.outputs,
        start_values=evidence.starts,
    )
    return {name: result[name].tolist() for name in result.dtype.names}


def step_by_step(path, signals, evidence):
    """As `replay`, for arrays of FMI 3, which FMPy's `simulate_fmu` cannot combine with scalars (0.3.32)."""
    from fmpy import extract, read_model_description
    from fmpy.fmi1 import FMICallException
    from fmpy.fmi3 import FMU3Slave

    description, folder, options = read_model_description(str(path)), extract(str(path)), evidence.options
    variables = {variable.name: variable for variable in description.modelVariables}
    model = description.coSimulation.modelIdentifier
    fmu = FMU3Slave(guid=description.guid, unzipDirectory=folder, modelIdentifier=model, instanceName=model)
    fmu.instantiate()

    def put(row):
        for name in signals.dtype.names[1:]:
            fmu.setFloat64([variables[name].valueReference], row[name].ravel().tolist())

    def outputs():
        wanted = {name: variables[name] for name in evidence.outputs}
        return {name: fmu.getFloat64([each.valueReference], prod(each.shape or (1,))) for name, each in wanted.items()}

    for name, value in evidence.starts.items():
        is_whole = variables[name].type == "Enumeration"
        (fmu.setInt64 if is_whole else fmu.setFloat64)([variables[name].valueReference], [int(value) if is_whole else value])
    put(signals[0])
    fmu.enterInitializationMode(tolerance=options["RelTol"], startTime=options["StartTime"], stopTime=options["StopTime"])
    fmu.exitInitializationMode()
    rows = [{"time": [options["StartTime"]]} | outputs()]
    with suppress(FMICallException):  # a refused step is the end
        for row, end in pairwise(signals):
            put(row)
            fmu.doStep(float(row["time"]), float(end["time"] - row["time"]))
            rows.append({"time": [float(end["time"])]} | outputs())
    fmu.freeInstance()
    rmtree(folder, ignore_errors=True)
    found = {}
    for name in rows[0]:
        found |= by_element(name, [row[name] for row in rows])
    return found
