"""Boxes of wind on a grid in space, read from files: TurbSim (`.bts`), Mann and HAWC2 (`u.bin v.bin w.bin`), numpy (`.npz`).

A box is memory-mapped and never read as a whole: a file of many gigabytes opens immediately, and only the requested
parts are read. The file must not change while it is open.

Axes of a box: along the mean wind (downwind), across it (to the left when looking downwind), up. The velocities use
these axes, too. Along the wind, 0 is at the front of the box, the plane that arrives first; across, it is in the middle.

    TurbSim  planes in order of arrival, dt apart, so U dt apart along the wind, U the mean wind at the hub;
             height of the lowest row from the file; contains the mean wind
    Mann     planes in spatial order, downwind: the last one is the front; the lowest row is at height 0
    numpy    as Mann

Sources: TurbSim User's Guide v2.00 (B. Jonkman, NREL 2014), appendix on the binary full-field format; manual of HAWC2 (DTU),
`mann`: float32, the vertical index changes fastest, then the lateral, then the longitudinal one.
"""

import math
import os
import re
import stat
import struct
import zipfile
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

HEADER = struct.Struct("<h4i12fi")  # of a TurbSim file, up to its description
PERIODIC, NOT_PERIODIC = 8, 7  # first number of a TurbSim file
AXES = ("along", "across", "upwards")
LARGEST_FILE = 2**42  # bytes, 4 TiB
MOST_POINTS = 10_000_000  # of a box along an axis
LARGEST_SPACING = 1e5  # of the points of a box [m], and of its planes in time [s]
LONGEST_DESCRIPTION = 10_000  # bytes in a TurbSim file
LARGEST_SPEED = 150.0  # of any wind in a box [m/s]; more is no wind
LOCAL_HEADER = struct.Struct("<26xHH")  # of a member of a zip archive: lengths of its name and of the extra field


class WrongBox(ValueError):
    """An invalid wind box, or a wind that a box cannot provide: a sentence with the name of the file."""


class Box(NamedTuple):
    """Wind on a grid. Point (i, j, k), along, across and up, is number i strides[0] + j strides[1] + k strides[2]."""

    file: str
    components: tuple  # stored numbers of the velocities along, across and up: three flat arrays
    strides: tuple  # (3,)
    points: tuple  # how many, (3,)
    first: tuple  # where point (0, 0, 0) is, along, across and up (3,) [m]
    spacing: tuple  # from a point to the next (3,) [m]; negative along the wind where the planes are in order of arrival
    offset: tuple = (0.0, 0.0, 0.0)  # velocity [m/s] = (stored number - offset)/scale
    scale: tuple = (1.0, 1.0, 1.0)
    mean: tuple | None = None  # mean wind [m/s] in the box, and its height [m]; None: fluctuations only
    has_seam: bool = False  # whether the file declares a wind jump between repetitions


def open_box(file: str | os.PathLike, points: Sequence[int] = (0, 0, 0), spacing: Sequence[float] = (0.0, 0.0, 0.0)) -> Box:
    """Open the `Box` in a file; the end of its name selects the format. WrongBox gives the problem.

    points, spacing : numbers of points along, across and up, and distances [m], which the file of a Mann box lacks.

    >>> import numpy as np, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     np.savez(f"{folder}/still.npz", velocity=np.zeros((16, 8, 8, 3)), spacing=(5.0, 5.0, 5.0))
    ...     open_box(f"{folder}/still.npz").points
    (16, 8, 8)
    """
    name = str(file)
    try:
        if name.lower().endswith(".bts"):
            return turbsim_box(name)
        if name.lower().endswith(".npz"):
            return numpy_box(name)
        if re.search(r"u\.(bin|turb)$", name, re.IGNORECASE):
            return mann_box(name, points, spacing)
    except OSError as problem:  # permissions, a file that vanishes
        raise WrongBox(f"{name!r} cannot be read: {problem.strerror or problem}") from None
    allowed = "it must end in .bts (TurbSim), in .npz (numpy), or in u.bin or u.turb (Mann, with v and w beside it)"
    raise WrongBox(f"{name!r} is not the name of a wind box: {allowed}")


