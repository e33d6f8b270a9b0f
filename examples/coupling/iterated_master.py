"""What does an implicit master cost that repeats each step until kite and tether agree? Two FMUs that go back in time.

    python examples/coupling/iterated_master.py

`FlyingKite` takes the force of the tether and gives its motion, `TetherDynamic` the other way round. The master saves the
state of both at t. It guesses the force at t + h, lets the kite move under it, moves the tether to where the kite is
then, and compares the force that the tether then has with the guess. While they differ by more than a tolerance, both go
back to t, with a better guess: that of Aitken's method, or another (`--next-guess`).

The other master in this file needs no way back: `PointMassKite` gives its load to `TetherDynamicFree`, which moves the kite.
Both fly the same kite; the errors are those of the force on the kite, against a free end in steps of a tenth. Times are
medians of flights that take turns. docs/use/coupling.md compares all ways.
"""

import sys
from pathlib import Path
from time import perf_counter
from typing import NamedTuple

import numpy as np

from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, number
from tetherfmu.console.progress import now

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms
from coupling.ways_of_coupling import inputs_towards
from shared.fmu_tools import add_fmu, find_fmu, variables_of
from shared.named_fmu import all_running

START = 504.7 * np.array([0.6, 0.0, 0.8])  # of the kite [m]
MASS, WIND, STEERING = 10.0, (8.0, 0.0, 0.0), 0.1  # kg, m/s, -
GRAVITY, LARGEST_COUNT, ROUNDS = 9.81, 30, 5  # m/s2; iterations in a step; flights for a time
LINEAR, INTERPOLATED = 1, 3  # inputs of the kite belong to the start, to the end of the step
MOTION = ("kite_position", "kite_velocity")
CONTROL = {"wind_velocity": WIND, "steering": STEERING}


class Flown(NamedTuple):
    """Force on the kite [N], a row for each communication point; tether steps for each; wall time [s]."""

    forces: np.ndarray
    tether_steps: float
    seconds: float


def aitken(guess, residual, last):
    """A better guess [N], by the relaxation that would have made the last two residuals [N] vanish best.

    last : dict with what is kept from one iteration of a step to the next; modified.
    """
    relaxation = 1.0
    if "residual" in last:
        change = residual - last["residual"]
        relaxation = -last["relaxation"] * (last["residual"] @ change) / (change @ change)
    last.update(residual=residual, relaxation=relaxation)
    return guess + relaxation * residual


def fixed_point(guess, residual, _last):
    """The force [N] that the tether gave is the next guess."""
    return guess + residual


def newton(guess, residual, last):
    """A guess [N] that foresees by how much the tether answers to it, along the tether, if it were a spring and a damper."""
    along = guess / np.linalg.norm(guess)
    return guess + residual - last["gain"] / (1.0 + last["gain"]) * (residual @ along) * along


NEXT_GUESS = {"aitken": aitken, "fixed-point": fixed_point, "newton": newton}


def gain(tether, kite_mass, h):
    """Change of the force of the tether over that of the guess: k h^2/6 + c h/2 over the mass [-], for `newton`."""
    return h * (tether.get("kite_stiffness") * h / 6.0 + 0.5 * tether.get("kite_damping")) / kite_mass


def iterated_step(kite, tether, led, time, h, tolerance, improve, kite_mass):
    """One communication step [s], repeated until guess and force differ by less than the tolerance [N].

    led : velocity [m/s] and step [s] that the tether got last; modified.  Returns the force and the number of tether steps.
    """
    lifted = np.array([0.0, 0.0, tether.get("kite_end_mass") * GRAVITY])  # weight that the kite has in its mass already
    position, velocity = kite.get("kite_position"), kite.get("kite_velocity")
    last = {"gain": gain(tether, kite_mass, h)}
    with kite.saved() as kite_goes_back, tether.saved() as tether_goes_back:
        tether.set(kite_position=position, kite_velocity=velocity)  # 1. A first guess: the kite goes on as it did.
        tether.step(time, h)
        guess = tether.get("kite_force")
        for count in range(LARGEST_COUNT):
            kite.set(kite_force=guess + lifted)  # 2. The kite under the guess.
            kite.step(time, h)
            position, velocity = inputs_towards(kite.get("kite_position"), kite.get("kite_velocity"), *led, h)
            tether_goes_back()
            tether.set(kite_position=position, kite_velocity=velocity)  # 3. The tether led to where the kite has come.
            tether.step(time, h)
            residual = tether.get("kite_force") - guess
            if np.linalg.norm(residual) < tolerance:
                led[:] = velocity, h
                return tether.get("kite_force"), count + 2
            guess = improve(guess, residual, last)  # 4. Another guess, from the start of the step.
            kite_goes_back()
    raise RuntimeError(
        f"kite and tether differ by {np.linalg.norm(residual):.3g} N after {LARGEST_COUNT} iterations at {time:g} s: "
        "take a shorter step"
    )


