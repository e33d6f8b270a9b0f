"""What the tests of native FMUs do with an FMU; each function runs in a process of its own."""

import numpy as np

from runtime.host import Host
from scenes import kite_at_start


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
