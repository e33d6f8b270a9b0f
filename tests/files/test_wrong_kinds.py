"""Whatever stands in the place of a value of a scene or system file is refused in words, never by a traceback."""

import tomllib
from contextlib import suppress
from copy import deepcopy

import pytest

from tetherfmu.files import lean
from tetherfmu.files.named import named_scenes, named_systems
from tetherfmu.files.scene_files import read as read_scene
from tetherfmu.files.system_files import read as read_system

KINDS = [["a"], [], {"a": 1}, {}, [[1, 2], [3]], True, "x", "", float("inf"), float("nan"), -1, 0, 10**30]
READERS = {
    **{path: lambda table, path: read_scene(table, path.parent, path.stem) for path in named_scenes().values()},
    **{path: lambda table, path: read_system(table, path.stem) for path in named_systems().values()},
}


def places(table, before=()):
    """Yield where a value stands in nested tables, as tuples of keys."""
    for key, value in table.items():
        yield (*before, key)
        if isinstance(value, dict):
            yield from places(value, (*before, key))


def with_value(table, place, value):
    """A copy of a table with another value at a place."""
    found = inner = deepcopy(table)
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = value
    return found


@pytest.mark.filterwarnings("ignore")  # what is hardly meant is warned of, too
@pytest.mark.parametrize("path", READERS, ids=lambda path: path.stem)
def test_values_of_another_kind(path):
    table = tomllib.loads(path.read_text(encoding="utf-8"))
    refused = 0
    for place in places(table):
        for value in KINDS:
            try:
                READERS[path](with_value(table, place, value), path)
            except (ValueError, OSError, RuntimeError) as error:  # what commands say in one line
                refused += bool(str(error))
    assert refused > len(KINDS)


def test_values_of_another_kind_of_what_is_built():
    """Lists of names are looked up with the FMU, and start values, too."""
    table = {"preset": "kite", "inputs": ["kite_position"], "outputs": ["kite_force"], "parameters": []}
    table["set"] = {"diameter": 1}
    refused = set()
    for place in places(table):
        for value in KINDS:
            with suppress(ValueError):
                lean.read(with_value(table, place, value))
                continue
            refused.add((place[0], repr(value)))
    wrong = {"preset": "['a']", "inputs": "{'a': 1}", "outputs": "True", "parameters": "'x'", "set": "-1"}
    assert wrong.items() <= refused
