"""A communication step of a native FMU makes no system call and allocates nothing: a filter kills what does."""

import signal

import pytest

from native import programs, real_time

pytestmark = pytest.mark.skipif(not programs.available(), reason="needs gcc on 64-bit Linux")
NO_FILTER = 77  # exit status where the process may not have one


@pytest.fixture(scope="module")
def program(tmp_path_factory):
    return real_time.compiled(tmp_path_factory.mktemp("real_time"), 20)


def ended(program, mode, flight, fixed_step):
    done = real_time.run(program, 20, mode, flight, 1000, 0.005, fixed_step)
    if done.returncode == NO_FILTER:
        pytest.skip("no seccomp filter is allowed here")
    return done


@pytest.mark.parametrize("flight", ["circle", "snaps"])
@pytest.mark.parametrize("fixed_step", [0.005, 0.0], ids=["fixed", "adaptive"])
def test_no_system_call_and_no_allocation_in_1000_steps(program, flight, fixed_step):
    """Inputs, step and outputs; taut, and slack and snapping."""
    done = ended(program, "silent", flight, fixed_step)
    assert done.returncode == 0, done.stderr


def test_the_filter_kills_at_a_system_call(program):
    assert ended(program, "loud", "circle", 0.005).returncode == -signal.SIGSYS
