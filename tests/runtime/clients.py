"""The circle, flown by each client: the same inputs, and one form of result.

The result of a client is a dict: name of an output to the list of its values at the start and after each step. Clients load
an FMU, so a test calls them in a process of their own (`isolation.own_process`).
"""

import os
import shutil
import subprocess
import sys
import sysconfig
from array import array
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from ctypes import CDLL, RTLD_GLOBAL
from functools import cache
from pathlib import Path
from threading import Lock

import numpy as np
from fmpy import extract, simulate_fmu
from fmpy.fmi2 import FMU2Slave

from isolation import own_process
from runtime import host
from scenes import circle, kite_at_start, kite_inputs

STEP, STEPS = 0.02, 500  # 10 s, a twelfth of the turn
# sizes of the steps: as they are meant; as rounded by clients that take differences of times, or of whole nanoseconds
EXACT = np.full(STEPS, STEP)
DIFFERENCES = np.diff(STEP * np.arange(STEPS + 1))
NANOSECONDS = np.diff(np.arange(STEPS + 1) * round(STEP * 1e9) / 1e9)
START_INTEGERS = {"segments": 12}
ONE_AT_A_TIME = Lock()


def numbers(vectors):
    """Numbers by FMI names, from a dict of vectors."""
    return {f"{name}[{i}]": float(number) for name, vector in vectors.items() for i, number in enumerate(vector, start=1)}


def start_reals(path):
    """Start values of Real variables for an FMU, by its path, or for a container of FMUs with driven kites."""
    kite = {**kite_inputs(path.stem, *circle(0.0)), **kite_at_start(path.stem, *circle(0.0))}
    return {"initial_length": 525.0, "wind_velocity[1]": 8.0, "reel_out_speed": 0.1, **numbers(kite)}


@cache
def flight(path):
    """Names of the inputs that move, and a row of their values for each communication point."""
    rows = [numbers(kite_inputs(path.stem, *circle(k * STEP))) for k in range(STEPS + 1)]
    return list(rows[0]), [list(row.values()) for row in rows]


def different(found, expected):
    """Names of the outputs that differ in any bit between two results."""
    assert list(found) == list(expected)
    return [name for name in expected if array("d", found[name]).tobytes() != array("d", expected[name]).tobytes()]


def difference(found, expected):
    """Largest difference between two results, relative to the largest value of each output."""
    assert list(found) == list(expected)
    largest = {name: max(map(abs, values)) or 1.0 for name, values in expected.items()}
    return max(abs(a - b) / largest[name] for name in expected for a, b in zip(found[name], expected[name], strict=True))


def description_of(path):
    """Model description of an FMU. One thread at a time: lxml, which validates it, now and then hangs in several."""
    with ONE_AT_A_TIME:
        return host.description_of(path)


def variables(path):
    """Of an FMU: value references by name; names of the Real and of the Integer variables that it calculates."""
    description = description_of(path)
    references = {
        variable.name: variable.valueReference for variable in description.modelVariables if variable.type != "Boolean"
    }
    outputs = [variable for variable in description.modelVariables if variable.causality in ("output", "local")]
    reals, integers = ([output.name for output in outputs if output.type == kind] for kind in ("Real", "Integer"))
    return references, reals, integers


@contextmanager
def instance(path, name="tether"):
    """An instance of an FMU in FMPy, initialized for the circle; freed and unloaded afterwards."""
    description = description_of(path)
    folder = extract(str(path))
    identifier = description.coSimulation.modelIdentifier
    fmu = FMU2Slave(guid=description.guid, unzipDirectory=folder, modelIdentifier=identifier, instanceName=name)
    references, _, _ = variables(path)
    reals = start_reals(path)
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.setReal([references[name] for name in reals], list(reals.values()))
    fmu.setInteger([references[name] for name in START_INTEGERS], list(START_INTEGERS.values()))
    fmu.exitInitializationMode()
    yield fmu
    fmu.terminate()
    fmu.freeInstance()
    shutil.rmtree(folder)


