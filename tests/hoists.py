"""A load on a light rope over a sheave from a drum with stops: the system, and equations written here, solved by DOP853.

The drum stops without a bounce (L' = 0), and is let go when the rope pulls less than W at the longest length, or more than W
at the shortest. A heavy sling, if there is one, hangs between rope and load.
"""

import numpy as np
from scipy.integrate import solve_ivp

from tetherfmu import Line, Point, Tether, TetherSystem, Winch

G, EA, DAMPING, DRUM, SHEAVE, LOAD = 9.81, 2e4, 40.0, 5.0, 0.5, 20.0  # [m/s2], [N], [N.s], then masses [kg]
EA_SLING, SLING, KNOT = 1e5, 2.0, 3.0  # of the sling: [N], length [m], half of its mass [kg]
NO_MASS = {"diameter": 1e-4, "mass_per_length": 1e-9, "drag_coefficient": 0.0, "slack_stiffness_ratio": 0.0}


def hoist(solver, has_sling, **stops):
    """A load at 12 m of rope, of which the last 2 m may be a sling, beyond a sheave, which is 8 m from the winch."""
    points = [Point("winch", (-8.0, 0.0, 0.0)), Point("head", (0.0, 0.0, 0.0)), Point("load", (0.0, 0.0, -12.05), mass=LOAD)]
    beyond = SLING if has_sling else 0.0
    tethers = [Tether(segments=1, initial_length=20.0 - beyond, axial_stiffness=EA, axial_damping=DAMPING, **NO_MASS)]
    if has_sling:
        heavy = {**NO_MASS, "diameter": 0.02, "mass_per_length": 2.0 * KNOT / SLING}
        tethers.append(Tether(segments=1, initial_length=SLING, axial_stiffness=EA_SLING, axial_damping=0.0, **heavy))
    winch = Winch(winch_control="force", winch_mass=DRUM, **stops)
    sheave = {"through": ["head"], "initial_portions": [8.0, 12.0], "sheave_mass": SHEAVE}
    return TetherSystem(points, [Line("rope", "winch", "load", tuple(tethers), winch=winch, **sheave)], solver=solver)


def pulls(stretched, length, rate, growth):
    """Tension of a segment, and tension where rope enters it [N]; with their rates [m/s]."""
    if stretched < length:
        return 0.0, 0.0
    damper = DAMPING / length * (rate - stretched / length * growth)
    pull = EA * (stretched**2 / length**2 - 1.0) / 2.0 + damper * stretched / length
    return EA * (stretched / length - 1.0) + damper, 2.0 * pull / (1.0 + np.sqrt(1.0 + 2.0 * pull / EA))


def rates(state, is_held, force, has_sling):
    """Rates of the heights of load and end of the rope, of L and of the rope over the sheave, and of their speeds."""
    load, end, length, passed, climb, rise, speed, running = state
    _, behind = pulls(8.0, length - passed - 12.0, 0.0, speed - running)
    tension, ahead = pulls(-end, 12.0 - has_sling * SLING + passed, -rise, running)
    gained = [tension / LOAD - G] * 2
    if has_sling:
        below = max(EA_SLING * ((end - load) / SLING - 1.0), 0.0)
        gained = [below / (LOAD + KNOT) - G, (tension - below) / KNOT - G]
    turning = (0.0, 0.0) if is_held else (speed, (behind - force) / DRUM)
    return climb, rise, turning[0], running, *gained, turning[1], (ahead - behind) / SHEAVE


def solved(force, times, heights, has_sling, shortest_length=0.0, longest_length=np.inf):
    """Height of the load, L and rope over the sheave at these times [s], and the times of the events.

    force : W [N] over time.  heights : of load and end of the rope at the start [m].
    """
    state, now, side, found, events = np.array((*heights, 20.0, *5 * [0.0])), 0.0, 0, [], []

    def excess(time, state, *_):
        _, tension = pulls(8.0, state[2] - state[3] - 12.0, 0.0, -state[7])
        return tension - force(time)

    def reaching(stop, direction):
        def left(_, state):
            return state[2] - stop

        left.terminal, left.direction = True, direction
        return left

    excess.terminal = True
    stops = [reaching(longest_length, 1.0), reaching(shortest_length, -1.0)]
    while now < times[-1]:
        excess.direction = -side
        piece = solve_ivp(
            lambda time, state, held=side: rates(state, held, force(time), has_sling),
            (now, times[-1]), state, "DOP853", events=[excess] if side else stops,
            rtol=1e-11, atol=1e-12, dense_output=True, max_step=0.001,
        )  # fmt: skip
        found += [piece.sol(time)[[0, 2, 3]] for time in times if now < time <= piece.t[-1]]
        now, state = piece.t[-1], piece.y[:, -1]
        if piece.status == 1:
            events.append(now)
            side = 0 if side else (1 if len(piece.t_events[0]) else -1)
            state[6] = 0.0
            side = side if excess(now, state) * side > 0.0 else 0
    return np.array(found), events


def flown(system, force, times):
    """As `solved`, of a system that steps from each of these times, which are equally apart, to the next."""
    start, found = system.initialize(winch_forces={"rope": force(0.0)}), []
    heights = start.points["load"].position[2], system.positions["rope"][2][2]
    for time in times:
        outputs = system.step(times[0], winch_forces={"rope": force(time - times[0])})
        line, own = outputs.lines["rope"], outputs.portions["rope"]
        found.append((outputs.points["load"].position[2], line.tether_length, own.payout[0]))
    return np.array(found), heights
