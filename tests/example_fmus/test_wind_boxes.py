"""Readers of wind boxes: files that other programs wrote, the published header byte by byte, damaged files, huge files."""

import json
import math
import os
import struct
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

from tetherfmu.wind import frozen_turbulence as frozen
from tetherfmu.wind import wind_boxes as boxes

REFERENCE = Path(__file__).resolve().parents[1] / "reference"
MANN, POINTS, SPACING = REFERENCE / "mann_u.turb", (16, 4, 8), (5.0, 10.0, 8.0)
MEGABYTE = 2**20


def velocity_at(box, i, j, k):
    """What a box has at a point of its grid."""
    number = i * box.strides[0] + j * box.strides[1] + k * box.strides[2]
    stored = [float(component[number]) for component in box.components]
    return [(value - zero) / slope for value, zero, slope in zip(stored, box.offset, box.scale, strict=True)]


def turbsim(path, numbers, towers=0, kind=8, description=b"none", **changes):
    """A TurbSim file by the format in its user's guide: numbers (nt, nz, ny, 3) as they are stored, each field by itself."""
    nt, nz, ny, _ = numbers.shape
    header = {
        "ID": struct.pack("<h", kind),
        "NumGrid_Z": struct.pack("<i", nz),
        "NumGrid_Y": struct.pack("<i", ny),
        "n_tower": struct.pack("<i", towers),
        "n_t": struct.pack("<i", nt),
        "dz": struct.pack("<f", 15.0),
        "dy": struct.pack("<f", 20.0),
        "dt": struct.pack("<f", 0.5),
        "u_hub": struct.pack("<f", 9.0),
        "HubHt": struct.pack("<f", 50.0),
        "Z_bottom": struct.pack("<f", 20.0),
        "Vslope_u": struct.pack("<f", 1000.0),
        "Vintercept_u": struct.pack("<f", -9000.0),
        "Vslope_v": struct.pack("<f", 2000.0),
        "Vintercept_v": struct.pack("<f", 10.0),
        "Vslope_w": struct.pack("<f", 4000.0),
        "Vintercept_w": struct.pack("<f", 0.0),
        "n_characters": struct.pack("<i", len(description)),
    }
    header |= changes
    with path.open("wb") as file:
        file.write(b"".join(header.values()) + description)
        for plane in numbers:
            file.write(plane.astype("<i2").tobytes() + struct.pack(f"<{3 * towers}h", *[-77] * 3 * towers))
    return path


def some_numbers(nt=6, nz=5, ny=3):
    return np.random.default_rng(2).integers(-30000, 30000, (nt, nz, ny, 3))


@pytest.mark.parametrize("towers", [0, 4])
@pytest.mark.parametrize("description", [b"", b"odd"])
def test_a_turbsim_file_byte_by_byte(tmp_path, towers, description):
    """Towers are between the planes; a description of odd length puts all numbers at odd addresses."""
    numbers = some_numbers()
    path = turbsim(tmp_path / "box.bts", numbers, towers, description=description)
    assert path.stat().st_size == 70 + len(description) + 2 * 6 * 3 * (15 + towers)
    box = boxes.open_box(path)
    assert box.points == (6, 3, 5)
    assert box.spacing == (-4.5, 20.0, 15.0)
    assert box.first == (0.0, -20.0, 20.0)
    assert box.mean == (9.0, 50.0)
    for i, k, j in np.ndindex(6, 5, 3):
        u, v, w = numbers[i, k, j].tolist()
        assert velocity_at(box, i, j, k) == [(u + 9000.0) / 1000.0, (v - 10.0) / 2000.0, w / 4000.0]


def test_a_turbsim_file_of_pyconturb():
    """What PyConTurb itself reads from it, in 32-bit numbers: 62000 has an error of 2e-3, over 7000 s/m."""
    box = boxes.open_box(REFERENCE / "pyconturb.bts")
    rows = np.loadtxt(REFERENCE / "pyconturb.csv", delimiter=",", skiprows=1)
    assert box.points == (12, 3, 5)
    assert box.mean == (9.0, 50.0)
    assert np.allclose(box.spacing, (-9.0 * rows[1, 0], 20.0, 15.0), rtol=1e-7)
    for i, j, k in np.ndindex(*box.points):
        expected = rows[i, 1:].reshape(3, 15)[:, 3 * k + j]  # as its reader has them: across first, as TurbSim
        np.testing.assert_allclose(velocity_at(box, i, j, k), expected, rtol=0.0, atol=2e-6)


