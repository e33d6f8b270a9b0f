"""Random sessions of legal and illegal calls, of tethers and of examples, against a model of the FMI state machine.

The model knows which calls must be refused: by a native FMU at once, by PythonFMU's library, which mostly cannot, with the
next step. After a refusal the tether must be as before, after a restored state as it was when the state was taken, and no
output is ever infinite.
"""

import math
from copy import deepcopy

import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2Discard, fmi2Error, fmi2Fatal, fmi2OK
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import Bundle, RuleBasedStateMachine, invariant, precondition, rule, run_state_machine_as_test

from isolation import in_own_process
from runtime.host import SHELLS, Host, description_of, of_every_flavour
from tetherfmu.export.archive import SLAVES

BEFORE, INITIALIZING, STEPPING, TERMINATED, FATAL = "before", "initializing", "stepping", "terminated", "fatal"
GOOD_INPUTS = {
    "kite_position[1]": (299.0, 300.5),  # of a driven kite
    "kite_velocity[3]": (-3.0, 0.0, 3.0),
    "kite_load[2]": (-200.0, 0.0, 500.0),  # of a free one
    "wind_velocity[1]": (-20.0, 0.0, 8.0),
    "reel_out_speed": (-1.0, 0.0, 2.0),
    "winch_force": (-50.0, 100.0, 300.0),
}
BAD_INPUTS = (math.nan, math.inf, -1e300)
GOOD_PARAMETERS = {
    "segments": (1, 4, 20),
    "initial_length": (480.0, 505.0, 530.0),
    "diameter": (0.002, 0.004),
    "winch_control": (1, 2),
    "winch_mass": (0.0, 5.0),
}
BAD_PARAMETERS = {"segments": (0, -7, 301), "initial_length": (-1.0, math.nan), "diameter": (0.0, math.inf)}
GOOD_STEPS = (1e-3, 0.02, 0.1)
BAD_STEPS = (0.0, -0.02, math.nan, math.inf)
UNKNOWN = (9999, 2**31, 2**32 - 1)


def values_of(table):
    return st.sampled_from([(name, value) for name, values in table.items() for value in values])


