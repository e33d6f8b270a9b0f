"""An FMU says once since its start what is implausible: not in a state that has said it, again after reset.

What is said of a start and of one step: `test_bad_input.py`.
"""

from isolation import in_shared_process
from runtime.host import STEP, Host, blob_of, of_every_flavour, restore
from scenes import circle, kite_at_start, kite_inputs
from tetherfmu.runtime.variants import VARIANTS, class_name


def fly(host, begin, end, factor=0.0):
    """Steps on the circle with a wrong velocity; returns the messages."""
    host.messages.clear()
    for k in range(begin, end):
        position, velocity = circle(k * STEP)
        host.time = k * STEP
        host.step(STEP, **kite_inputs(host.name, position, factor * velocity))
    return host.messages[:]


def start(host, **values):
    kite = kite_at_start(host.name, circle(0.0)[0])
    return host.start(initial_length=525.0, ground_height=-100.0, **kite, **values)


@of_every_flavour("fmu", tuple(map(class_name, VARIANTS)))
@in_shared_process
def test_once_in_flight_and_in_states(fmu_folder, fmu):
    """A state that has said it says nothing anywhere; one of before says it once, but not twice in one instance."""
    path = fmu_folder / f"{fmu}.fmu"
    host = start(Host(path))
    assert host.messages == []
    before = blob_of(host)
    (said,) = fly(host, 0, 20)
    assert "kite_velocity contradicts kite_position" in said
    after = blob_of(host)
    assert fly(host, 20, 80) == []
    for blob, begin in ((after, 20), (before, 0), (after, 20)):
        restore(host, blob)
        assert fly(host, begin, 40) == []
    for blob, begin, count in ((after, 20, 0), (before, 0, 1)):
        another = Host(path, "another")
        restore(another, blob)
        assert len(fly(another, begin, 40)) == count
    host.fmu.reset()
    start(host)
    assert len(fly(host, 0, 40)) == 1


@of_every_flavour("fmu")
@in_shared_process
def test_nothing_is_said_of_what_is_plausible(fmu_folder, fmu):
    """A flight; a first start in initialization mode with other ends; a kite that waits elsewhere before the first step."""
    host = Host(fmu_folder / f"{fmu}.fmu")
    host.enter_initialization(None)
    host.set(initial_length=100.0)
    assert host.get("kite_tension") > 1e5  # stretched by 400 %
    host.set(initial_length=525.0, ground_height=-100.0, **kite_at_start(fmu, *circle(0.0)))
    host.fmu.exitInitializationMode()
    assert host.messages == []
    assert fly(host, 0, 100, 1.0) == []
    derived = start(Host(fmu_folder / f"{fmu}.fmu"), end_velocities=2)
    assert fly(derived, 0, 100) == []