def turbsim_box(file):
    """The `Box` in a TurbSim file; WrongBox describes a problem."""
    size = size_of(file)
    if size < HEADER.size:
        raise WrongBox(f"{file} is not a TurbSim file: it has {size} bytes; the header alone must have {HEADER.size}")
    with open(file, "rb") as opened:
        header = HEADER.unpack(opened.read(HEADER.size))
    kind, nz, ny, towers, nt, dz, dy, dt, speed, hub, bottom, *scaling, described = header
    if kind not in (PERIODIC, NOT_PERIODIC):
        allowed = f"it must begin with {NOT_PERIODIC}, or with {PERIODIC} for a periodic box"
        raise WrongBox(f"{file} is not a TurbSim file with a full field: it begins with {kind}; {allowed}")
    check_grid(file, (nt, ny, nz))
    check_number(file, "number of tower points", towers, 0, MOST_POINTS)
    check_number(file, "length of the description", described, 0, LONGEST_DESCRIPTION)
    for what, value in (("time step", dt), ("spacing across", dy), ("spacing upwards", dz)):
        check_number(file, what, value, 1e-6, LARGEST_SPACING)
    check_number(file, "mean wind at the hub", speed, 0.01, LARGEST_SPEED)
    check_number(file, "height of the hub", hub, 0.01, LARGEST_SPACING)
    check_number(file, "height of the lowest row", bottom, -LARGEST_SPACING, LARGEST_SPACING)
    scale, offset = scaling[::2], scaling[1::2]
    for name, slope, zero in zip("uvw", scale, offset, strict=True):
        check_number(file, f"slope of {name}", abs(slope), 1e-6, 1e12)
        check_number(file, f"intercept of {name}", zero, -1e12, 1e12)
    plane = 3 * (ny * nz + towers)  # numbers; the components of a point are neighbours
    check_size(file, size, HEADER.size + described + 2 * nt * plane)
    numbers = mapped(file, "<i2", HEADER.size + described, nt * plane)
    components, strides = tuple(numbers[component:] for component in range(3)), (plane, 3, 3 * ny)
    first, spacing = (0.0, -0.5 * (ny - 1) * dy, bottom), (-speed * dt, dy, dz)
    stored = {"offset": tuple(offset), "scale": tuple(scale), "mean": (speed, hub), "has_seam": kind == NOT_PERIODIC}
    return Box(file, components, strides, (nt, ny, nz), first, spacing, **stored)


def mann_box(file, points, spacing):
    """The `Box` in three files of 32-bit numbers, from the Mann generators of HAWC2; WrongBox describes a problem.

    file : of u; its name without the ending ends in u, the others in v and w.  points, spacing [m] : along,
    across and up.
    """
    if not any(points):
        missing = "how many points it has, along, across and upwards, nor their spacing"
        raise WrongBox(f"{file} does not say {missing}; give both")
    check_grid(file, points, spacing)
    stem, _, ending = file.rpartition(".")
    names = [f"{stem[:-1]}{letter.upper() if stem[-1] == 'U' else letter}.{ending}" for letter in "uvw"]
    count = math.prod(points)
    for name in names:
        check_size(name, size_of(name), 4 * count)
    components = [mapped(name, "<f4", 0, count) for name in names]
    return of_space(file, components, (points[1] * points[2], points[2], 1), points, spacing)


