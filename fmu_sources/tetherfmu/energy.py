"""Energy of a chain and the powers that change it: a diagnostic, no part of a step.

    d/dt (kinetic + elastic + potential) = power at the ends + winch + material + wind - damping loss - drag loss

Every term is written out in docs/theory.md, "Energy". What the powers do not explain appeared from nowhere; `EnergyAudit`
follows that residual along a run.
"""

from dataclasses import dataclass, fields

import numpy as np

from tetherfmu.kernels.algebra.vectors import add, dot, get, scale, sub
from tetherfmu.kernels.chain import segment
from tetherfmu.kernels.chain.atmosphere import air
from tetherfmu.kernels.chain.nodes import end_force, node_masses
from tetherfmu.kernels.chain.properties import chain_at, point_mass, rest_length
from tetherfmu.kernels.compilation import kernel
from tetherfmu.runtime import layout as at


@dataclass(frozen=True)
class Energy:
    """Energies [J] of a tether and the powers [W] that change them. Theory: docs/theory.md, "Energy"."""

    kinetic: float  # of the nodes that move freely; the half particle at a driven end belongs to what drives it
    elastic: float  # of the springs
    potential: float  # weight times height over z = 0, with both half particles
    ground_power: float  # what the holder of the end puts into the tether, - end force . end velocity
    kite_power: float  # the same at the kite; at a free kite end: load . velocity
    winch_power: float  # work against the tension where the tether gets shorter or longer, - sum T (l/l0) dl0/dt
    material_power: float  # kinetic, elastic and potential energy that new material brings; negative while reeling in
    wind_power: float  # drag force . wind velocity
    damping_loss: float  # heat in the dampers; at least 0 with the strain-rate law
    drag_loss: float  # heat in the air, drag force . (wind - tether velocity); at least 0

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


@kernel
def _sums(chain, x, v, mass):
    """End forces [N] of the chain in x [m], v [m/s], and sums over its segments: energy [J] and powers [W] of `Energy`.

    elastic, winch_power, elastic part of material_power, wind_power, damping_loss, drag_loss. `mass` (modified) gets the
    node masses [kg].
    """
    node_masses(chain, mass)
    ground_force, _ = end_force(chain, False, x, v, mass)
    kite_force, _ = end_force(chain, True, x, v, mass)
    elastic = winch = material = wind = damping = friction = 0.0
    for s in range(chain.n):
        length, e = segment.geometry(sub(get(x, s + 1), get(x, s)))
        rest = rest_length(chain, s)
        rate = dot(e, sub(get(v, s + 1), get(v, s)))
        k, c = segment.stiffness(chain, s, length - rest, rest)
        damper = c * segment.seen_rate(chain, length, rate)
        height = 0.5 * (x[3 * s + 2] + x[3 * s + 5])
        velocity = scale(0.5, add(get(v, s), get(v, s + 1)))
        drag = scale(2.0, segment.half_drag(chain, s, length, e, height, velocity))
        factor, _, _, _ = air(height, chain.parameters)
        elastic += 0.5 * k * (length - rest) ** 2
        winch -= segment.tension(chain, length, rate, rest, k, c) * length * chain.growth
        material += 0.5 * k * (length - rest) ** 2 * chain.growth
        wind += dot(drag, scale(factor, chain.wind))
        damping += damper * (rate - chain.growth * length)
        friction += dot(drag, sub(scale(factor, chain.wind), velocity))
    return ground_force, kite_force, (elastic, winch, material, wind, damping, friction)


def account(n, parameters, state, reel_out_speed, wind, kite_load):
    """`Energy` of the chain in a state.

    n : segments.  parameters, state : flat arrays, see `layout.py`.  reel_out_speed : rate of the unstretched length [m/s].
    wind : (3,) at the reference height [m/s].  kite_load : (3,) force on a free kite end [N].
    """
    flat = state[at.STATE_HEADER :].reshape(2, -1)
    x, v = flat.reshape(2, n + 1, 3)
    chain = chain_at(n, parameters, state[at.LENGTH], float(reel_out_speed), tuple(map(float, wind)))
    mass = np.zeros(n + 1)
    ground_force, kite_force, sums = _sums(chain, *flat, mass)
    elastic, winch_power, material_power, wind_power, damping_loss, drag_loss = sums
    free = np.ones(n + 1)
    free[0], free[n] = parameters[at.GROUND_IS_FREE], parameters[at.KITE_IS_FREE]
    points = np.array([point_mass(chain, i) for i in range(n + 1)])
    tether = mass - points
    moving = free * np.sum(v**2, axis=1)
    heights = parameters[at.GRAVITY] * x[:, 2]
    return Energy(
        kinetic=float(0.5 * mass @ moving),
        elastic=elastic,
        potential=float((tether + free * points) @ heights),
        ground_power=float((free[0] - 1.0) * np.dot(ground_force, v[0])),
        kite_power=float((free[n] * np.asarray(kite_load) - (1.0 - free[n]) * np.asarray(kite_force)) @ v[n]),
        winch_power=winch_power,
        material_power=material_power + float(chain.growth * tether @ (0.5 * moving + heights)),
        wind_power=wind_power,
        damping_loss=damping_loss,
        drag_loss=drag_loss,
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
