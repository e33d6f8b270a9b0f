"""What ended a process with PythonFMU's library: odd paths and addresses, NULL, pointers to something else, short buffers.

Called through ctypes, as a host in C would do it.
"""

import ctypes
import gc
import math
import subprocess
import sys
from ctypes import byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from pathlib import Path

import pytest
from fmpy import extract, read_model_description
from fmpy.fmi1 import FMICallException

from isolation import in_own_process
from native import programs
from runtime.host import Host, blob_of
from runtime.test_memory import LINUX, resident

ODD = ("+", "(", "@", "#", "%", "%41", ",", "{", ";", "'", "&", "ü", "日本", "a b", "[x]", "=", "!", "$HOME")
OK, WARNING, DISCARD, ERROR = range(4)
LAST_SUCCESSFUL_TIME, TERMINATED = 2, 3
LOGGER = ctypes.CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)
RESULTS = {
    "fmi2Instantiate": c_void_p,
    "fmi2FreeInstance": None,
    "fmi2GetVersion": c_char_p,
    "fmi2GetTypesPlatform": c_char_p,
}


class Callbacks(ctypes.Structure):
    _fields_ = [(name, c_void_p) for name in ("logger", "allocate", "free", "finished", "environment")]


class Library:
    """The functions of an FMU for FMI 2, and the messages of all its instances."""

    def __init__(self, path, folder=None):
        self.folder = Path(extract(str(path), unzipdir=folder and str(folder)))
        description = read_model_description(str(path))
        self.guid = description.guid.encode()
        self.reference = {variable.name: variable.valueReference for variable in description.modelVariables}
        name = description.coSimulation.modelIdentifier
        places = {"linux": f"linux64/{name}.so", "win32": f"win64/{name}.dll", "darwin": f"darwin64/{name}.dylib"}
        self.loaded = ctypes.CDLL(str(self.folder / "binaries" / places[sys.platform]))
        self.messages = []
        self._logger = LOGGER(lambda *words: self.messages.append(words[4].decode()))
        self.callbacks = Callbacks(ctypes.cast(self._logger, c_void_p), None, None, None, None)

    def __getattr__(self, name):
        function = getattr(self.loaded, f"fmi2{name}")
        function.restype = RESULTS.get(f"fmi2{name}", c_int)
        return function

    def instance(self, name=b"tether", guid=None, uri=None, callbacks=None, kind=1):
        made = self.Instantiate(name, kind, guid or self.guid, uri, callbacks or byref(self.callbacks), 0, 1)
        return made and c_void_p(made)

    def started(self):
        tether = self.instance()
        assert self.EnterInitializationMode(tether) == self.ExitInitializationMode(tether) == OK
        return tether

    def step(self, tether, time=0.0, size=0.02):
        return self.DoStep(tether, c_double(time), c_double(size), 1)

    def bytes_of(self, tether):
        state, size = c_void_p(), c_size_t()
        assert self.GetFMUstate(tether, byref(state)) == OK
        assert self.SerializedFMUstateSize(tether, state, byref(size)) == OK
        room = ctypes.create_string_buffer(size.value)
        assert self.SerializeFMUstate(tether, state, room, size) == OK
        assert self.FreeFMUstate(tether, byref(state)) == OK
        assert not state
        return room.raw


@pytest.fixture
def dynamic(native_folder):
    return native_folder / "TetherDynamic.fmu"


@in_own_process
def test_odd_paths(dynamic, tmp_path):
    for k, odd in enumerate(ODD):
        fmu = Library(dynamic, tmp_path / f"{k} {odd}")
        uri = (fmu.folder / "resources").as_uri().encode()
        tether = fmu.instance(uri=uri)
        assert fmu.EnterInitializationMode(tether) == fmu.ExitInitializationMode(tether) == fmu.step(tether) == OK


@in_own_process
def test_odd_addresses_and_names(dynamic):
    """Nothing is read from the resources, so any address will do."""
    fmu = Library(dynamic)
    for uri in (
        None,
        b"",
        b"file:/path",
        b"file://localhost/path",
        b"file:///missing",
        b"http://x/y",
        b"\xff\xfe",
        b"%" * 9999,
    ):
        for name in (b"", b"\xff\xfe\x80", b"%s%n%d", b"x" * 9999):
            tether = fmu.instance(name=name, uri=uri)
            assert fmu.step(tether) == ERROR  # before the initialization, which is said
            fmu.FreeInstance(tether)
    assert {message.split(":")[0] for message in fmu.messages} == {"fmi2DoStep"}