def fly_iterated(kite_fmu, tether_fmu, h, duration, tolerance, improve=aitken, kite_mass=MASS):
    """`Flown` by FlyingKite and TetherDynamic in communication steps h [s]."""
    with all_running([kite_fmu, tether_fmu]) as ((kite, tether), stop_if_pressed):
        tether.start({"kite_position": START, "wind_velocity": WIND})
        carried, force = tether.get("kite_end_mass"), tether.get("kite_force")
        parameters = {"kite_mass": kite_mass + carried, "initial_kite_position": START, "input_continuation": INTERPOLATED}
        kite.start(CONTROL | {"kite_force": force + np.array([0.0, 0.0, carried * GRAVITY])}, **parameters)
        forces, led, count, began = [force], [np.zeros(3), 0.0], 0, perf_counter()
        for k in range(round(duration / h)):
            force, steps = iterated_step(kite, tether, led, k * h, h, tolerance, improve, kite_mass)
            forces.append(force)
            count += steps
            stop_if_pressed()
        return Flown(np.array(forces), count / (len(forces) - 1), perf_counter() - began)


def fly_free(kite_fmu, tether_fmu, h, duration, parallel=False, kite_mass=MASS):
    """`Flown` by TetherDynamicFree and PointMassKite in communication steps h [s].

    The kite goes after the tether, with the motion at the end of the step; `parallel`: both at once, so that the kite has to
    continue the motion of the start of the step.
    """
    with all_running([kite_fmu, tether_fmu]) as ((kite, tether), stop_if_pressed):
        tether.start({"wind_velocity": WIND}, kite_mass=kite_mass, initial_kite_position=START)
        kite.start(CONTROL | {"kite_position": START}, input_continuation=LINEAR if parallel else INTERPOLATED)
        forces, began = [tether.get("kite_force")], perf_counter()
        for k in range(round(duration / h)):
            before = {name: tether.get(name) for name in MOTION}
            tether.set(kite_load=kite.get("kite_load"))  # 1. The load at t goes on linearly.
            tether.step(k * h, h)
            kite.set(**(before if parallel else {name: tether.get(name) for name in MOTION}))
            kite.step(k * h, h)  # 2. The kite follows.
            forces.append(tether.get("kite_force"))
            stop_if_pressed()
        return Flown(np.array(forces), 1.0, perf_counter() - began)


def error(flown, fine):
    """Root mean square error [-] against a flight in shorter steps."""
    expected = fine.forces[:: (len(fine.forces) - 1) // (len(flown.forces) - 1)]
    return np.sqrt(np.mean((flown.forces - expected) ** 2) / np.mean(expected**2))


def tried(fly):
    """A flight, or why it has come to an end."""
    try:
        return fly()
    except RuntimeError as error:
        return error


def summary(flights, fine, duration):
    """Error and cost of equal flights; or why they have come to an end."""
    if isinstance(flights[0], RuntimeError):
        return f"stopped: {flights[0]}"
    percent, time = 100.0 * error(flights[0], fine), 1e3 * np.median([each.seconds for each in flights]) / duration
    return f"error {percent:.2g} %, {flights[0].tether_steps:.1f} tether steps for each, {time:.0f} ms for a second"


@command
def main(arguments=None):
    """Print error and cost of both masters."""
    parser = Parser(description="fly a kite with an iterated master, and with a free kite end")
    option = parser.add_argument
    allowed = number(1e-4, 0.1, "s")
    option("--step", type=allowed, default=0.02, metavar="H", help="communication step [s] (default: 0.02)")
    option(
        "--duration", type=number(0.1, 1e3, "s"), default=4.0, metavar="T", help="duration of the flight [s] (default: 4)"
    )
    option(
        "--tolerance", type=number(1e-9, 1e3, "N"), default=0.1, help="tolerance of the force on the kite [N] (default: 0.1)"
    )
    parser.add_choice("--next-guess", NEXT_GUESS, default="aitken", help="next guess of the force (default: aitken)")
    option(
        "--kite-mass",
        type=number(0.01, 1e6, "kg"),
        default=MASS,
        metavar="M",
        help=f"mass of the kite [kg] (default: {MASS:g})",
    )
    add_fmu(parser, "TetherDynamic, in dist/ or else in a cache of yours; the iterated master flies it")
    given = parser.parse_args(arguments)
    if given.fmu:
        variables_of(given.fmu)  # before others are built
    iterated = find_fmu("FlyingKite"), given.fmu or find_fmu("TetherDynamic")
    free = find_fmu("PointMassKite"), find_fmu("TetherDynamicFree")
    now("flying")
    flight, known = (given.step, given.duration), {"kite_mass": given.kite_mass}
    improve = NEXT_GUESS[given.next_guess]
    masters = {
        "iterated": lambda: fly_iterated(*iterated, *flight, given.tolerance, improve, **known),
        "free end": lambda: fly_free(*free, *flight, **known),
        "free end, both at once": lambda: fly_free(*free, *flight, parallel=True, **known),
    }
    fine = fly_free(*free, 0.1 * given.step, given.duration, **known)
    rounds = [{name: tried(fly) for name, fly in masters.items()} for _ in range(ROUNDS)]
    for name in masters:
        print(f"{name}: {summary([flights[name] for flights in rounds], fine, given.duration)}")


if __name__ == "__main__":
    sys.exit(main())