def fmpy(path, steps=EXACT):
    """FMPy, step by step."""
    references, reals, integers = variables(path)
    names, rows = flight(path)
    inputs = [references[name] for name in names]
    outputs = [[references[name] for name in names] for names in (reals, integers)]
    points = []
    with instance(path) as fmu:
        points.append(fmu.getReal(outputs[0]) + fmu.getInteger(outputs[1]))
        for k, step in enumerate(steps):
            fmu.setReal(inputs, rows[k])
            fmu.doStep(k * STEP, step)
            points.append(fmu.getReal(outputs[0]) + fmu.getInteger(outputs[1]))
    return _columns(reals + integers, points)


@cache
def expected_of(path, steps="EXACT"):
    """The result of `fmpy` with the steps of this name, flown once for all tests of a worker."""
    return own_process(fmpy, path=path, steps=globals()[steps])


def fmpy_simulate(path):
    """`simulate_fmu` of FMPy."""
    _, reals, integers = variables(path)
    time = STEP * np.arange(STEPS + 1)
    names, rows = flight(path)
    signal = np.rec.fromarrays([time, *np.transpose(rows)], names=["time", *names])
    start, output = {**start_reals(path), **START_INTEGERS}, reals + integers
    result = simulate_fmu(
        str(path), stop_time=time[-1], output_interval=STEP, input=signal, start_values=start, output=output
    )
    return {name: result[name].tolist() for name in output}


def fmpy_in_threads(path, count):
    """The results of FMPy in several threads at once."""
    with ThreadPoolExecutor(count) as pool:
        return list(pool.map(fmpy, [path] * count))


def libcosim(path):
    """libcosim, the library of the Open Simulation Platform, through libcosimpy."""
    from libcosimpy.CosimEnums import CosimVariableType
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimManipulator import CosimManipulator
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    references, reals, integers = variables(path)
    inputs, rows = flight(path)
    execution = CosimExecution.from_step_size(round(STEP * 1e9))
    slave = execution.add_local_slave(CosimLocalSlave(str(path), "tether"))
    for name, value in start_reals(path).items():
        assert execution.real_initial_value(slave, references[name], value)
    for name, value in START_INTEGERS.items():
        assert execution.integer_initial_value(slave, references[name], value)
    observer = CosimObserver.create_time_series(buffer_size=STEPS + 1)
    assert execution.add_observer(observer)
    for names, kind in ((reals, CosimVariableType.REAL), (integers, CosimVariableType.INTEGER)):
        assert all(observer.start_time_series(slave, references[name], kind) for name in names)
    override = CosimManipulator.create_override()
    assert execution.add_manipulator(override)
    for row in rows[:-1]:
        assert override.slave_real_values(slave, [references[name] for name in inputs], row)
        assert execution.step()
    result = {}
    for names, samples in ((reals, observer.time_series_real_samples), (integers, observer.time_series_integer_samples)):
        for name in names:  # in two parts: libcosimpy counts step 0 as an empty place and drops the last sample for it
            result[name] = samples(slave, references[name], 0, 2)[2] + samples(slave, references[name], 1, STEPS)[2]
    return result


def ecos():
    """The module of ecospy's simulations; its library needs one of the package tbb, which lies where no linker looks."""
    CDLL(str(Path(sys.prefix) / "lib" / "libtbb.so.12"), mode=RTLD_GLOBAL)
    import ecospy

    return ecospy


