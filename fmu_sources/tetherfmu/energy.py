"""Energy of a chain and the powers that change it: a diagnostic in plain numpy, no part of a step.

    d/dt (kinetic + elastic + potential) = power at the ends + winch + material + wind - damping loss - drag loss

Every term is written out in docs/theory.md, "Energy". What the powers do not explain appeared from nowhere; `EnergyAudit`
follows that residual along a run.
"""

from dataclasses import dataclass, fields

import numpy as np

from tetherfmu.kernels.chain.atmosphere import air_density, wind_factor
from tetherfmu.kernels.chain.segment import SHORTEST
from tetherfmu.runtime import layout as at


@dataclass(frozen=True)
class Energy:
    """Energies [J] of a tether and the powers [W] that change them, SI units. Theory: docs/theory.md, "Energy".

    Attributes
    ----------
    kinetic, elastic, potential : float
        kinetic: of the nodes that move freely; the half particle at a driven end belongs to what drives it. elastic: of the
        springs. potential: weight times height over z = 0, with both half particles.
    ground_power, kite_power : float
        What the holder of an end puts into the tether, - end force . end velocity; at a free kite end: load . velocity.
    winch_power : float
        Work against the tension where the tether gets shorter or longer, - sum T (l/l0) dl0/dt.
    material_power : float
        Kinetic, elastic and potential energy that new material brings with it; negative while reeling in.
    wind_power : float
        Drag force . wind velocity.
    damping_loss, drag_loss : float
        Heat in the dampers and in the air, drag force . (wind - tether velocity); at least 0 with the strain-rate law.
    """

    kinetic: float
    elastic: float
    potential: float
    ground_power: float
    kite_power: float
    winch_power: float
    material_power: float
    wind_power: float
    damping_loss: float
    drag_loss: float

    @property
    def total(self):
        """Kinetic + elastic + potential energy [J]."""
        return self.kinetic + self.elastic + self.potential

    @property
    def power(self):
        """Sum of the powers minus the losses [W]: the rate at which `total` has to change."""
        gains = self.ground_power + self.kite_power + self.winch_power + self.material_power + self.wind_power
        return gains - self.damping_loss - self.drag_loss


POWERS = tuple(field.name for field in fields(Energy))[3:]


@dataclass(frozen=True)
class _Segments:
    """One row or number per segment: lengths [m] and rates [m/s], direction, tensions [N], half drag and wind."""

    rest: np.ndarray
    rest_rate: np.ndarray
    length: np.ndarray
    strain_rate: np.ndarray  # times rest [m/s]
    direction: np.ndarray
    stiffness: np.ndarray
    spring: np.ndarray
    damper: np.ndarray
    half_drag: np.ndarray
    wind: np.ndarray

    @property
    def pull(self):
        """Tension vectors [N]."""
        return (self.spring + self.damper)[:, None] * self.direction


def _segment_property(n, parameters, place):
    first = at.PARAMETER_SCALARS + place * n
    return parameters[first : first + n]


def _segments(n, parameters, x, v, length, reeling, wind):
    """State of all segments; equations of docs/theory.md, "One segment"."""
    share = _segment_property(n, parameters, at.SHARE)
    rest, rest_rate = share * length, share * reeling
    r, u = np.diff(x, axis=0), np.diff(v, axis=0)
    present = np.maximum(np.linalg.norm(r, axis=1), SHORTEST)
    e = r / present[:, None]
    length_rate = np.sum(e * u, axis=1)
    strain_rate = length_rate - present / rest * rest_rate
    taut = present > rest
    k = _segment_property(n, parameters, at.STIFFNESS) / rest * np.where(taut, 1.0, parameters[at.SLACK_STIFFNESS_RATIO])
    c = _segment_property(n, parameters, at.DAMPING) / rest * np.where(taut, 1.0, parameters[at.SLACK_DAMPING_RATIO])
    seen = strain_rate if parameters[at.DAMPING_LAW] == at.STRAIN_RATE else length_rate
    air, half_drag = _drag(n, parameters, x, v, e, present, wind)
    return _Segments(rest, rest_rate, present, strain_rate, e, k, k * (present - rest), c * seen, half_drag, air)


def _drag(n, parameters, x, v, e, length, wind):
    """Wind [m/s] at all segments and half of the drag [N] of each, rows of 3."""
    height = 0.5 * (x[1:, 2] + x[:-1, 2])
    air = np.array([wind_factor(z, parameters)[0] for z in height])[:, None] * wind
    density = np.array([air_density(z, parameters)[0] for z in height])
    apparent = air - 0.5 * (v[1:] + v[:-1])
    across = apparent - np.sum(apparent * e, axis=1)[:, None] * e
    width = 0.25 * density * _segment_property(n, parameters, at.DRAG_WIDTH) * length
    return air, (width * np.linalg.norm(across, axis=1))[:, None] * across


