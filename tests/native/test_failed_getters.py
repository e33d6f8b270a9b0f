"""What a getter that fails leaves for importers that do not look at its status: no number, no text, nothing to be followed.

Each function that writes through pointers is called with a room that was full before: NaN, the smallest integer for types
that variables have, false, NULL and sizes of 0 are there afterwards, whatever was wrong with the call.
"""

import ctypes
import math
from ctypes import c_bool, c_double, c_float, c_int, c_int8, c_int16, c_int32, c_int64, c_size_t, c_uint, c_void_p

import pytest

from isolation import in_shared_process
from runtime.host import Host

COUNT, UNKNOWN = 3, 10**6
REFERENCES, VALUES, NUMBERS = "references", "count", "numbers"  # arguments other than results
NAN, SMALLEST, FALSE, NULL, ERROR = math.nan, -(2**31), False, None, 3
TWO = {
    "GetReal": [REFERENCES, VALUES, (c_double, NAN)],
    "GetInteger": [REFERENCES, VALUES, (c_int, SMALLEST)],
    "GetBoolean": [REFERENCES, VALUES, (c_int, 0)],
    "GetString": [REFERENCES, VALUES, (c_void_p, NULL)],
    "GetDirectionalDerivative": [REFERENCES, VALUES, REFERENCES, VALUES, NUMBERS, (c_double, NAN)],
    "GetRealOutputDerivatives": [REFERENCES, VALUES, NUMBERS, (c_double, NAN)],
    "GetDerivatives": [(c_double, NAN), VALUES],
    "GetEventIndicators": [(c_double, NAN), VALUES],
    "GetContinuousStates": [(c_double, NAN), VALUES],
    "GetNominalsOfContinuousStates": [(c_double, NAN), VALUES],
}
STATUS = {  # one result each
    "GetStatus": [c_int(0), (c_int, ERROR)],
    "GetRealStatus": [c_int(0), (c_double, NAN)],
    "GetIntegerStatus": [c_int(0), (c_int, SMALLEST)],
    "GetBooleanStatus": [c_int(0), (c_int, 0)],
    "GetStringStatus": [c_int(0), (c_void_p, NULL)],
}
THREE = {
    "GetFloat32": [REFERENCES, VALUES, (c_float, NAN), VALUES],
    "GetFloat64": [REFERENCES, VALUES, (c_double, NAN), VALUES],
    "GetInt32": [REFERENCES, VALUES, (c_int32, SMALLEST), VALUES],
    "GetInt64": [REFERENCES, VALUES, (c_int64, SMALLEST), VALUES],
    **{
        f"Get{sign}Int{8 * ctypes.sizeof(kind)}": [REFERENCES, VALUES, (kind, 0), VALUES]
        for kind in (c_int8, c_int16, c_int32, c_int64)
        for sign in ("", "U")
        if sign or kind in (c_int8, c_int16)
    },
    "GetBoolean": [REFERENCES, VALUES, (c_bool, FALSE), VALUES],
    "GetString": [REFERENCES, VALUES, (c_void_p, NULL), VALUES],
    "GetBinary": [REFERENCES, VALUES, (c_size_t, 0), (c_void_p, NULL), VALUES],
    "GetClock": [REFERENCES, VALUES, (c_bool, FALSE)],
    "GetDirectionalDerivative": [REFERENCES, VALUES] * 2 + [NUMBERS, VALUES, (c_double, NAN), VALUES],
    "GetAdjointDerivative": [REFERENCES, VALUES] * 2 + [NUMBERS, VALUES, (c_double, NAN), VALUES],
    "GetOutputDerivatives": [REFERENCES, VALUES, NUMBERS, (c_double, NAN), VALUES],
    "GetIntervalDecimal": [REFERENCES, VALUES, (c_double, NAN), (c_int, 0)],
    "GetIntervalFraction": [REFERENCES, VALUES, (c_int64, 0), (c_int64, 0), (c_int, 0)],
    "GetShiftDecimal": [REFERENCES, VALUES, (c_double, NAN)],
    "GetShiftFraction": [REFERENCES, VALUES, (c_int64, 0), (c_int64, 0)],
    "GetVariableDependencies": [c_uint(UNKNOWN), (c_size_t, 0), (c_uint, 0), (c_size_t, 0), (c_int, 0), VALUES],
    "GetContinuousStateDerivatives": [(c_double, NAN), VALUES],
    "GetEventIndicators": [(c_double, NAN), VALUES],
    "GetContinuousStates": [(c_double, NAN), VALUES],
    "GetNominalsOfContinuousStates": [(c_double, NAN), VALUES],
}
NUMBER = {name: [(c_size_t, 0)] for name in ("GetNumberOfEventIndicators", "GetNumberOfContinuousStates")}
NUMBER["GetNumberOfVariableDependencies"] = [c_uint(UNKNOWN), (c_size_t, 0)]
UPDATES = {"UpdateDiscreteStates": [*[(c_bool, FALSE)] * 5, (c_double, NAN)]}


def left_by(function, handle, references, arguments, count):
    """Values that a call leaves in each of its results, which have bits set in all bytes before."""
    rooms = []

    def passed(argument):
        if argument is REFERENCES:
            return references
        if argument is VALUES:
            return c_size_t(count)
        if argument is NUMBERS:
            return (c_double * count)()
        if not isinstance(argument, tuple):
            return argument
        rooms.append((argument[0] * count)())
        ctypes.memset(rooms[-1], 0x55, ctypes.sizeof(rooms[-1]))
        return rooms[-1]

    function.argtypes, function.restype = None, c_int
    assert function(handle, *map(passed, arguments)) in (2, ERROR), function
    return [list(room) for room in rooms]


CALLS = {2: ((COUNT, TWO), (1, STATUS)), 3: ((COUNT, THREE), (1, NUMBER | UPDATES))}


@pytest.mark.parametrize("fmu_folder", ["native", "native_fmi3"], indirect=True)
@in_shared_process
def test_what_a_failed_getter_fills(fmu_folder):
    """Of an unknown variable; without references; of no instance, and of something else."""
    host = Host(fmu_folder / "TetherDynamic.fmu").start()
    unknown, foreign = (c_uint * COUNT)(*[UNKNOWN] * COUNT), ctypes.create_string_buffer(1000)
    own = c_void_p(host.fmu.component)
    wrong = ((own, unknown), (own, None), (None, unknown), (foreign, unknown))
    for count, functions in CALLS[host.version]:
        for name, arguments in functions.items():
            expected = [[each[1]] * count for each in arguments if isinstance(each, tuple)]
            for handle, references in wrong:
                function = getattr(host.fmu.dll, f"fmi{host.version}{name}")
                assert repr(left_by(function, handle, references, arguments, count)) == repr(expected), name
    host.step(0.02)


@pytest.mark.parametrize("fmu_folder", ["pythonfmu"], indirect=True)
@in_shared_process
def test_texts_of_pythonfmus_library(fmu_folder):
    """It answers all with OK, and ends the process if it is to pass on NULL: texts that do not exist are empty."""
    host = Host(fmu_folder / "TetherDynamic.fmu").start()
    room, get = (c_void_p * COUNT)(*[1] * COUNT), host.fmu.dll.fmi2GetString
    get.argtypes = None
    assert get(c_void_p(host.fmu.component), (c_uint * COUNT)(*[UNKNOWN] * COUNT), c_size_t(COUNT), room) == 0
    assert [ctypes.string_at(text) for text in room] == [b""] * COUNT
    assert f"value reference {UNKNOWN} (no variable of this FMU) cannot be read" in host.messages[-1]
