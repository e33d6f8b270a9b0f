"""The marching kernel gives the published numbers of another quasi-steady code, with that code's lumping.

    t_1 = t_0 + 3/2 w e_z,   t_s = t_(s-1) + w e_z,   t_15 = t_14 + 3/2 w e_z,   w = mu l0 g
    x_(s+1) = x_s + l0 (1 + |t_s|/EA) t_s/|t_s|,  but x_1 = x_0 + l0 t_0/|t_0|

That code puts one and a half segment masses on the nodes next to both ends, and its first segment does not stretch (its EA
is infinite here). Start: elevation, azimuth and tension at the ground; end: position and force at the kite.
Source: Tethers.jl (MIT), quasi-steady model, fixture of its marching test.
"""

import numpy as np

from kernels.packed import packed
from tetherfmu import Environment, Tether
from tetherfmu.kernels.equations.properties import chain_at
from tetherfmu.kernels.rest import hanging_chain
from tetherfmu.runtime import layout as at

TETHER = Tether(
    segments=16,
    initial_length=431.66247903554,
    diameter=29.71973504179974e-3,
    density=970.0,
    axial_stiffness=8.047069220746364e7,
)
GRAVITY = 9.8066
ELEVATION, AZIMUTH, TENSION = 1.1302856641844843, -0.7853981636973135, 160941.384
END = [129.36325157809645, -129.36325165567953, 391.87661962783994]
END_FORCE = [48525.65303290781, -48525.65306201012, 148425.44630603644]


def test_march_ends_where_the_published_one_does():
    n = TETHER.segments
    parameters = packed(TETHER, Environment(gravity=GRAVITY))
    parameters[at.PARAMETER_SCALARS + at.STIFFNESS * n] = np.inf
    node_weight = TETHER.density * np.pi / 4.0 * TETHER.diameter**2 * TETHER.initial_length / n * GRAVITY
    load = np.zeros((n + 1, 3))
    load[1:n, 2] = -node_weight
    load[[1, n - 1], 2] *= 1.5
    cos = np.cos(ELEVATION)
    start = TENSION * np.array([cos * np.cos(AZIMUTH), cos * np.sin(AZIMUTH), np.sin(ELEVATION)])
    positions, tensions = np.zeros(3 * (n + 1)), np.zeros(n)
    chain = chain_at(n, parameters, TETHER.initial_length, 0.0, (0.0, 0.0, 0.0))
    end, force = hanging_chain.march(chain, tuple(start), 0.0, load.ravel(), positions, tensions)
    # 16 sums of numbers with 16 digits; found equal to 1e-15
    assert np.allclose(end, END, rtol=1e-12, atol=0.0)
    assert np.allclose(force, END_FORCE, rtol=1e-12, atol=0.0)
    assert np.isclose(tensions[-1], np.linalg.norm(END_FORCE), rtol=1e-12)
