"""Numbers of the choices of parameters, as `parameters.py` names them, from 1 on; and one that is no choice, below."""

STRAIN_RATE, STRETCH_RATE = 1, 2
UNIFORM, POWER_LAW, LOGARITHMIC, EXPLOG = 1, 2, 3, 4
AT_NODES = -1  # not a choice of `Environment`: the wind is specified at each node, or at wind points
STATIC_EQUILIBRIUM, QUASI_STEADY, STRAIGHT = 1, 2, 3
GIVEN, DERIVED = 1, 2
START_GIVEN, START_AT_REST = 1, 2  # of a free kite, or of a free point of a system
WINCH_GIVEN, WINCH_IN_BALANCE = 1, 2  # the length at the start
LINEAR, HELD = 1, 2
SECOND_ORDER, BACKWARD_EULER = 1, 2
WINCH_BY_SPEED, WINCH_BY_FORCE, WINCH_BY_LENGTH = 1, 2, 3
WITH_DRUM = (WINCH_BY_FORCE,)  # winches with a drum driven by the tension
NO_GROUND, FLAT = 1, 2