def ecos_step_by_step(path):
    """Ecos, a master in C++, through ecospy."""
    _, reals, integers = variables(path)
    names, rows = flight(path)
    client, points = ecos(), []
    with client.EcosSimulationStructure() as structure:
        structure.add_model("tether", str(path))
        start = {f"tether::{name}": value for name, value in {**start_reals(path), **START_INTEGERS}.items()}
        structure.add_parameter_set("start", start)
        with client.EcosSimulation(structure=structure, step_size=STEP) as simulation:
            assert simulation.init(parameter_set="start")
            for k in range(STEPS + 1):
                point = [simulation.get_real(f"tether::{name}") for name in reals]
                points.append(point + [simulation.get_integer(f"tether::{name}") for name in integers])
                for name, value in zip(names, rows[k], strict=True):
                    simulation.set_real(f"tether::{name}", value)
                simulation.step()
            simulation.terminate()
    return _columns(reals + integers, points)


def container(paths, folder, **options):
    """A container of fmu-manipulation-toolbox in FMPy."""
    return fmpy(build_container(paths, folder, **options))


def build_container(paths, folder, **options):
    """A container of FMUs with common inputs and parameters; returns its path.

    Outputs carry the name of their FMU in front where there are several.
    """
    from fmu_manipulation_toolbox.container import FMUContainer

    built = FMUContainer("tethers", paths[0].parent)
    for path in paths:
        references, reals, integers = variables(path)
        built.get_fmu(path.name)
        for name in [name for name in references if name not in reals + integers]:
            built.add_input(name, path.name, name)
        for name in reals + integers:
            built.add_output(path.name, name, name if len(paths) == 1 else f"{path.stem}.{name}")
    target = folder / (paths[0].name if len(paths) == 1 else "tethers.fmu")
    built.make_fmu(target, step_size=STEP, **options)
    return target


def python_library():
    """Path of the shared library of this Python, or None."""
    path = Path(sysconfig.get_config_var("LIBDIR") or "") / (sysconfig.get_config_var("INSTSONAME") or "none")
    return path if ".so" in path.name and path.is_file() else None


def c_host(program, path, folder, plan, end="finalize", preloaded=(), under=()):
    """The program of `c_host.c`; the results of all flights of its plan.

    For an FMU that needs it, the library of Python is preloaded.  under : command that runs the program, such as valgrind.
    """
    references, reals, integers = variables(path)
    description = description_of(path)
    shared = host.shared_folder(path)
    extracted = shared if shared.is_dir() else Path(extract(str(path), unzipdir=str(folder / path.stem)))
    scenario = folder / f"{path.stem}.txt"
    _write_scenario(scenario, path, references, reals, integers)
    library = extracted / "binaries" / "linux64" / f"{description.coSimulation.modelIdentifier}.so"
    resources = (extracted / "resources").as_uri()
    environment = {**os.environ, "PYTHONHOME": sys.base_prefix, "PYTHONPATH": ""}
    if description.coSimulation.needsExecutionTool:
        environment["LD_PRELOAD"] = ":".join(map(str, [*preloaded, python_library()]))
    done = subprocess.run(
        [*under, program, library, description.guid, resources, scenario, plan, end],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, f"exit status {done.returncode}: {done.stderr}"
    kinds = [float.fromhex] * len(reals) + [int] * len(integers)
    flights = [[line.split() for line in flight.splitlines()] for flight in done.stdout.split("\n\n")[:-1]]
    points = [[[kind(word) for kind, word in zip(kinds, line, strict=True)] for line in flight] for flight in flights]
    return [_columns(reals + integers, each) for each in points]


def _write_scenario(file, path, references, reals, integers):
    """The circle as `c_host.c` reads it."""
    words = []
    for names in (start_reals(path), START_INTEGERS):
        words += [len(names), *(references[name] for name in names), *names.values()]
    inputs, rows = flight(path)
    for names in (inputs, reals, integers):
        words += [len(names), *(references[name] for name in names)]
    words += [STEPS, *EXACT.tolist(), *np.ravel(rows[:-1]).tolist()]
    file.write_text(" ".join(float(word).hex() for word in words))


def _columns(names, points):
    return {name: list(column) for name, column in zip(names, zip(*points, strict=True), strict=True)}
