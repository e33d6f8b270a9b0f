"""FMUs of the examples in one process, of which one has gone with its folder before another is loaded."""

import shutil

from isolation import in_own_process
from runtime.host import Host


@in_own_process
def test_a_kite_after_the_folder_of_another_has_vanished(example_folder):
    first = Host(example_folder / "PointMassKite.fmu", own_folder=True).start()
    shutil.rmtree(first.folder)
    second = Host(example_folder / "FlyingKite.fmu").start()
    first.step(0.02)
    second.step(0.02)
    assert second.get("kite_position[1]") != 0.0