def test_a_mann_box_of_hipersim():
    """What hipersim itself interpolates, also beyond the box, which it repeats; its x is downwind, 0 at the last plane."""
    box = boxes.open_box(MANN, POINTS, SPACING)
    rows = np.loadtxt(REFERENCE / "mann_between.csv", delimiter=",", skiprows=1)
    places = rows[:, :3] + box.first
    wind = frozen.FrozenTurbulence(frozen.MeanWind(0.0), box).at(0.0, places)
    # it keeps 64-bit numbers and writes 32-bit ones: half of the last digit of 8 m/s is 5e-7 m/s
    np.testing.assert_allclose(wind, rows[:, 3:], rtol=0.0, atol=5e-7)
    assert np.ptp(rows[:, 3:]) > 3.0


@pytest.mark.parametrize("kind", ["<f4", "<f8", ">f4"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_a_box_of_numpy(tmp_path, kind, order):
    velocity = np.random.default_rng(3).normal(size=(5, 3, 4, 3)).astype(kind)
    np.savez(tmp_path / "box.npz", spacing=(2.0, 3.0, 4.0), velocity=np.asarray(velocity, order=order))
    box = boxes.open_box(tmp_path / "box.npz")
    assert (box.points, box.spacing, box.first) == ((5, 3, 4), (2.0, 3.0, 4.0), (-8.0, -3.0, 0.0))
    assert not box.mean
    for place in np.ndindex(5, 3, 4):
        assert velocity_at(box, *place) == velocity[place].tolist()


def damaged(folder, what):
    """A file that is wrong in one way, and words of the refusal."""
    path = turbsim(folder / "box.bts", some_numbers())
    whole = path.read_bytes()
    grid = {"velocity": np.zeros((4, 3, 2, 3), "f4"), "spacing": (1.0, 1.0, 1.0)}
    other = folder / "other.npz"
    float32 = {"dz": struct.pack("<f", math.nan)}
    if what == "is not there":
        return folder / "none.bts", "No such file"
    if what == "is a folder":
        (folder / "folder.bts").mkdir()
        return folder / "folder.bts", "not a regular file"
    if what == "is a pipe":
        os.mkfifo(folder / "pipe.bts")
        return folder / "pipe.bts", "not a regular file"
    if what == "has another name":
        return folder / "box.wnd", "it must end in .bts (TurbSim), in .npz (numpy), or in u.bin or u.turb"
    if what == "is empty":
        path.write_bytes(b"")
        return path, "it has 0 bytes; the header alone must have 70"
    if what == "ends in its header":
        path.write_bytes(whole[:69])
        return path, "it has 69 bytes"
    if what == "is cut off":
        path.write_bytes(whole[:-1])
        return path, f"is cut off, or its grid is another one: it has {len(whole) - 1} bytes; its grid needs {len(whole)}"
    if what == "is too long":
        path.write_bytes(whole + b"x")
        return path, "is too long"
    if what == "is of another kind":
        return turbsim(path, some_numbers(), kind=-99), "it begins with -99; it must begin with 7, or with 8"
    if what == "has no points":
        return turbsim(
            path, some_numbers(), NumGrid_Y=struct.pack("<i", -3)
        ), "number of points across is -3; it must be at least 2"
    if what == "has points without end":
        return turbsim(path, some_numbers(), n_t=struct.pack("<i", 2**31 - 1)), "number of points along is 2.14748e+09"
    if what == "has no spacing":
        return turbsim(path, some_numbers(), **float32), "spacing upwards is nan; it must be at least 1e-06"
    if what == "has no slope":
        return turbsim(path, some_numbers(), Vslope_v=struct.pack("<f", 0.0)), "slope of v is 0"
    if what == "has a description without end":
        return turbsim(path, some_numbers(), n_characters=struct.pack("<i", -1)), "length of the description is -1"
    if what == "is compressed":
        np.savez_compressed(other, **grid)
        return other, "is compressed and cannot be mapped into memory; write it with numpy.savez"
    if what == "is no archive":
        other.write_bytes(whole)
        return other, "is not a numpy.savez file with the arrays velocity and spacing: File is not a zip file"
    if what == "lacks an array":
        np.savez(other, velocity=grid["velocity"])
        return other, "There is no item named 'spacing.npy' in the archive"
    if what == "has another shape":
        np.savez(other, velocity=np.zeros((4, 3, 2)), spacing=grid["spacing"])
        return other, "velocity is (4, 3, 2) and spacing (3,); they must be (points along, across, up, 3) and (3,)"
    if what == "has objects":
        np.savez(other, velocity=np.array([{}]), spacing=grid["spacing"])
        return other, "velocity.npy has numbers of the kind object; it must be float32 or float64"
    if what == "is an archive cut off":
        np.savez(other, **grid)
        other.write_bytes(other.read_bytes()[:-30])
        return other, "is not a numpy.savez file"
    if what == "has a wrong array":
        np.savez(other, **grid)
        other.write_bytes(other.read_bytes().replace(b"(4, 3, 2, 3)", b"(4, 3, 9, 3)"))
        return other, "is damaged: velocity.npy has"
    raise AssertionError(what)


DAMAGES = """is not there; is a folder; is a pipe; has another name; is empty; ends in its header; is cut off; is too long;
is of another kind; has no points; has points without end; has no spacing; has no slope; has a description without end;
is compressed; is no archive; lacks an array; has another shape; has objects; is an archive cut off; has a wrong array"""


@pytest.mark.parametrize("what", DAMAGES.replace("\n", " ").split("; "))
def test_a_wrong_file_is_refused_in_one_sentence(tmp_path, what):
    if what == "is a pipe" and not hasattr(os, "mkfifo"):
        pytest.skip("there are no named pipes here")
    path, words = damaged(tmp_path, what)
    with pytest.raises(boxes.WrongBox) as refusal:
        boxes.open_box(path)
    said = str(refusal.value)
    assert words in said
    assert str(path) in said
    assert "\n" not in said


def whole_file(folder, ending):
    """Path and bytes of a good file."""
    path = folder / f"box.{ending}"
    if ending == "bts":
        turbsim(path, some_numbers(3, 2, 2))
    else:
        np.savez(path, velocity=np.ones((2, 3, 2, 3), "f4"), spacing=(1.0, 1.0, 1.0))
    return path, path.read_bytes()


@pytest.mark.parametrize("ending", ["bts", "npz"])
def test_a_file_cut_off_anywhere_is_refused(tmp_path, ending):
    path, content = whole_file(tmp_path, ending)
    for length in range(len(content)):
        path.write_bytes(content[:length])
        with pytest.raises(boxes.WrongBox):
            boxes.open_box(path)


@pytest.mark.parametrize("ending", ["bts", "npz"])
def test_whatever_is_in_a_file_it_is_a_box_or_is_refused(tmp_path, ending):
    """Some bytes of it changed at random: what it then gives is a wind, and no other exception leaves the reader."""
    path, content = whole_file(tmp_path, ending)
    generator, found = np.random.default_rng(11), set()
    for _ in range(500):
        changed = bytearray(content)
        for place in generator.integers(0, len(content), 3):
            changed[place] = generator.integers(0, 256)
        path.write_bytes(changed)
        try:
            box = boxes.open_box(path)
            wind = frozen.FrozenTurbulence(frozen.MeanWind(1.0), box).at(0.0, np.ones((5, 3)))
            found.add(bool((np.abs(wind) <= 2.0 * boxes.LARGEST_SPEED).all()))
        except boxes.WrongBox:
            found.add("refused")
    assert found == {True, "refused"}


@pytest.mark.parametrize(
    ("points", "spacing", "words"),
    [
        ((0, 0, 0), SPACING, "does not say how many points it has"),
        ((16, 0, 8), SPACING, "number of points across is 0"),
        ((16, 4, 8), (5.0, -1.0, 8.0), "spacing across is -1; it must be at least 1e-06 and at most 100000"),
        ((16, 4, 9), SPACING, "it has 2048 bytes; its grid needs 2304"),
    ],
)
def test_wrong_dimensions_of_a_mann_box_are_refused(points, spacing, words):
    with pytest.raises(boxes.WrongBox) as refusal:
        boxes.open_box(MANN, points, spacing)
    assert words in str(refusal.value)
    assert str(MANN) in str(refusal.value)


def test_a_mann_box_needs_all_its_files(tmp_path):
    (tmp_path / "u.bin").write_bytes((REFERENCE / "mann_u.turb").read_bytes())
    with pytest.raises(boxes.WrongBox, match=r"v\.bin' cannot be opened: No such file"):
        boxes.open_box(tmp_path / "u.bin", POINTS, SPACING)


@pytest.mark.parametrize("value", [math.nan, math.inf, 1e30])
def test_numbers_that_are_no_wind_are_refused(tmp_path, value):
    """When they are read, for a box is never read as a whole."""
    velocity = np.ones((4, 3, 2, 3), "f4")
    velocity[2, 1, 1, 1] = value
    np.savez(tmp_path / "box.npz", velocity=velocity, spacing=(1.0, 1.0, 1.0))
    wind = frozen.FrozenTurbulence(frozen.MeanWind(0.0), boxes.open_box(tmp_path / "box.npz"))
    assert wind.at(0.0, np.array([[-2.5, 0.0, 0.5]])).tolist() == [[1.0, 1.0, 1.0]]
    with pytest.raises(boxes.WrongBox, match=r"box\.npz has a wind of (nan|inf|.*e\+\d+) m/s; it must be at most 150 m/s"):
        wind.at(0.0, np.array([[-1.5, 0.0, 0.5]]))


HUGE = """
import json, resource, sys
from tetherfmu.wind import frozen_turbulence as frozen
from tetherfmu.wind import wind_boxes as boxes
import numpy as np
points = np.linspace((0.0, 0.0, 0.0), (300.0, 0.0, 400.0), 22)
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
wind = frozen.FrozenTurbulence(frozen.MeanWind(10.0), boxes.open_box(sys.argv[1], *json.loads(sys.argv[2])))
for k in range(100):
    wind.at(0.02 * k, points)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="sparse files, and the unit of ru_maxrss")
@pytest.mark.parametrize("kind", ["bts", "bin"])
def test_four_gigabytes_need_no_memory(tmp_path, kind):
    """At odd addresses, too. 100 steps touch a few pages of 4 kB at each of 176 corners; 64 MB are 1/64 of the file."""
    if kind == "bts":
        path, given = turbsim(tmp_path / "box.bts", some_numbers(2, 80, 90), description=b"odd"), []
        grid = 3 * 80 * 90 * 2
        planes = 2**32 // grid + 1
        content = path.read_bytes()
        path.write_bytes(content[:14] + struct.pack("<i", planes) + content[18:73])
        os.truncate(path, 73 + planes * grid)
        assert path.stat().st_size > 2**32
    else:
        path, given = tmp_path / "u.bin", [(2**18, 64, 64), (1.0, 5.0, 5.0)]
        for letter in "uvw":
            (tmp_path / f"{letter}.bin").touch()
            os.truncate(tmp_path / f"{letter}.bin", 2**32)
    command = [sys.executable, "-c", HUGE, str(path), json.dumps(given)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert 1024 * int(done.stdout) < 64 * MEGABYTE


@pytest.mark.parametrize(
    ("kind", "outside", "said"),
    [(7, "repeated", True), (7, "periodic", False), (7, "refused", False), (8, "periodic", False)],
)
def test_a_box_that_is_not_periodic_is_not_repeated_in_silence(tmp_path, kind, outside, said):
    """Six planes, 0.5 s and 4.5 m apart."""
    box = boxes.open_box(turbsim(tmp_path / "box.bts", some_numbers(), kind=kind))
    with warnings.catch_warnings(record=True) as given:
        warnings.simplefilter("always")
        wind = frozen.FrozenTurbulence(
            frozen.MeanWind(9.0), box, periodic=outside != "refused", repeated=outside == "repeated"
        )
    texts = [str(each.message) for each in given]
    assert texts == list(wind.doubts())
    assert [("box.bts says that it is not periodic" in each, "every 27 m, or 3 s" in each) for each in texts] == [
        (True, True)
    ] * said


def test_a_box_that_is_not_periodic_ends(tmp_path):
    """Six planes, 0.5 s and 4.5 m apart: its last plane arrives after 2.5 s; across the wind it goes on as any."""
    box = boxes.open_box(turbsim(tmp_path / "box.bts", some_numbers(), kind=7))
    wind, beside = frozen.FrozenTurbulence(frozen.MeanWind(9.0), box), np.array(((0.0, 500.0, 30.0),))
    repeated = frozen.FrozenTurbulence(frozen.MeanWind(9.0), box._replace(has_seam=False))
    for time in (0.0, 1.3, 2.5):
        assert wind.at(time, beside).tolist() == repeated.at(time, beside).tolist()
    for time, place in ((2.6, 0.0), (0.0, 1.0)):
        with pytest.raises(
            boxes.WrongBox, match=r"along the wind it is at .*; .*\. The file says that it is not periodic: .*3;"
        ):
            wind.at(time, np.array(((place, 0.0, 30.0),)))