def session(folder, others, good=GOOD_INPUTS, good_parameters=GOOD_PARAMETERS, bad_parameters=BAD_PARAMETERS):
    """State machine for the FMU in a folder; `others` holds serialized states of other FMUs.

    good, good_parameters, bad_parameters : dicts of names to values.
    """
    inputs = {variable.name for variable in description_of(folder).modelVariables if variable.causality == "input"}
    good_inputs = {name: values for name, values in good.items() if name in inputs}

    class Session(RuleBasedStateMachine):
        states = Bundle("states")

        def __init__(self):
            super().__init__()
            self.host = Host(folder)
            self.phase = BEFORE
            self.wrong = {}
            self.refusal = False

        def teardown(self):
            self.host.free()

        def call(self, function, *arguments):
            self.host.messages.clear()
            try:
                function(*arguments)
            except FMICallException as error:
                assert self.host.messages, "refused without a word"
                return error.status
            return fmi2OK

        def must_be_refused(self, status):
            """At once, or said at once and refused with the next step."""
            assert self.host.messages
            assert status == (fmi2Error if self.host.native else fmi2OK)
            self.refusal = not self.host.native

        def outputs(self):
            """All outputs; None where they cannot be calculated, in words, before the initialization ends."""
            if not (self.phase == INITIALIZING and self.wrong):
                return self.host.all_outputs()
            self.host.messages.clear()
            if self.host.native:
                assert self.call(self.host.all_outputs) == fmi2Error
            else:
                assert all(map(math.isnan, self.host.all_outputs()))
            assert self.host.messages
            return None

        def parameters_are_fixed(self):
            return self.phase in (STEPPING, TERMINATED)

        def set_input(self, name, value):
            """Whether it was set."""
            status = self.call(lambda: self.host.set(**{name: value}))
            if self.phase == TERMINATED:
                self.must_be_refused(status)
            return self.phase != TERMINATED

        @precondition(lambda self: self.phase != FATAL)
        @rule()
        def enter(self):
            status = self.call(self.host.fmu.enterInitializationMode)
            if self.phase == BEFORE:
                assert status == fmi2OK
                self.phase = INITIALIZING
            else:
                self.must_be_refused(status)

        @precondition(lambda self: self.phase != FATAL)
        @rule()
        def leave(self):
            status = self.call(self.host.fmu.exitInitializationMode)
            if self.phase != INITIALIZING:
                self.must_be_refused(status)
            elif self.host.native and self.wrong:
                assert status == fmi2Error
            elif self.wrong or self.refusal:
                assert status == fmi2Fatal
                self.phase = FATAL
            else:
                assert status == fmi2OK
                self.phase = STEPPING

        @precondition(lambda self: self.phase == BEFORE and not self.wrong and not self.refusal)
        @rule()
        def start(self):
            self.enter()
            self.leave()
            assert self.phase == STEPPING

        @precondition(lambda self: self.phase != FATAL)
        @rule(step=st.sampled_from(GOOD_STEPS + BAD_STEPS), time=st.sampled_from((0.0, 1.0, -5.0, 1e9, math.nan)))
        def step(self, step, time):
            before = self.outputs()
            status = self.call(self.host.fmu.doStep, time, step)
            must_fail = self.phase != STEPPING or self.refusal or self.wrong or step in BAD_STEPS or math.isnan(step)
            if self.host.native and self.phase != STEPPING:
                assert status == fmi2Error
            elif must_fail or math.isnan(time):
                assert status == (fmi2Error if self.host.native else fmi2Discard)
                self.refusal = False
            if status in (fmi2Discard, fmi2Error):
                assert self.outputs() == before
            else:
                assert status == fmi2OK

        @precondition(lambda self: self.phase != FATAL)
        @rule(item=values_of(good_inputs))
        def set_good_input(self, item):
            if self.set_input(*item):
                self.wrong.pop(item[0], None)

        @precondition(lambda self: self.phase != FATAL)
        @rule(name=st.sampled_from(sorted(good_inputs)), value=st.sampled_from(BAD_INPUTS))
        def set_bad_input(self, name, value):
            if self.set_input(name, value):
                self.wrong[name] = value

        @precondition(lambda self: self.phase != FATAL)
        @rule(item=values_of(good_parameters))
        def set_good_parameter(self, item):
            status = self.call(lambda: self.host.set(**dict([item])))
            if self.parameters_are_fixed():
                self.must_be_refused(status)
            else:
                self.wrong.pop(item[0], None)

        @precondition(lambda self: self.phase != FATAL)
        @rule(item=values_of(bad_parameters))
        def set_bad_parameter(self, item):
            status = self.call(lambda: self.host.set(**dict([item])))
            if self.parameters_are_fixed():
                self.must_be_refused(status)
            else:
                self.wrong[item[0]] = item[1]

        @precondition(lambda self: self.phase != FATAL)
        @rule(reference=st.sampled_from(UNKNOWN), kind=st.sampled_from(("Real", "Integer", "Boolean", "String")))
        def get_unknown(self, reference, kind):
            self.must_be_refused(self.call(getattr(self.host.fmu, f"get{kind}"), [reference]))

        @precondition(lambda self: self.phase != FATAL)
        @rule(reference=st.sampled_from(UNKNOWN), kind=st.sampled_from(("Real", "Integer", "Boolean", "String")))
        def set_unknown(self, reference, kind):
            value = "x" if kind == "String" else 1
            self.must_be_refused(self.call(getattr(self.host.fmu, f"set{kind}"), [reference], [value]))

        @precondition(lambda self: self.phase != FATAL)
        @rule(target=states)
        def save(self):
            state = self.host.fmu.getFMUState()
            blob = self.host.fmu.serializeFMUstate(state)
            self.host.fmu.freeFMUState(state)
            return deepcopy((blob, self.phase, self.wrong, self.outputs()))

        def restore_blob(self, blob):
            state = self.host.fmu.deSerializeFMUstate(blob)
            self.host.fmu.setFMUState(state)
            self.host.fmu.freeFMUState(state)

        @precondition(lambda self: self.phase != FATAL)
        @rule(saved=states)
        def restore(self, saved):
            assert self.call(self.restore_blob, saved[0]) == fmi2OK
            _, self.phase, self.wrong, outputs = deepcopy(saved)
            self.refusal = False
            if self.phase != INITIALIZING:  # there outputs are calculated anew when they are read
                assert self.outputs() == outputs

        @precondition(lambda self: self.phase != FATAL)
        @rule(saved=states, place=st.floats(0.0, 1.0), truncate=st.booleans())
        def restore_damaged(self, saved, place, truncate):
            k = min(int(place * len(saved[0])), len(saved[0]) - 1)
            damaged = saved[0][:k] if truncate else saved[0][:k] + bytes([saved[0][k] ^ 0x55]) + saved[0][k + 1 :]
            self.restore_foreign(damaged)

        @precondition(lambda self: self.phase != FATAL)
        @rule(blob=st.sampled_from(others) | st.binary(max_size=200))
        def restore_foreign(self, blob):
            before = self.outputs()
            self.must_be_refused(self.call(self.restore_blob, blob))
            assert self.outputs() == before

        @rule()
        def reset(self):
            if self.phase == FATAL:  # no call but free is allowed
                self.host.free()
                self.host = Host(folder)
            else:
                assert self.call(self.host.fmu.reset) == fmi2OK
            self.phase, self.wrong, self.refusal = BEFORE, {}, False

        @precondition(lambda self: self.phase != FATAL)
        @rule()
        def terminate(self):
            status = self.call(self.host.fmu.terminate)
            if self.phase == STEPPING:
                assert status == fmi2OK
                self.phase = TERMINATED
            else:
                self.must_be_refused(status)

        @invariant()
        def outputs_are_finite(self):
            if self.phase != FATAL:
                assert all(math.isfinite(value) for value in self.outputs() or ())

    return Session