@in_own_process
def test_instances_that_are_refused(dynamic):
    fmu = Library(dynamic)
    for arguments, words in (
        ({"name": None}, "instanceName is NULL"),
        ({"guid": b"{271970860d73b5bb1fee94b90a30d447}"}, "the guid or token is {2719"),
        ({"guid": b""}, "the guid or token is"),
        ({"kind": 0}, "co-simulation only"),
    ):
        if arguments.get("guid") == b"":
            assert not fmu.Instantiate(b"tether", 1, b"", None, byref(fmu.callbacks), 0, 1)
        else:
            assert fmu.instance(**arguments) is None
        assert words in fmu.messages[-1]
    assert not fmu.Instantiate(b"tether", 1, None, None, byref(fmu.callbacks), 0, 1)
    silent = fmu.Instantiate(b"tether", 1, fmu.guid, None, None, 0, 1)
    assert fmu.step(c_void_p(silent)) == ERROR


@in_own_process
def test_null_and_foreign_pointers(native_folder, dynamic):
    """Refused, in words where there is an instance; the state is that of before."""
    fmu, other = Library(dynamic), Library(native_folder / "TetherStraight.fmu")
    tether, foreign = fmu.started(), other.started()
    before = fmu.bytes_of(tether)
    rubbish = ctypes.create_string_buffer(1000)
    for wrong in (None, foreign, ctypes.cast(rubbish, c_void_p)):
        assert fmu.step(wrong) == fmu.Reset(wrong) == fmu.Terminate(wrong) == ERROR
        fmu.FreeInstance(wrong)
    state, size, number = c_void_p(), c_size_t(), c_double()
    assert other.GetFMUstate(foreign, byref(state)) == OK
    calls = [
        (fmu.GetReal, None, c_size_t(1), byref(number)),
        (fmu.SetReal, (c_uint * 1)(0), c_size_t(1), None),
        (fmu.SetString, (c_uint * 1)(0), c_size_t(1), (c_char_p * 1)()),
        (fmu.GetFMUstate, None),
        (fmu.SetFMUstate, None),
        (fmu.SetFMUstate, state),
        (fmu.GetFMUstate, byref(state)),
        (fmu.FreeFMUstate, byref(state)),
        (fmu.SerializedFMUstateSize, None, byref(size)),
        (fmu.SerializedFMUstateSize, state, None),
        (fmu.DeSerializeFMUstate, None, c_size_t(9), byref(state)),
        (fmu.SetDebugLogging, 1, c_size_t(1), (c_char_p * 1)(b"all")),
        (fmu.SetDebugLogging, 1, c_size_t(2), None),
        (fmu.GetRealStatus, LAST_SUCCESSFUL_TIME, None),
    ]
    for call, *arguments in calls:
        said = len(fmu.messages)
        assert call(tether, *arguments) == ERROR, call
        assert len(fmu.messages) == said + 1
    assert fmu.FreeFMUstate(tether, None) == fmu.FreeFMUstate(tether, byref(c_void_p())) == OK
    assert fmu.GetReal(tether, None, c_size_t(0), None) == OK
    assert fmu.bytes_of(tether) == before
    assert fmu.step(tether) == OK


@pytest.mark.parametrize("fmu_folder", ["native", "native_fmi3"], indirect=True)
@in_own_process
def test_instances_and_states_are_told_apart(fmu_folder):
    """A state where an instance belongs, and the other way round: refused, nothing is freed, both can be used."""
    host = Host(fmu_folder / "TetherDynamic.fmu").start()
    before, tether, state = blob_of(host), host.fmu.component, host.fmu.getFMUState()
    itself, output = c_void_p(tether), host.real_outputs[0]
    for call in (host.fmu.setFMUState, host.fmu.freeFMUState, getattr(host.fmu, host.SERIALIZE)):
        with pytest.raises(FMICallException, match="error"):
            call(itself)
        assert host.messages[-1].endswith("this is not a state of this FMU")
        assert itself.value == tether
    host.fmu.component = state
    calls = [host.fmu.reset, host.fmu.enterInitializationMode, host.fmu.terminate, host.fmu.getFMUState]
    calls += [lambda: host.fmu.doStep(0.0, 0.02), lambda: host.get_reals([output]), lambda: host.set(reel_out_speed=1.0)]
    for call in (*calls, lambda: host.fmu.setFMUState(state)):
        with pytest.raises(FMICallException, match="error"):
            call()
    host.free()
    host.fmu.component = tether
    assert blob_of(host) == before
    host.step(0.02)
    host.fmu.setFMUState(state)
    host.fmu.freeFMUState(state)
    assert blob_of(host) == before


@in_own_process
def test_an_instance_is_no_place_for_a_state(dynamic):
    fmu = Library(dynamic)
    tether = fmu.started()
    before, itself = fmu.bytes_of(tether), c_void_p(tether.value)
    for call, *arguments in (
        (fmu.GetFMUstate, byref(itself)),
        (fmu.SerializedFMUstateSize, tether, byref(c_size_t())),
        (fmu.DeSerializeFMUstate, before, c_size_t(len(before)), byref(itself)),
    ):
        assert call(tether, *arguments) == ERROR, call
        assert fmu.messages[-1].endswith("this is not a state of this FMU")
        assert itself.value == tether.value
    assert fmu.bytes_of(tether) == before


