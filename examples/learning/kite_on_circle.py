"""A kite that a policy steers on a circle: an environment for Gymnasium, and a policy by hand; `steered_circle.py` flies.

A soft kite of 19.6 kg on 200 m of tether in a wind of 9 m/s. An action is the steering, held for 20 ms; the circle is seen
from the ground station at a radius of 20 deg, flown to the right. To train a policy, give `KiteOnCircle()`, or
``gymnasium.wrappers.TimeLimit(KiteOnCircle(), 3000)``, to a library of your choice.

The kite is the one of `fmus/aerodynamics.py`. The tether is a `tetherfmu.runtime.instance.Instance`, which also
`TetherDynamicFree` runs: its checks of arguments and its `Outputs` would take longer than a step.
"""

from array import array
from math import atan2, cos, hypot, pi, remainder, sin, tan

import gymnasium
import numpy as np

from fmus.aerodynamics import Wing, angle_of, dot, load, norm, turn_rate, turned, unit
from fmus.kite_on_path import frame
from tetherfmu.libraries import ready
from tetherfmu.runtime import layout as at
from tetherfmu.runtime.instance import Instance
from tetherfmu.runtime.parameters import Environment, Solver, Tether
from tetherfmu.runtime.variants import library_of
from tetherfmu.wiring.packing import pack_records
from tetherfmu.wiring.variables import line_of_tether

LENGTH, SEGMENTS, MASS, STRETCHED, SPEED = 200.0, 5, 19.6, 200.8, 20.0  # m, -, kg; at the start: distance [m], [m/s]
WIND, STEP = (9.0, 0.0, 0.0), 0.02  # m/s, s
RADIUS, LOWEST = 0.35, 10.0  # of the circle as seen from the ground station [rad]; least height of the kite [m]
CENTRE, LEFT, UP = frame(0.0, 0.5)  # direction to the centre of the circle, and across it
LIMITS = np.array((pi, pi, 1.0, 1.0, np.inf, np.inf), np.float32)  # of the observations, in magnitude
COURSE_GAIN, WAY_BACK = 3.0, 2.0  # of the policy: [1/s], [-]


class Kite(Wing):
    """The wing in uniform air."""

    air_density, air_density_scale_height = 1.225, 0.0


class KiteOnCircle(gymnasium.Env):
    """A kite on a tether that is to fly on a circle.

    action : steering [-], (1,), from -1 to 1; positive turns right as seen from the ground station.
    observation, (6,): angle to the circle [rad], positive outside; angle from the motion of the kite to the direction along
    the circle [rad], positive to the right; cosine and sine of the place on the circle, an angle that is 0 at its left end
    and grows towards its top; apparent wind [m/s]; tension at the kite [kN].
    reward : 1 on the circle, 0 at its centre and as far outside. The episode ends there, below 10 m, or where the tether
    refuses a step; ``info["refused"]`` then says why.  RuntimeError if the tether cannot be started.
    """

    def __init__(self):
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (1,))
        self.observation_space = gymnasium.spaces.Box(-LIMITS, LIMITS)
        self._wing, kernels = Kite(), ready.kernels(library_of("dynamic_free"))
        self.tether = Instance(kernels, (line_of_tether(shape_points=0),))
        tether = Tether(initial_length=LENGTH, segments=SEGMENTS)
        masses, free_ends = ((SEGMENTS, MASS),), (False, True)
        _, parameters = pack_records(kernels, (tether,), Environment(), Solver(), point_masses=masses, free_ends=free_ends)
        self.tether.set_up((SEGMENTS,), parameters)
        position = [STRETCHED * (cos(RADIUS) * c + sin(RADIUS) * e) for c, e in zip(CENTRE, LEFT, strict=True)]
        for place, vector in {at.KITE_POSITION: position, at.KITE_VELOCITY: np.multiply(SPEED, UP)}.items():
            self.tether.values[place : place + 3] = array("d", vector)
        self.tether.values[at.WIND_VELOCITY : at.WIND_VELOCITY + 3] = array("d", WIND)
        problem = self.tether.start()
        if problem:
            raise RuntimeError(problem)
        self._saved = self.tether.state[:], self.tether.values[:]
        self._observe(UP)

    def reset(self, *, seed=None, options=None):
        """Go back to the saved start, with a heading that is up to 0.3 rad off: the observation, and no information."""
        super().reset(seed=seed)
        self.tether.state[:], self.tether.values[:] = self._saved
        return self._observe(turned(UP, unit(self._kite(at.OUTPUT_KITE_POSITION)), self.np_random.uniform(-0.3, 0.3))), {}

    def step(self, action):
        """Steer for 20 ms: observation, reward, whether the episode ends, False, and information."""
        steering, values = float(action[0]), self.tether.values
        values[at.KITE_LOAD : at.KITE_LOAD + 3] = array(
            "d", load(self.position, self._heading, self._felt, steering, 0.0, self._wing)
        )
        rate = turn_rate(self._direction, self._heading, self._felt, steering, self._wing)
        refused = self.tether.advance(STEP)
        observation = self._observe(self._heading, STEP * rate)
        ends = bool(refused) or abs(self._off) > RADIUS or self.position[2] < LOWEST
        return observation, 1.0 - abs(self._off) / RADIUS, ends, False, {"refused": refused} if refused else {}

    def _kite(self, place):
        """Three outputs of the tether."""
        first = self.tether.outputs_at + place
        return self.tether.values[first : first + 3]

    def _observe(self, heading, angle=0.0):
        """Take the motion of the kite from the tether, and its heading after a turn [rad]: the observation."""
        self.position, velocity = self._kite(at.OUTPUT_KITE_POSITION), self._kite(at.OUTPUT_KITE_VELOCITY)
        self._direction = r = unit(self.position)
        self._heading = heading = turned(heading, r, angle)
        self._felt = [wind - speed for wind, speed in zip(WIND, velocity, strict=True)]
        left, up = dot(r, LEFT), dot(r, UP)
        away = hypot(left, up)
        self._off = atan2(away, dot(r, CENTRE)) - RADIUS
        along = [(left * u - up * e) / away for u, e in zip(UP, LEFT, strict=True)]
        course = remainder(angle_of(along, r) - angle_of(velocity, r), 2.0 * pi)
        tension = 1e-3 * self.tether.values[self.tether.outputs_at + at.KITE_TENSION]
        return np.array((self._off, course, left / away, up / away, norm(self._felt), tension), np.float32)


def steer(observation):
    """The policy by hand: the steering that turns the kite as the circle does, and back to it; an action."""
    off, course, _, _, wind, _ = observation.tolist()
    rate = COURSE_GAIN * (course + WAY_BACK * off) / max(wind, 1.0)
    return np.array((min(max((rate + 1.0 / (LENGTH * tan(RADIUS))) / Wing.turning, -1.0), 1.0),), np.float32)
