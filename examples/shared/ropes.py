"""Ropes of the examples."""

# parameters of a rope whose slack segments do not push their ends apart: neither stiffness nor damping
NO_PUSH = {"slack_stiffness_ratio": 0.0, "slack_damping_ratio": 0.0}
