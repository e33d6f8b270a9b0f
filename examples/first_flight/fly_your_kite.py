"""How does a kite of your own fly on a tether? The FMU moves it under the load that you compute: change `load`, `START`."""

from shutil import rmtree

import fmpy
import numpy as np

FMU, STEP, COUNT = "dist/TetherDynamicFree.fmu", 0.02, 3000  # communication steps [s], a minute of them
WIND, AREA, LIFT, DRAG = np.array([8.0, 0.0, 0.0]), 10.0, 0.7, 0.15  # m/s, m2, coefficients of a soft kite
START = {"kite_mass": 10.0, "initial_length": 200.0, "initial_kite_position[1]": 160.0, "initial_kite_position[3]": 120.0}


def load(position, velocity):
    """Lift and drag of the kite [N]: drag along the apparent wind, lift across it, away from the ground station."""
    wind = WIND - velocity
    across = position - (position @ wind) / (wind @ wind) * wind
    lift = LIFT * np.linalg.norm(wind) * across / np.linalg.norm(across)
    return 0.5 * 1.225 * AREA * np.linalg.norm(wind) * (DRAG * wind + lift)


if __name__ == "__main__":
    folder, description, rows = fmpy.extract(FMU), fmpy.read_model_description(FMU), []
    place = {variable.name: variable.valueReference for variable in description.modelVariables}
    names = "wind_velocity", "kite_load", "kite_position", "kite_velocity"
    wind, loads, x, v = ([place[f"{name}[{i}]"] for i in (1, 2, 3)] for name in names)
    fmu = fmpy.instantiate_fmu(folder, description, debug_logging=True)
    try:
        fmu.setupExperiment(startTime=0.0)
        fmu.setReal([*map(place.get, START), *wind], [*START.values(), *WIND])
        fmu.enterInitializationMode()
        fmu.exitInitializationMode()
        for k in range(COUNT):
            fmu.setReal(loads, load(*np.reshape(fmu.getReal(x + v), (2, 3))))  # 1. The load where the kite is now
            fmu.doStep(k * STEP, STEP)  # 2. moves the kite on its tether to the end of the step.
            rows.append([(k + 1) * STEP, *fmu.getReal([*x, *v, place["kite_tension"]])])
        fmu.terminate()
    except fmpy.fmi1.FMICallException as refusal:
        raise SystemExit(f"The flight ended at {len(rows) * STEP:.2f} s: {refusal} Above, the FMU says why.") from None
    finally:
        fmu.freeInstance()
        rmtree(folder, ignore_errors=True)
    for time, x, y, z, *_, tension in rows[499::500]:
        elevation = np.degrees(np.arctan2(z, np.hypot(x, y)))
        print(f"{time:.0f} s: {elevation:.1f} deg above the horizon, pulls with {tension:.0f} N")