def _tether_masses(n, parameters, length):
    """Mass of the tether at each node [kg], without point masses."""
    half = 0.5 * _segment_property(n, parameters, at.LINE_DENSITY) * _segment_property(n, parameters, at.SHARE) * length
    return np.append(half, 0.0) + np.append(0.0, half)


def account(n, parameters, state, reel_out_speed, wind, kite_load):
    """`Energy` of the chain in a state.

    Parameters
    ----------
    n : int
        Segments.
    parameters, state : ndarray
        Flat arrays, see `layout.py`.
    reel_out_speed, wind, kite_load : float, (3,), (3,)
        Rate of the unstretched length [m/s], wind at the reference height [m/s], force on a free kite end [N].
    """
    x, v = state[at.STATE_HEADER :].reshape(2, n + 1, 3)
    length = state[at.LENGTH]
    free = np.ones(n + 1)
    free[0], free[n] = parameters[at.GROUND_IS_FREE], parameters[at.KITE_IS_FREE]
    points = free * parameters[at.PARAMETER_SCALARS + at.SEGMENT_PROPERTIES * n :]
    tether = _tether_masses(n, parameters, length)
    s = _segments(n, parameters, x, v, length, reel_out_speed, np.asarray(wind))
    per_mass = 0.5 * free * np.sum(v**2, axis=1) + parameters[at.GRAVITY] * x[:, 2]
    weight = np.array([0.0, 0.0, -parameters[at.GRAVITY]])
    ground_force = s.pull[0] + s.half_drag[0] + tether[0] * weight
    kite_force = -s.pull[-1] + s.half_drag[-1] + tether[-1] * weight
    strain = s.length / s.rest - 1.0
    drag, air_loss = 2.0 * s.half_drag, s.wind - 0.5 * (v[1:] + v[:-1])
    return Energy(
        kinetic=float(0.5 * ((tether + points) * free) @ np.sum(v**2, axis=1)),
        elastic=float(0.5 * s.stiffness @ (s.length - s.rest) ** 2),
        potential=float(parameters[at.GRAVITY] * (tether + points) @ x[:, 2]),
        ground_power=float(-(1.0 - free[0]) * ground_force @ v[0]),
        kite_power=float((free[n] * np.asarray(kite_load) - (1.0 - free[n]) * kite_force) @ v[n]),
        winch_power=float(-(s.spring + s.damper) * s.length / s.rest @ s.rest_rate),
        material_power=float(tether @ per_mass * reel_out_speed / length + 0.5 * s.spring * strain @ s.rest_rate),
        wind_power=float(np.sum(drag * s.wind)),
        damping_loss=float(s.damper @ s.strain_rate),
        drag_loss=float(np.sum(drag * air_loss)),
    )


class EnergyAudit:
    """Steps a tether and integrates the powers of `Energy`, so that energy from nowhere is seen.

    The trapezoidal rule over the communication steps: its error falls with the square of the step, so take steps that are
    short against the shortest vibration of interest. The run itself is the same as without the audit.

    Parameters
    ----------
    model : TetherDynamic
        Initialized. Do not step it elsewhere while the audit runs.

    Attributes
    ----------
    work : dict
        Integral of each power and loss since the start [J], by its name in `Energy`.
    start, now : Energy
        At the start of the audit, and at present.
    """

    def __init__(self, model):
        self._model = model
        self.start = self.now = model.energy()
        self.work = dict.fromkeys(POWERS, 0.0)

    def step(self, step, *, reel_out_speed=0.0, wind_velocity=(0.0, 0.0, 0.0), kite_load=(0.0, 0.0, 0.0), **motion):
        """Advance the tether; arguments and result as `TetherModel.step`."""
        held = {"reel_out_speed": reel_out_speed, "wind_velocity": wind_velocity, "kite_load": kite_load}
        before = self._model.energy(**held)
        outputs = self._model.step(step, **held, **motion)
        self.now = self._model.energy()
        for name in POWERS:
            self.work[name] += 0.5 * step * (getattr(before, name) + getattr(self.now, name))
        return outputs

    @property
    def residual(self):
        """Energy from nowhere [J]: change of the total energy since the start minus the work of all powers."""
        gains = sum(self.work[name] for name in POWERS[:-2])
        return self.now.total - self.start.total - gains + self.work["damping_loss"] + self.work["drag_loss"]
