"""One flight of the stability map: what the tether did, and the largest tension and speed that its motion can explain.

Upper bound of the tension of a tether with damping and drag, whatever its motion:

    T_max = EA eps + Q + (EA Q^2/24)^(1/3) + AMPLIFICATION (Z V + D V/l0)
    Z = sqrt(EA mu),   V = U + sqrt(EA/mu) (eps + eps_slack),   Q = L (mu g + rho cd d U^2/2 + mu U^2/d)

eps is the largest strain of the chord (distance of the ends over unstretched length, minus 1; at least `ROUND_OFF`),
eps_slack that of a straight start shorter than the tether, times the root of the slack stiffness ratio. U adds the speeds
of ends, wind and reeling, and that of a fall over the length of the tether. Z V is the wave that an impact of speed V
sends along a taut line, D V/l0 the tension of the damper of a segment whose one node moves with V. AMPLIFICATION stands
for reflections and for the whip of a bend. Q is the load across the line: weight, drag and inertia of turning; its cubic
root is the tension of an elastic parabola between fixed ends. No node may be faster than AMPLIFICATION V.
"""

from math import inf, pi, sqrt
from time import process_time
from typing import NamedTuple

import numpy as np

from tetherfmu.models import StepRefused, TetherCatenary, TetherDynamic, TetherQuasiSteady, TetherStraight
from tetherfmu.runtime.parameters import Environment, Solver, Tether
from tetherfmu.runtime.status import SENTENCES

from .points import CALLS, MOST_REELED, kite, wind

MODELS = {
    "dynamic": TetherDynamic,
    "dynamic fixed step": TetherDynamic,
    "quasi_steady": TetherQuasiSteady,
    "catenary": TetherCatenary,
    "straight": TetherStraight,
}
AMPLIFICATION = 6.0
ROUND_OFF = 1e-9  # strain that the rounding of positions makes; the bounds of a tether at rest
MOST_WORK = 300_000  # segments times internal steps, after which a flight ends
DIAMETER, DENSITY = 0.004, 724.0
DRAG_FACTOR = 0.5 * 1.225 * 0.958 * DIAMETER  # drag per length over the square of the speed [N s2/m3]
LINE_DENSITY = DENSITY * pi * DIAMETER**2 / 4.0  # [kg/m]


class Flight(NamedTuple):
    """A flight. Refusal: name of its sentence or ""; forces: rows of both end forces [N], one per communication step.

    peak, bound : largest tension and what it may be [N].  fastest, speed_bound : the same of the speed of a node [m/s], for
    dynamic tethers.  longest : call [s].
    """

    refusal: str
    forces: np.ndarray
    peak: float
    bound: float
    fastest: float
    speed_bound: float
    slackest: int
    work: float
    longest: float
    finite: bool


def name_of(message):
    """Which sentence of `status.py` a refusal says, in two or three words."""
    names = {
        1: "input not finite",
        2: "step not positive",
        3: "reeled too short",
        4: "budget spent",
        5: "step too small",
        6: "state not finite",
        7: "no equilibrium",
        8: "fixed steps too many",
        9: "output not finite",
    }
    for code, name in names.items():
        if message.startswith(SENTENCES[code].split("{")[0]):
            return name
    raise ValueError(f"unknown refusal: {message}")


def model_of(point, tolerance, fixed_step):
    """The tether of a point with a solver of its own."""
    tether = Tether(
        segments=point.segments,
        initial_length=point.length,
        diameter=DIAMETER,
        density=DENSITY,
        axial_stiffness=point.axial_stiffness,
        axial_damping=point.axial_damping,
    )
    solver = Solver(relative_tolerance=tolerance, fixed_step=fixed_step, initial_shape=point.initial_shape)
    return MODELS[point.variant](tether, Environment(gravity=point.gravity), solver, shape_points=2)