def run(machine, sessions):
    """Do random sessions of 30 calls, the same ones each time."""
    options = {"derandomize": True, "deadline": None, "database": None, "suppress_health_check": list(HealthCheck)}
    run_state_machine_as_test(machine, settings=settings(max_examples=sessions, stateful_step_count=30, **options))


@of_every_flavour("fmu", ["TetherDynamicFree"], SHELLS)
@in_own_process
def test_random_sessions(fmu_folder, fmu):
    first = Host(fmu_folder / f"{fmu}.fmu")
    # the other FMUs of PythonFMU have the same shell, and `native/driver.c` does many more sessions of native ones
    folder, sessions = first.folder, 60 if first.native else 160
    others = []
    for other in SLAVES:
        if other != fmu:
            host = Host(fmu_folder / f"{other}.fmu").start()
            others.append(host.fmu.serializeFMUstate(host.fmu.getFMUState()))
    run(session(folder, others), sessions)


INPUTS = {
    "PointMassKite": {"kite_velocity[3]": (-3.0, 0.0, 3.0), "kite_position[1]": (299.0, 300.5)},
    "FlyingKite": {"kite_force[1]": (-30.0, 0.0, 3.0), "wind_velocity[1]": (-20.0, 0.0, 8.0)},
    "Winch": {"ground_tension": (0.0, 1000.0), "set_speed": (-1.0, 1.0)},
    "FlightController": {"heading": (0.0, 1.0), "tether_length": (100.0, 400.0)},
    "TurbulentWind": {"kite_position[2]": (-20.0, 40.0), "shape[3,1]": (0.0, 90.0)},
}
PARAMETER = {
    "PointMassKite": "wing_area",
    "FlyingKite": "kite_mass",
    "Winch": "drum_radius",
    "FlightController": "elevation",
    "TurbulentWind": "mean_speed",
}


@pytest.mark.parametrize("name", list(INPUTS))
@in_own_process
def test_random_sessions_of_examples(example_folder, name):
    other = Host(example_folder / "KiteOnPath.fmu").start()
    states = [other.fmu.serializeFMUstate(other.fmu.getFMUState())]
    parameters = {PARAMETER[name]: (0.2, 0.5)}, {PARAMETER[name]: (-1.0, math.nan, 1e300)}
    run(session(Host(example_folder / f"{name}.fmu").folder, states, INPUTS[name], *parameters), 30)
