"""Coefficients of Rodas4P: a Rosenbrock method of order 4 with 6 stages, L-stable, without order reduction at driven ends.

    u_i = y0 + sum_j a_ij U_j
    (1/(h gamma) - J) U_i = f(t0 + alpha_i h, u_i) + sum_j c_ij/h U_j + gamma_i h df/dt
    y1 = u_6 + U_6,   error estimate U_6 (embedded method u_6 of order 3)

P = alpha (a + 1) and R = Gamma (a + 1), for the positions of a chain (`rosenbrock.py`), follow from the coefficients
alpha = a Gamma and Gamma = (1/gamma - c)^-1 of the usual form.

Source: G. Steinebach, Order-reduction of ROW-methods for DAEs and method of lines applications, TH Darmstadt preprint
1741 (1995), in the transformed form of Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.7.
"""

import numpy as np

from ..compilation import kernel

STAGES = 6
GAMMA = 0.25  # the diagonal coefficient gamma
A = np.array(  # a_ij
    (
        (0.0, 0.0, 0.0, 0.0, 0.0),
        (3.0, 0.0, 0.0, 0.0, 0.0),
        (1.831036793486759, 0.4955183967433795, 0.0, 0.0, 0.0),
        (2.304376582692669, -0.05249275245743001, -1.176798761832782, 0.0, 0.0),
        (-7.170454962423024, -4.741636671481785, -16.31002631330971, -1.062004044111401, 0.0),
        (-7.170454962423024, -4.741636671481785, -16.31002631330971, -1.062004044111401, 1.0),
    )
)
C = np.array(  # c_ij
    (
        (0.0, 0.0, 0.0, 0.0, 0.0),
        (-12.0, 0.0, 0.0, 0.0, 0.0),
        (-8.791795173947035, -2.207865586973518, 0.0, 0.0, 0.0),
        (10.81793056857153, 6.780270611428266, 19.5348594464241, 0.0, 0.0),
        (34.19095006749676, 15.49671153725963, 54.7476087596413, 14.16005392148534, 0.0),
        (34.62605830930532, 15.30084976114473, 56.99955578662667, 18.40807009793095, -5.714285714285717),
    )
)


def _by_stage(rows, first):
    """Rows of factors of different lengths as one array, 0 elsewhere; first : stage of the first row."""
    found = np.zeros((STAGES, STAGES))
    for i, row in enumerate(rows, start=first):
        found[i, : len(row)] = row
    return found


P = _by_stage(  # stages 1 to 4; in the last stage x_5 = x_4 + U_x4, v_5 = v_4 + V_4
    (
        (0.75,),
        (0.45775919837168977, 0.12387959918584487),
        (0.6840395424985646, 0.003483796012626717, -0.2941996904581955),
        (-1.150635276145604, -1.318155133423187, -5.061696550612639, -0.26550101102785023),
    ),
    first=1,
)
R_BY_GAMMA = _by_stage(  # R_ij/gamma, stages 1 to 5
    (
        (0.0,),
        (-0.36691199999999974, -0.056448),
        (3.216965637533963, 1.3668989638916995, 3.706916099773243),
        (7.743495620908387, 3.1987837164992916, 10.499408840403428, 2.478009436259934),
        (0.0, 0.0, 0.0, 0.0, -0.42857142857142927),
    ),
    first=1,
)
ALPHA = np.array((0.0, 0.75, 0.21, 0.63, 1.0, 1.0))  # alpha_i: times of the stages
GAMMA_I = np.array((0.25, -0.5, -0.023504, -0.0362, 0.0, 0.0))  # gamma_i: factors of df/dt
INERTIA = _by_stage(C, first=0) + R_BY_GAMMA / GAMMA  # factors of V_j in sum_j c_ij V_j + r_i/gamma
# for a system 0 = r(q, v, z, t): z_i = OF_START_i z_0 + sum_j OF_SPEEDS_ij V_j/h, the accelerations at a stage
_STAGE = _by_stage(A, first=0) @ np.linalg.inv(np.eye(STAGES) + _by_stage(A, first=0))
OF_START = 1.0 - _STAGE @ np.ones(STAGES)
OF_SPEEDS = _STAGE @ (np.eye(STAGES) / GAMMA - _by_stage(C, first=0))


@kernel
def added_up(start, factors, stage, increments):
    """start + sum_j factors[stage, j] U_j."""
    for j in range(stage):
        start += factors[stage, j] * increments[j]
    return start
