"""What the tests of native FMUs do with an FMU; each function runs in a process of its own."""

from contextlib import suppress

import numpy as np
from fmpy.fmi1 import FMICallException

from runtime.host import Host
from scenes import kite_at_start

STEP = 0.02  # [s]
MISUSES = (  # start values, values of a step, its size
    ({"segments": 0}, {}, STEP),
    ({"segments": 301}, {}, STEP),
    ({"diameter": -0.004}, {}, STEP),
    ({"density": 1e-320}, {}, STEP),
    ({"axial_stiffness": 1.2345678901234567e300}, {}, STEP),
    ({"damping_law": 3}, {}, STEP),
    ({"initial_length": 0.1}, {}, STEP),
    ({"wind_profile": 3, "surface_roughness": 10.1}, {}, STEP),
    ({"relative_tolerance": 0.1 + 1e-16}, {"reel_out_speed": 1e16}, STEP),
    ({"gravity": 123456789012345680.0}, {}, STEP),
    ({}, {"wind_velocity[1]": float("nan")}, STEP),
    ({}, {"ground_position[2]": -float("inf")}, STEP),
    ({}, {"ground_velocity[3]": 1.0000000000000002e9}, STEP),
    ({}, {}, 0.0),
    ({}, {}, -0.1 - 0.2),
    ({}, {}, 1e22),
    ({}, {"reel_out_speed": -505.0}, 1.0),
    ({"fixed_step": 1e-5}, {}, 1e5),
    ({"initial_length": 100.0}, {}, STEP),
    ({"initial_length": 123.456}, {"ground_velocity[1]": 5e5}, STEP),
    ({"shortest_length": 510.1, "longest_length": 510.1}, {}, STEP),
    ({"winch_control": 2, "shortest_length": 510.1}, {}, STEP),
    ({"winch_control": 2, "longest_length": 500.3}, {}, STEP),
    ({"winch_control": 2, "winch_friction": 0.1}, {"winch_force": -0.1 - 0.2}, STEP),
    ({"winch_control": 2, "initial_length": 490.0}, {"winch_force": 1e9}, STEP),
    ({"winch_control": 2, "winch_mass": 1e-3, "initial_length": 700.0}, {"winch_force": 2e3}, 0.1),
    ({"winch_control": 3, "initial_length": 551.3}, {}, STEP),
    ({"ground_contact": 2, "gravity": 0.0}, {}, STEP),
    ({"ground_sink": 1e-7}, {}, STEP),
    ({"initial_length": 560.0}, {}, STEP),
)


def said(path):
    """What is said to each of the misuses, without the name of the instance or of the call in front.

    Without what PythonFMU's library says of its own.
    """
    folder, texts = Host(path).folder, []
    for start, values, step in MISUSES:
        host = Host(folder)
        with suppress(FMICallException):
            host.start(**start)
            host.step(step, **values)
        texts.append([text.partition(": ")[2] for text in host.messages if "PyObject" not in text])
    return texts


def masses(path, diameters):
    """The outputs that follow from the diameter, at the start."""
    folder, found = Host(path).folder, []
    for diameter in diameters:
        host = Host(folder).start(diameter=diameter, density=1000.0 / 3.0, drag_coefficient=1.0 / 7.0)
        found.append(host.all_outputs())
        host.free()
    return found


def give(host, **derivatives):
    """First derivatives of inputs for the next step; a vector gives those of name[1], name[2], ..."""
    for name, value in derivatives.items():
        names = [name] if name in host.reference else [f"{name}[{i}]" for i in (1, 2, 3)]
        numbers = np.atleast_1d(value).tolist()
        host.fmu.setRealInputDerivatives([host.reference[each] for each in names], [1] * len(names), numbers)


def motion(time):
    """Position [m], velocity [m/s] and acceleration [m/s2] of a kite on a figure of eight."""
    slow, fast = 0.5 * time, 1.0 * time
    return (
        np.array([300.0 + 60.0 * np.cos(slow), 60.0 * np.sin(slow), 380.0 + 20.0 * np.sin(fast)]),
        np.array([-30.0 * np.sin(slow), 30.0 * np.cos(slow), 20.0 * np.cos(fast)]),
        np.array([-15.0 * np.cos(slow), -15.0 * np.sin(slow), -20.0 * np.sin(fast)]),
    )


def scene(name, time):
    """Inputs at a time and their derivatives, two dicts: all of them change."""
    inputs = {
        "reel_out_speed": (1.5 * np.sin(1.3 * time), 1.95 * np.cos(1.3 * time)),
        "wind_velocity": (
            np.array([8.0 + 2.0 * np.sin(0.9 * time), 1.0, 0.0]),
            np.array([1.8 * np.cos(0.9 * time), 0.0, 0.0]),
        ),
    }
    if name == "TetherDynamicFree":
        load = np.array([100.0 * np.sin(time), 120.0 * np.cos(1.2 * time), 800.0 + 100.0 * np.sin(1.1 * time)])
        change = np.array([100.0 * np.cos(time), -144.0 * np.sin(1.2 * time), 110.0 * np.cos(1.1 * time)])
        inputs["kite_load"] = load, change
    else:
        position, velocity, acceleration = motion(time)
        inputs |= {"kite_position": (position, velocity), "kite_velocity": (velocity, acceleration)}
    return {key: both[0] for key, both in inputs.items()}, {key: both[1] for key, both in inputs.items()}


def flown(path, step, given, tolerance=1e-6, **start):
    """Forces on ground and kite every 0.2 s of 6 s, of a free kite its position, array (rows, 6).

    given : whether the derivatives of the inputs are.
    """
    kite = kite_at_start(path.stem, *motion(0.0)[:2])
    host = Host(path).start(initial_length=525.0, relative_tolerance=tolerance, initial_shape=2, **kite, **start)
    rows = []
    for k in range(round(6.0 / step)):
        inputs, derivatives = scene(path.stem, k * step)
        if given:
            give(host, **derivatives)
        host.step(step, **inputs)
        if (k + 1) % round(0.2 / step) == 0:
            last = "kite_position" if path.stem == "TetherDynamicFree" else "kite_force"
            rows.append(host.get("ground_force") + host.get(last))
    return np.array(rows)
