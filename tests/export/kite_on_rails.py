"""PythonFMU slave for a test: a kite that rises at 2 m/s, and the sum of the forces that it was given."""

from pythonfmu import Fmi2Causality, Fmi2Slave, Real

RISE = 2.0


class KiteOnRails(Fmi2Slave):
    """Ports by the names that the tether uses, as scalars."""

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self.px, self.py, self.pz = 300.0, 0.0, 400.0
        self.vx, self.vy, self.vz = 0.0, 0.0, RISE
        self.fx, self.fy, self.fz = 0.0, 0.0, 0.0
        for name in ("px", "py", "pz", "vx", "vy", "vz"):
            self.register_variable(Real(name, causality=Fmi2Causality.output))
        for name in ("fx", "fy", "fz"):
            self.register_variable(Real(name, causality=Fmi2Causality.input))

    def do_step(self, current_time, step_size):
        self.pz = 400.0 + RISE * (current_time + step_size)
        return True
