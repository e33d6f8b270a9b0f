"""PythonFMU slave: turbulent wind at the points of a tether and at its kite, from a file with a box of wind.

    v(x, t) = U (z/h)^alpha e + fluctuations of the box, which the mean wind U e carries past the points

`file` (String, a parameter): what TurbSim (`.bts`), a Mann generator or HAWC2 (`u.bin`, with `v.bin` and `w.bin` beside it)
or `numpy.savez` (`.npz`: velocity (along, across, up, 3) [m/s], spacing (3,) [m]) has written; the end of its name says
which. A relative path begins in the working folder of the importer; one that begins with `resources/` leads into the FMU,
which can be built with a box inside. Empty: no turbulence, the mean wind alone. A box of TurbSim contains its mean wind: its
hub speed and hub height replace `mean_speed` and `wind_reference_height`.

The points are those of the input `shape` (connect it with that output of a tether that is built with `--wind-points`), or
lie on the straight line from the ground station, the origin, to the kite. `wind_velocity` is their mean (trapezoidal rule
along the tether): connect it with that input of a tether whose `wind_profile` is uniform, and `kite_wind` with
`wind_velocity` of the kite.

It needs numpy in the Python of the importer. The file is mapped into memory, not read: it must not change during a run.
"""

from dataclasses import dataclass
from math import pi

import numpy as np

from tetherfmu.runtime.quantities import DEGREES, Quantity, check, quantity
from tetherfmu.wind.frozen_turbulence import MeanWind, Reading, turbulence
from tetherfmu.wind.wind_boxes import WrongBox
from tetherfmu.wiring.variables import INPUT, OUTPUT, PARAMETER, Variable

from .file_slave import FileSlave
from .model_slave import Refused, names, scalar, vector

POINTS = 21  # of the tether
ON_LINE, OF_SHAPE = 1, 2  # `wind_points`
FRONT, FARTHEST = "where the front of the box has its middle at the start, at its height 0", 1e6  # [m]
WEIGHTS = np.array([0.5, *[1.0] * (POINTS - 2), 0.5]) / (POINTS - 1)
KITE = (300.0, 0.0, 400.0)


@dataclass(frozen=True)
class Blowing:
    """The mean wind, and where it is wanted."""

    mean_speed: float = quantity(8.0, "m/s", "mean wind U at wind_reference_height (of a TurbSim file: its own)", 0.0, 100.0)
    wind_direction: float = quantity(
        0.0, "rad", "direction in which the mean wind blows: 0 along x, pi/2 along y", -2.0 * pi, 2.0 * pi, display=DEGREES
    )
    wind_reference_height: float = quantity(
        6.0, "m", "height h of mean_speed (of a TurbSim file: that of its hub)", 1e-3, 1e5
    )
    wind_exponent: float = quantity(
        0.08163, "", "exponent alpha of the mean wind, 0: uniform (of a TurbSim file: only beyond its heights)", 0.0, 2.0
    )
    wind_points: int = quantity(
        ON_LINE,
        "",
        "where the points are",
        choices={"line": "on the line from the origin to the kite", "shape": "those of the input shape"},
    )

    def __post_init__(self):
        check(self)


def at_points(causality, name, unit, what, starts=None, depends_on=lambda k: ()):
    """A list of the variables NAME[k,1..3] at all points.

    what : they mean.  starts : array (POINTS, 3).  depends_on : function of k, names.
    """
    return [
        Variable(
            f"{name}[{k},{i}]",
            causality,
            "Real",
            Quantity(unit, f"point {k} of {POINTS} {what}, {axis}"),
            0,
            None if starts is None else float(starts[k - 1, i - 1]),
            depends_on(k),
        )
        for k in range(1, POINTS + 1)
        for i, axis in enumerate("xyz", start=1)
    ]


POSITION = vector(INPUT, "kite_position", "m", "position of the kite", KITE)
SHAPE = at_points(INPUT, "shape", "m", "on the tether, ground first", np.linspace((0.0, 0.0, 0.0), KITE, POINTS))
ORIGIN = [
    each
    for i, axis in enumerate("xyz", start=1)
    for each in scalar(PARAMETER, f"box_origin[{i}]", "m", f"{FRONT}, {axis}", -FARTHEST, FARTHEST, start=0.0)
]
READ = (*Blowing.__dataclass_fields__, *Reading.__dataclass_fields__)
FIELD = (*(name for name in READ if name not in ("wind_points", "outside")), *names(ORIGIN))
TETHER = (*names(POSITION), "wind_points", *FIELD)  # what the wind at any point of the tether depends on


class TurbulentWind(FileSlave):
    """Wind at the points of a tether and at its kite."""

    description = (
        "Turbulent wind from a file of TurbSim, of a Mann generator or of numpy, carried by the mean wind. "
        "In: position of the kite, points of the tether. Out: wind at the kite, at the points, and the mean of these."
    )
    about_file = "box of turbulence: .bts (TurbSim), u.bin or u.turb (Mann, v and w beside it), .npz (numpy); empty: none"
    inputs = (POSITION, SHAPE)
    outputs = (
        vector(OUTPUT, "wind_velocity", "m/s", "mean wind along the tether", depends_on=(*TETHER, *names(SHAPE))),
        vector(OUTPUT, "kite_wind", "m/s", "wind at the kite", depends_on=(*names(POSITION), *FIELD)),
        at_points(
            OUTPUT,
            "wind_at",
            "m/s",
            "on the tether: wind there",
            depends_on=lambda k: (*TETHER, *names(SHAPE[3 * k - 3 : 3 * k])),
        ),
    )
    records = (Blowing, Reading)
    vectors = (ORIGIN,)
    memory = 1  # time since the start

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
        self._opened, self._wind = None, None  # what the file was opened with, and its wind

    def first(self, inputs):
        """Wind at the start; the file is opened anew."""
        self._opened = None
        return self._at(0.0, inputs)

    def next(self, begin, end, step, outputs, memory):
        """Wind at the end of the step, where the points are then."""
        return self._at(memory[0] + step, end)

    def _at(self, time, inputs):
        points = np.reshape(inputs, (-1, 3))  # the kite, and the shape
        if self.parameters.wind_points == ON_LINE:
            points[1:] = np.linspace((0.0, 0.0, 0.0), points[0], POINTS)
        try:
            wind = self._field().at(time, points)
        except WrongBox as problem:
            raise Refused(str(problem)) from None
        return (*(WEIGHTS @ wind[1:]).tolist(), *wind.ravel().tolist()), (time,)

    def _field(self):
        """`FrozenTurbulence` of the file and the parameters; another state may have brought others."""
        known = self.parameters
        key = (self.file, *vars(known).values())
        if key != self._opened:
            mean = MeanWind(known.mean_speed, known.wind_direction, known.wind_reference_height, known.wind_exponent)
            origin = [getattr(known, name) for name in names(ORIGIN)]
            self._wind = turbulence(self.path() if self.file else None, known, mean, origin)
            for doubt in self._wind.doubts():
                self.warn(doubt)
            self._opened = key
        return self._wind