def numpy_box(file):
    """The `Box` in a file of `numpy.savez`; WrongBox describes a problem.

    Its arrays, of 32 or 64-bit numbers: `velocity` (along, across, up, 3) [m/s], fluctuations in spatial order,
    downwind; `spacing` (3,) [m].
    """
    size = size_of(file)
    try:
        with zipfile.ZipFile(file) as archive:
            velocity, spacing = (member(archive, f"{name}.npy", file, size) for name in ("velocity", "spacing"))
    except WrongBox:
        raise
    except Exception as problem:  # zipfile and numpy raise some ten kinds; one that escapes would end the host of an FMU
        words = " ".join(str(problem).split()).strip("'\". ")
        raise WrongBox(f"{file} is not a numpy.savez file with the arrays velocity and spacing: {words}") from None
    if velocity.ndim != 4 or velocity.shape[3] != 3 or spacing.shape != (3,):
        shapes = f"velocity is {velocity.shape} and spacing {spacing.shape}"
        raise WrongBox(f"{file}: {shapes}; they must be (points along, across, up, 3) and (3,)")
    points, spacing = velocity.shape[:3], spacing.tolist()
    check_grid(file, points, spacing)
    *strides, of_component = (each // velocity.itemsize for each in velocity.strides)
    numbers = velocity.ravel(order="K")  # a view: the memory in its order
    components = [numbers[component * of_component :] for component in range(3)]
    return of_space(file, components, strides, points, spacing)


def of_space(file, components, strides, points, spacing):
    """`Box` with planes in spatial order: the last one is at 0 along the wind."""
    first = (-(points[0] - 1) * spacing[0], -0.5 * (points[1] - 1) * spacing[1], 0.0)
    return Box(file, tuple(components), tuple(strides), tuple(points), first, tuple(spacing))


def member(archive, name, file, size):
    """An array in an open archive of `numpy.savez` with this file size in bytes, memory-mapped."""
    found = archive.getinfo(name)
    if found.compress_type != zipfile.ZIP_STORED:
        raise WrongBox(f"{file} is compressed and cannot be mapped into memory; write it with numpy.savez")
    with open(file, "rb") as opened:
        opened.seek(found.header_offset)
        begin = found.header_offset + LOCAL_HEADER.size + sum(LOCAL_HEADER.unpack(opened.read(LOCAL_HEADER.size)))
        opened.seek(begin)
        version = np.lib.format.read_magic(opened)
        if version != (1, 0):
            raise WrongBox(f"{file}: {name} has version {version} of the format of numpy; it must be (1, 0)")
        shape, by_columns, kind = np.lib.format.read_array_header_1_0(opened)
        first = opened.tell()
    if kind.kind != "f" or kind.itemsize not in (4, 8):
        raise WrongBox(f"{file}: {name} has numbers of the kind {kind}; it must be float32 or float64")
    count = math.prod(shape)
    if count < 1 or first - begin + count * kind.itemsize != found.file_size or begin + found.file_size > size:
        raise WrongBox(f"{file} is damaged: {name} has {found.file_size} bytes, which are not those of {shape} numbers")
    return mapped(file, kind, first, count).reshape(shape, order="F" if by_columns else "C")


def size_of(file):
    """Bytes of a file; WrongBox if there is none, or if it is not a regular file (a folder, a device, a pipe)."""
    try:
        found = os.stat(file)
    except (OSError, ValueError) as problem:
        raise WrongBox(f"{file!r} cannot be opened: {getattr(problem, 'strerror', None) or problem}") from None
    if not stat.S_ISREG(found.st_mode):
        raise WrongBox(f"{file!r} is not a regular file; a wind box must be one")
    if found.st_size > LARGEST_FILE:
        raise WrongBox(f"{file} has {found.st_size} bytes; a wind box must have at most {LARGEST_FILE}")
    return found.st_size


def check_grid(file, points, spacing=()):
    """WrongBox unless the numbers of points along, across and up are valid, and their spacing [m], if given."""
    for axis, count in zip(AXES, points, strict=True):
        check_number(file, f"number of points {axis}", count, 2, MOST_POINTS)
    for axis, distance in zip(AXES, spacing, strict=len(spacing) > 0):
        check_number(file, f"spacing {axis}", distance, 1e-6, LARGEST_SPACING)


def check_number(file, what, value, least, most):
    """WrongBox unless a number of a box is within its range."""
    if not least <= value <= most:  # also if it is no number
        raise WrongBox(f"{file}: the {what} is {value:g}; it must be at least {least:g} and at most {most:g}")


def check_size(file, size, expected):
    """WrongBox unless a file has as many bytes as its grid needs."""
    if size != expected:
        state = "is cut off" if size < expected else "is too long"
        raise WrongBox(f"{file} {state}, or its grid is another one: it has {size} bytes; its grid needs {expected}")


def mapped(file, kind, offset, count):
    """Flat array of a part of a file, mapped into memory."""
    try:
        return np.asarray(np.memmap(file, np.dtype(kind), mode="r", offset=offset, shape=(count,)))
    except (OSError, ValueError, OverflowError) as problem:
        raise WrongBox(f"{file} cannot be mapped into memory: {problem}") from None
