"""Files are there as a whole or not at all, whoever else writes them; what a killed process has left goes after an hour."""

import os
import pickle
import re
import time
import zipfile
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest

from isolation import CONTEXT
from tetherfmu.export.archive import write_archive
from tetherfmu.libraries.sources import PACKAGE
from tetherfmu.libraries.whole_files import LEFT_BEHIND, clear, whole
from tetherfmu.python.results import Flown
from tetherfmu.study.measuring.errors import Reference
from tetherfmu.study.measuring.runs import Config, Run
from tetherfmu.study.measuring.store import Store

ROUNDS, WRITERS = 25, 4


def write_rounds(target, content):
    """Write an archive many times, and read what is there after each: its one entry, or why it cannot be read."""
    found = set()
    for _ in range(ROUNDS):
        write_archive({"content": content}, target)
        with zipfile.ZipFile(target) as archive:
            found.add(archive.read("content"))
    return found


def test_writers_of_one_archive(tmp_path):
    """Each of 100 rounds leaves an archive that one of the writers has written; with one name for all most were broken."""
    contents = [bytes([k]) * 200_000 for k in range(WRITERS)]
    with ProcessPoolExecutor(WRITERS, CONTEXT) as pool:
        found = set().union(*pool.map(write_rounds, [tmp_path / "one.fmu"] * WRITERS, contents))
    assert found <= set(contents)
    assert [path.name for path in tmp_path.iterdir()] == ["one.fmu"]


def write_half_of(target):
    """Write to a disk that is then full."""
    with whole(target) as unfinished:
        unfinished.write_text("half of")
        raise OSError(28, "No space left on device")


def test_what_fails_leaves_the_file_of_before(tmp_path):
    target = tmp_path / "target"
    target.write_text("before")
    with pytest.raises(OSError, match="No space left") as error:
        write_half_of(target)
    assert error.value.filename == str(target)
    assert [path.name for path in tmp_path.iterdir()] == ["target"]
    assert target.read_text() == "before"


def test_what_was_left_behind_is_cleared(tmp_path):
    """A file and a folder from over an hour ago, not one that somebody is at work on, nor what others have called alike."""
    for name in ("a[1].fmu.old.partial", "a[1].fmu.new.partial", "b.fmu.old.partial"):
        (tmp_path / name).touch()
    (tmp_path / "partial-old").mkdir()
    ago = time.time() - 1.1 * LEFT_BEHIND
    for name in ("a[1].fmu.old.partial", "b.fmu.old.partial", "partial-old"):
        os.utime(tmp_path / name, (ago, ago))
    with whole(tmp_path / "a[1].fmu") as unfinished:
        unfinished.touch()
    clear(tmp_path, "partial-*")
    assert {path.name for path in tmp_path.iterdir()} == {"a[1].fmu", "a[1].fmu.new.partial", "b.fmu.old.partial"}


# --- what is kept of studies


def reference():
    flown = Flown(np.arange(6.0).reshape(2, 3) / 7.0, np.array([1.0, 2.0]), None, 0.1, (), np.array([0.02, 0.04]))
    return Reference(Config("dynamic", 16, 1e-6, 0.002), Run(flown, 3, 4, ("a",)), {"power": 1 / 3}, {"power": 0.1}, 2.5)


class Attack:
    """Unpickling makes a file."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return os.mkdir, (str(self.path),)


def test_a_reference_is_kept_as_it_was(tmp_path):
    store = Store(tmp_path / "points.jsonl")
    store.kept("key", reference)
    again = store.kept("key", lambda: pytest.fail("made anew"))
    assert repr(again._replace(run=None)) == repr(reference()._replace(run=None))
    assert again.run[1:] == reference().run[1:]
    for name in ("outputs", "peak", "time"):
        np.testing.assert_array_equal(getattr(again.run.flown, name), getattr(reference().run.flown, name))


@pytest.mark.parametrize("content", [b"", b"no archive", b"PK\x03\x04"], ids=["empty", "text", "zip"])
def test_a_damaged_reference_is_made_anew(tmp_path, content):
    (tmp_path / "key.npz").write_bytes(content)
    assert Store(tmp_path / "points.jsonl").kept("key", reference).spent == 2.5


def test_no_file_of_a_folder_is_executed(tmp_path):
    done = tmp_path / "done"
    attack = pickle.dumps(Attack(done))
    for ending in ("npz", "pickle"):
        (tmp_path / f"key.{ending}").write_bytes(attack)
    np.savez(tmp_path / "objects.npz", outputs=np.array([Attack(done)], dtype=object), facts="[]", peak=0.0, time=0.0)
    store = Store(tmp_path / "points.jsonl")
    for key in ("key", "objects"):
        assert store.kept(key, reference).spent == 2.5
    assert not done.exists()
    pattern = re.compile(r"\bpickle\.loads?\b|\bUnpickler\b|allow_pickle=True|read_pickle|\bmarshal\b|\bshelve\b")
    assert not [path for path in PACKAGE.rglob("*.py") if pattern.search(path.read_text(encoding="utf-8"))]


@pytest.mark.parametrize("line", ['{"a": 1}', "null", "3", '["key"]', '{"key": "b"', "\0"])
def test_a_damaged_line_of_results_is_left_out(tmp_path, line):
    file = tmp_path / "flights.jsonl"
    file.write_text(f'{line}\n{{"key": "a", "x": 1.0}}\n', encoding="utf-8")
    assert Store(file).points == {"a": {"x": 1.0}}
