"""A system that starts in motion: parts that start in equilibrium move at the rate of their equilibrium.

Free points without a position, and force-controlled drums, start in equilibrium at rest. While driven points
move or winches turn, that equilibrium moves; a point that started at rest would be jerked. The rate is a central
difference over `SHORT` before and after the start.
"""

from dataclasses import replace

import numpy as np

from tetherfmu.python.system import TetherSystem
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.parameters import changed

SHORT = 0.01  # before and after the start, of a difference [s]
STILL = (0.0, 0.0, 0.0)


def started(found, given):
    """Arguments of `TetherSystem.initialize` from those of a step at the start; found : `SystemFile`."""
    own = {what: value for what, value in given.items() if what not in ("releases", "winch_lengths")}
    driven = {each.name: each.velocity for each in found.points if each.is_driven}
    return own | {"velocities": driven | own.get("velocities", {})}


def motion_of_equilibrium(found, given):
    """Velocities of sought free points and speeds of sought drums: arguments of `initialize`, by name.

    found : `SystemFile`.  given : its arguments, as for `started`.  {} if nothing moves, or nothing is sought.
    """
    points = [each.name for each in found.points if each.position is None and not any(each.velocity)]
    drums = [each.name for each in found.lines if is_sought(each.winch) and not each.reel_out_speed]
    shared = [each.name for each in found.winches if is_sought(each.drum) and not each.reel_out_speed]
    speeds = speeds_of_lines(found, given.get("reel_out_speeds", {}))
    moves = any(map(np.any, given["velocities"].values())) or any(speeds.values())
    if not moves or not (points or drums or shared):
        return {}
    before, after = (equilibrium(found, given, speeds, time) for time in (-SHORT, SHORT))

    def rate(value):
        """Of something of the outputs, a function of them."""
        return (value(after) - value(before)) / (2.0 * SHORT)

    velocities = {name: rate(lambda now, name=name: now.points[name].position) for name in points}
    turning = {name: rate(lambda now, name=name: now.lines[name].tether_length) for name in drums}
    turning |= {name: rate(lambda now, name=name: now.winches[name].payout) for name in shared}
    return {"velocities": velocities, "reel_out_speeds": turning}


def is_sought(winch):
    """Whether a `Winch` starts with the length that balances its force."""
    return winch.winch_control == at.WINCH_BY_FORCE and winch.winch_start == at.WINCH_IN_BALANCE


def speeds_of_lines(found, given):
    """Reel-out speeds [m/s] of lines, by name, whose winch is not sought; given : input speeds, by name."""
    by_speed = [each for each in found.winches if each.control == "speed"]
    speeds = {
        each.name: 0.0 if is_sought(each.winch) else float(given.get(each.name, each.reel_out_speed)) for each in found.lines
    }
    for winch in by_speed:
        for line, ratio in winch.lines.items():
            speeds[line] += ratio * float(given.get(winch.name, winch.reel_out_speed))
    return speeds


def equilibrium(found, given, speeds, time):
    """`SystemOutputs` of the system at rest where it would be at a time [s] before or after its start."""
    system = TetherSystem.of(found, lines=[with_length(each, time * speeds[each.name]) for each in found.lines])
    velocities = given["velocities"]
    positions = {name: np.add(place, time * np.asarray(velocities[name])) for name, place in given["positions"].items()}
    own = {what: value for what, value in given.items() if what != "reel_out_speeds"}
    return system.initialize(**own | {"positions": positions, "velocities": dict.fromkeys(velocities, STILL)})


def with_length(line, more):
    """A line with this additional unstretched length [m]; one with portions of given lengths is unchanged."""
    if not more or line.initial_portions is not None:
        return line
    return replace(line, tether=changed(line.tether, {"initial_length": line.tether.initial_length + more}))