@in_own_process
def test_short_buffers(dynamic):
    fmu = Library(dynamic)
    tether, state = fmu.started(), c_void_p()
    assert fmu.GetFMUstate(tether, byref(state)) == OK
    needed = len(fmu.bytes_of(tether))
    room = ctypes.create_string_buffer(b"\x55" * needed, needed)
    for size in (0, 1, 55, needed - 1):
        assert fmu.SerializeFMUstate(tether, state, room, c_size_t(size)) == ERROR
        assert f"the buffer has {size} bytes; the state has {needed}" in fmu.messages[-1]
    assert room.raw == b"\x55" * needed


@in_own_process
def test_status_after_a_refused_step(dynamic):
    fmu = Library(dynamic)
    tether, time, end = fmu.started(), c_double(), c_int(1)
    assert fmu.step(tether) == OK
    for size, status in ((-1.0, ERROR), (0.02, OK)):
        assert fmu.step(tether, 0.02, size) == status
        assert fmu.GetRealStatus(tether, LAST_SUCCESSFUL_TIME, byref(time)) == OK
        assert fmu.GetBooleanStatus(tether, TERMINATED, byref(end)) == OK
        assert (time.value, end.value) == (0.02 if status else 0.04, 0)
    for call in (fmu.GetStatus, fmu.GetIntegerStatus, fmu.GetStringStatus):
        assert call(tether, 0, byref(end)) == DISCARD
    assert fmu.CancelStep(tether) == ERROR


@in_own_process
def test_stop_time(dynamic):
    """A step beyond the stop time of the experiment is an error; one that ends there but for rounding is done."""
    fmu = Library(dynamic)
    tether = fmu.instance()
    assert fmu.SetupExperiment(tether, 0, c_double(), c_double(math.nan), 0, c_double()) == ERROR
    assert fmu.SetupExperiment(tether, 0, c_double(), c_double(), 1, c_double(0.3)) == OK
    assert fmu.EnterInitializationMode(tether) == fmu.ExitInitializationMode(tether) == OK
    time = 0.0
    for _ in range(3):
        assert fmu.step(tether, time, 0.1) == OK
        time += 0.1
    assert time > 0.3
    assert fmu.step(tether, time, 0.1) == ERROR
    assert "beyond the stop time of 0.3 s" in fmu.messages[-1]


@LINUX
@in_own_process
def test_states_do_not_leak(dynamic):
    """20 000 taken into a new and into an existing pointer, written and read: a leak of one kind would be 48 MB."""
    fmu = Library(dynamic)
    tether, state, copy = fmu.started(), c_void_p(), c_void_p()
    blob = fmu.bytes_of(tether)
    assert fmu.GetFMUstate(tether, byref(state)) == OK
    for cycle in range(21_000):
        if cycle == 1000:
            memory = resident()
        new = c_void_p()
        assert fmu.GetFMUstate(tether, byref(state)) == fmu.GetFMUstate(tether, byref(new)) == OK
        assert fmu.DeSerializeFMUstate(tether, blob, c_size_t(len(blob)), byref(copy)) == OK
        assert fmu.SetFMUstate(tether, copy) == fmu.FreeFMUstate(tether, byref(new)) == OK
    assert resident() - memory < 1e5


@LINUX
@in_own_process
def test_10_000_instances(dynamic):
    """Each less than 64 kB, started, of which 46 kB are the scratch space of both methods; all memory is given back."""
    fmu = Library(dynamic)
    fmu.FreeInstance(fmu.started())
    gc.disable()
    memory = resident()
    tethers = [fmu.started() for _ in range(10_000)]
    each = (resident() - memory) / len(tethers)
    assert each < 64e3, each
    for tether in tethers:
        fmu.FreeInstance(tether)
    del tethers
    assert resident() - memory < 0.1 * each * 10_000


@pytest.mark.skipif(not programs.available(), reason="needs gcc on 64-bit Linux")
@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("optimized", ["-O0", "-Os"])
def test_what_was_freed_is_refused(tmp_path, fmi, optimized):
    """As far as its memory can tell: this host keeps what is freed as it is, so that nothing but the mark can."""
    options = (optimized, "-Wl,--wrap=free")
    program = programs.compiled(tmp_path, "straight", fmi, Path(__file__).with_name("after_free.c"), options)
    done = subprocess.run([program], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "all refused\n"), done.stderr


@in_own_process
def test_versions(dynamic):
    fmu = Library(dynamic)
    assert (fmu.GetVersion(), fmu.GetTypesPlatform()) == (b"2.0", b"default")