class _Bound:
    """Largest tension [N] that the motion of the ends so far explains; see the head of this file."""

    def __init__(self, point):
        self._point = point
        self._strain = ROUND_OFF
        self._speed = 0.0
        self._end = None

    def add(self, position, velocity, length, step):
        """Note where the kite end has arrived: position [m], velocity [m/s], unstretched length [m]."""
        ends = [position]
        if self._end is not None:
            last, last_velocity = self._end
            ends.append(0.5 * (position + last) + 0.125 * step * (last_velocity - velocity))
            self._speed = max(self._speed, np.linalg.norm(position - last) / step)
        self._end = position, velocity
        self._strain = max(self._strain, max(np.linalg.norm(end) for end in ends) / length - 1.0)
        self._speed = max(self._speed, np.linalg.norm(velocity))

    def tension_and_speed(self):
        """Both bounds [N], [m/s]."""
        p = self._point
        wave_speed = sqrt(p.axial_stiffness / LINE_DENSITY)
        fall = sqrt(2.0 * p.gravity * (p.length + p.distance))
        motion = self._speed + p.wind + abs(p.reel_out_speed) + fall
        speed = motion + wave_speed * self._strain
        if p.initial_shape == 3:
            speed += wave_speed * sqrt(0.01) * max(0.0, p.slack / (1.0 + p.slack))
        damping = 0.0 if p.variant in ("quasi_steady", "catenary", "straight") else p.axial_damping
        impact = sqrt(p.axial_stiffness * LINE_DENSITY) + damping / p.segment_length
        longest = p.length * (1.0 + MOST_REELED)
        inertia = LINE_DENSITY * motion**2 / (p.distance * (1.0 - MOST_REELED))
        load = longest * (LINE_DENSITY * p.gravity + DRAG_FACTOR * motion**2 + inertia)
        across = load + (p.axial_stiffness * load**2 / 24.0) ** (1.0 / 3.0)
        return p.axial_stiffness * self._strain + across + AMPLIFICATION * impact * speed, AMPLIFICATION * speed


def fly(point, refinement=1, calls=CALLS, most_work=MOST_WORK):
    """Fly a point; returns its `Flight`.

    refinement : divides the communication step and the fixed step, and the tolerance by its square times 2.5 (1 leaves all).
    calls : communication steps (of the unrefined flight).  most_work : see `MOST_WORK`.
    """
    step = point.step / refinement
    tolerance = point.relative_tolerance if refinement == 1 else point.relative_tolerance / (2.5 * refinement**2)
    model = model_of(point, tolerance, point.fixed_step / refinement)
    wind_velocity, bound, forces = wind(point), _Bound(point), []
    refusal, peak, fastest, slackest, longest, finite = "", -inf, 0.0, 0, 0.0, True
    for k in range(calls * refinement + 1):
        position, velocity = kite(point, max(0, k - 1) * step)
        inputs = {
            "kite_position": position,
            "kite_velocity": velocity,
            "reel_out_speed": point.reel_out_speed,
            "wind_velocity": wind_velocity,
        }
        started = process_time()
        try:
            out = model.step(step, **inputs) if k else model.initialize(**inputs)
        except StepRefused as error:
            refusal = name_of(str(error))
        longest = max(longest, process_time() - started)
        if refusal:
            break
        bound.add(model.positions[-1], model.velocities[-1], out.tether_length, step)
        if point.variant.startswith("dynamic"):
            fastest = max(fastest, np.linalg.norm(model.velocities, axis=1).max())
        peak, slackest = max(peak, out.max_tension), max(slackest, out.slack_segments)
        finite = finite and bool(np.isfinite(np.concatenate([model.get_state(), *map(np.ravel, out)])).all())
        if k % refinement == 0:
            forces.append((*out.ground_force, *out.kite_force))
        work = sum(model.counters.values()) * model.segments
        if work > most_work:
            break
    done = work if forces else 0.0
    tension, speed = bound.tension_and_speed()
    return Flight(refusal, np.array(forces), peak, tension, fastest, speed, slackest, done, longest, finite)
