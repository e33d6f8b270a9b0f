"""A scene flown with an FMU in FMPy: what a step costs there. Each flight runs in a process of its own.

python -m tetherfmu.study.measuring.flown_fmu FMU FLIGHT      prints JSON: time [s] of all steps, last force on the kite [N]
"""

import atexit
import json
import subprocess
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path
from time import perf_counter

import numpy as np

from tetherfmu.runtime import layout as at
from tetherfmu.study.scenes.standard import QUASI_STEADY_START

from .through_fmpy import references, vectors

INPUTS = (
    ("kite_position", at.KITE_POSITION),
    ("kite_velocity", at.KITE_VELOCITY),
    ("ground_position", at.GROUND_POSITION),
    ("ground_velocity", at.GROUND_VELOCITY),
    ("wind_velocity", at.WIND_VELOCITY),
)
FMUS = {
    "straight": "TetherStraight",
    "catenary": "TetherCatenary",
    "quasi_steady": "TetherQuasiSteady",
    "dynamic": "TetherDynamic",
}


def flight_of(scene, config):
    """What the process needs: parameters, and inputs by name, those that change with a row for each step."""
    inputs = scene.inputs(config.step)
    columns = {f"{name}[{i + 1}]": inputs[:, place + i] for name, place in INPUTS for i in range(3)}
    columns["reel_out_speed"] = inputs[:, at.REEL_OUT_SPEED]
    moving = [name for name, values in columns.items() if np.ptp(values) > 0.0]
    parameters = {**asdict(scene.tether), **asdict(scene.environment)}
    parameters |= {"segments": config.segments or 1, "relative_tolerance": config.tolerance}
    return {
        "step": config.step,
        "parameters": {**parameters, "initial_shape": QUASI_STEADY_START},
        "first": {name: float(values[0]) for name, values in columns.items()},
        "moving": moving,
        "rows": inputs_of(columns, moving, len(inputs)),
    }


def inputs_of(columns, names, count):
    """Rows of the columns of some names, nested lists."""
    return np.stack([columns[name] for name in names], -1).tolist() if names else [[]] * count


def fly(fmu, description, flight):
    """Time [s] of all steps, set and get included, and the last force on the kite [N]."""
    table = references(description)
    kinds = {variable.name: variable.type for variable in description.modelVariables}
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    for name, value in flight["parameters"].items():
        if kinds[name] == "Real":
            fmu.setReal([table[name]], [value])
        else:
            fmu.setInteger([table[name]], [value])
    fmu.enterInitializationMode()
    fmu.setReal([table[name] for name in flight["first"]], list(flight["first"].values()))
    fmu.exitInitializationMode()
    moving = [table[name] for name in flight["moving"]]
    wanted = vectors(table, "ground_force", "kite_force")
    step = flight["step"]
    began = perf_counter()
    for k, row in enumerate(flight["rows"]):
        if row:
            fmu.setReal(moving, row)
        fmu.doStep(k * step, step)
        forces = fmu.getReal(wanted)
    return {"seconds": perf_counter() - began, "kite_force": forces[3:]}


def main(path, flight_file):
    """Load the FMU, fly, print."""
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Slave

    description = read_model_description(path)
    name = description.coSimulation.modelIdentifier
    fmu = FMU2Slave(guid=description.guid, unzipDirectory=extract(path), modelIdentifier=name, instanceName=name)
    if hasattr(fmu.dll, "finalizePythonInterpreter"):  # as in `through_fmpy`
        atexit.register(fmu.dll.finalizePythonInterpreter)
    flight = json.loads(Path(flight_file).read_text(encoding="utf-8"))
    print(json.dumps(fly(fmu, description, flight)))
    fmu.terminate()
    fmu.fmi2FreeInstance(fmu.component)


def flown(folder, scene, config):
    """Time per simulated second [-] through FMPy, and the last force on the kite [N], of a configuration.

    folder : with the FMUs.
    """
    with tempfile.TemporaryDirectory() as temporary:
        file = Path(temporary) / "flight.json"
        file.write_text(json.dumps(flight_of(scene, config)), encoding="utf-8")
        path = Path(folder) / f"{FMUS[config.variant]}.fmu"
        command = [sys.executable, "-m", "tetherfmu.study.measuring.flown_fmu", str(path), str(file)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    result = json.loads(done.stdout.splitlines()[-1])
    return result["seconds"] / (scene.count * scene.every), result["kite_force"]


if __name__ == "__main__":
    main(*sys.argv[1:])
