"""How hard do a parked kite and a kite on a circle pull at their tether in turbulent wind?

    python examples/wind/turbulence.py

The FMU `TurbulentWind` gives the wind at the kite and its mean along the tether, from a box of turbulence that the mean wind
carries past them; it gets the position of the kite and the shape of the tether. The same flights in the mean wind alone are
drawn beside.

    parked  `TetherDynamicFree` moves a soft kite (`PointMassKite`), which a law in this file steers to the zenith
    circle  `KiteOnPath` moves the end of `TetherDynamic` along a circle

The tether has one wind, the mean along it (its `wind_profile` is uniform): gusts that are short beside the tether, 300 m,
cancel in that mean. All FMUs step from the same communication point. Without `--box` the script makes a box
(`box_of_turbulence.py`), which is no model of the atmosphere.
"""

import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np

from tetherfmu.console.ending import command
from tetherfmu.console.options import Parser, file, number
from tetherfmu.console.progress import now
from tetherfmu.files.toml_files import WrongUse
from tetherfmu.wind.wind_boxes import WrongBox, open_box

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # the folder of the rooms
from fmus.turbulent_wind import POINTS
from shared.fmu_tools import add_fmu, all_variables, find_fmu
from shared.named_fmu import all_running
from wind.box_of_turbulence import write

STEP, SETTLING = 0.02, 20.0  # communication step; time after the start that is not counted [s]
DISTANCE, ELEVATION = 300.0, np.radians(68.0)  # of the parked kite at the start [m], [rad]
MEAN = {"mean_speed": 8.0, "wind_reference_height": 10.0, "wind_exponent": 0.14, "wind_points": 2}
START = DISTANCE * np.array((np.cos(ELEVATION), 0.0, np.sin(ELEVATION)))
PARKED = {"initial_length": 0.999 * DISTANCE, "initial_kite_position": START, "kite_mass": 19.6}
CIRCLE = {"distance": DISTANCE, "elevation": np.radians(30.0), "azimuth": 0.0, "half_width": np.radians(15.0), "rate": 0.3}
TAUT = {"initial_length": 0.997 * DISTANCE, "initial_shape": 2}  # on the circle; turning with the kite from the start
# c1 of the kite [rad/m]; of the steering: [1/s], heading over angle aside [-]
TURNING, QUICKNESS, INWARDS = 0.0613, 1.5, 2.0


class Flight(NamedTuple):
    """A flight, SI units: one row per communication point."""

    time: np.ndarray  # (rows,)
    kite_wind: np.ndarray  # (rows, 3)
    wind_velocity: np.ndarray  # (rows, 3), mean along the tether
    ground_tension: np.ndarray  # (rows,)


def upwards(kite, position):
    """Steering to the zenith: a turn rate towards a heading back above the ground station's downwind side."""
    wanted = INWARDS * np.arctan2(position[1], np.hypot(position[0], position[2]))
    rate = QUICKNESS * (wanted - kite.get("heading"))
    return float(np.clip(rate / (TURNING * max(kite.get("apparent_wind_speed"), 3.0)), -1.0, 1.0))


def row(wind, tether):
    """Numbers of a `Flight` at a communication point."""
    return [*wind.get("kite_wind"), *wind.get("wind_velocity"), tether.get("ground_tension")]


def air(wind, tether, position):
    """Give the wind FMU its points, where the tether is now."""
    wind.set(kite_position=position, shape=tether.get("shape"))


def fly(kind, tether_file, box, count):
    """A `Flight` of so many steps; kind : of `KINDS`. box : values of TurbulentWind, none for the mean wind alone."""
    names = ("TurbulentWind", KINDS[kind].partner)
    with all_running([find_fmu(name) for name in names] + [tether_file]) as (fmus, stop_if_pressed):
        wind, partner, tether = fmus
        KINDS[kind].start(wind, partner, tether, MEAN | box)
        rows = [row(wind, tether)]
        for k in range(count):
            KINDS[kind].exchange(wind, partner, tether)
            for each in fmus:
                each.step(k * STEP, STEP)
            rows.append(row(wind, tether))
            stop_if_pressed()
    found = np.array(rows)
    return Flight(STEP * np.arange(count + 1), found[:, :3], found[:, 3:6], found[:, 6])


def start_parked(wind, kite, tether, air_values):
    """Initialize: wind where the kite is, its load there, the tether under both."""
    wind.start({"kite_position": START, "shape": np.linspace((0.0, 0.0, 0.0), START, POINTS)}, **air_values)
    kite.start({"kite_position": START, "kite_velocity": np.zeros(3), "wind_velocity": wind.get("kite_wind")})
    tether.start({"kite_load": kite.get("kite_load"), "wind_velocity": wind.get("wind_velocity")}, **PARKED)


def exchange_parked(wind, kite, tether):
    """All get what the others have at the start of the step."""
    position = tether.get("kite_position")
    tether.set(kite_load=kite.get("kite_load"), wind_velocity=wind.get("wind_velocity"))
    motion = {"kite_position": position, "kite_velocity": tether.get("kite_velocity")}
    kite.set(**motion, wind_velocity=wind.get("kite_wind"), steering=upwards(kite, position))
    air(wind, tether, position)


def start_circle(wind, path, tether, air_values):
    """Initialize: the kite where its path begins, the wind there, the tether in it."""
    path.start({}, **CIRCLE)
    position = path.get("kite_position")
    wind.start({"kite_position": position, "shape": np.linspace((0.0, 0.0, 0.0), position, POINTS)}, **air_values)
    motion = {"kite_position": position, "kite_velocity": path.get("kite_velocity")}
    tether.start({**motion, "wind_velocity": wind.get("wind_velocity")}, **TAUT)


def exchange_circle(wind, path, tether):
    """The tether and the wind get where the kite is."""
    position = path.get("kite_position")
    tether.set(kite_position=position, kite_velocity=path.get("kite_velocity"), wind_velocity=wind.get("wind_velocity"))
    air(wind, tether, position)


class Kind(NamedTuple):
    """How a system flies: FMU beside wind and tether, functions that start it and exchange its values, FMU of the tether."""

    partner: str
    start: object
    exchange: object
    tether: str


KINDS = {
    "parked kite": Kind("PointMassKite", start_parked, exchange_parked, "TetherDynamicFree"),
    "circle": Kind("KiteOnPath", start_circle, exchange_circle, "TetherDynamic"),
}


def summary(name, flight):
    """One line: wind at the kite and along the tether, force at the ground, after the start has settled."""
    counted = flight.time >= min(SETTLING, 0.5 * flight.time[-1])
    at_kite, along = (np.linalg.norm(each[counted], axis=1) for each in (flight.kite_wind, flight.wind_velocity))
    force = flight.ground_tension[counted]
    return (
        f"{name}: wind at the kite {at_kite.mean():.1f} +- {at_kite.std():.1f} m/s, along the tether {along.mean():.1f} +- "
        f"{along.std():.1f} m/s; the ground feels {force.mean():.0f} +- {force.std():.0f} N, at most {force.max():.0f} N"
    )


def draw(flights, target):
    """Draw wind and force over time, a column for each kind; flights : dict of kinds to turbulent and mean one."""
    from shared.flight_figures import plt
    from tetherfmu.console.colours import BLUE, GREY, VERMILLION

    size = (5.5 * len(flights), 6.0)
    figure, axes = plt.subplots(2, len(flights), figsize=size, sharex=True, squeeze=False, layout="constrained")
    dashed = {"color": GREY, "linestyle": "--", "linewidth": 1.0, "label": "mean wind alone"}
    for (of_wind, of_force), (kind, (turbulent, calm)) in zip(axes.T, flights.items(), strict=True):
        for vectors, colour, label in (
            (turbulent.kite_wind, VERMILLION, "at the kite"),
            (turbulent.wind_velocity, BLUE, "mean along the tether"),
        ):
            of_wind.plot(turbulent.time, np.linalg.norm(vectors, axis=1), color=colour, label=label)
        of_wind.plot(calm.time, np.linalg.norm(calm.kite_wind, axis=1), **dashed | {"label": "at the kite, mean wind alone"})
        of_force.plot(turbulent.time, 1e-3 * turbulent.ground_tension, color=BLUE, label="turbulent wind")
        of_force.plot(calm.time, 1e-3 * calm.ground_tension, **dashed)
        of_wind.set(title=kind, ylabel="wind speed [m/s]")
        of_force.set(ylabel="tension at the ground [kN]", xlabel="time [s]")
    for each in axes.flat:
        low, high = each.get_ylim()
        each.set_ylim(low, high + 0.25 * (high - low))  # room for the legend
        each.grid(alpha=0.4)
        each.legend(loc="upper left", fontsize=8, ncols=2)
    figure.savefig(target, dpi=150)


def box_values(given, temporary):
    """Values of TurbulentWind for the box of the options; WrongUse if it is wrong; one is made if there is none.

    temporary : folder for it.
    """
    if given.box:
        points, spacing = given.points or (0, 0, 0), given.spacing or (0.0, 0.0, 0.0)
        try:
            open_box(given.box, points, spacing)
        except WrongBox as problem:
            raise WrongUse(f"{problem}") from None
        axes = ("along", "across", "upwards")
        values = {f"points_{axis}": value for axis, value in zip(axes, points, strict=True)}
        values |= {f"spacing_{axis}": value for axis, value in zip(axes, spacing, strict=True)}
        return {"file": str(given.box), **values}
    now("making a box of turbulence")
    target = Path(temporary, "box.npz")
    write(target, given.intensity * MEAN["mean_speed"])
    return {"file": str(target)}


def parse(arguments):
    """Command line options."""
    parser = Parser(description="fly a parked kite and a circle in turbulent wind")
    option = parser.add_argument
    option("--box", type=file, metavar="FILE", help="box of turbulence: .bts, u.bin, u.turb or .npz (default: one is made)")
    option(
        "--points",
        type=number(2, 1e7, whole=True),
        nargs=3,
        metavar="N",
        help="points of a Mann box along, across, upwards",
    )
    option("--spacing", type=number(1e-6, 1e5, "m"), nargs=3, metavar="D", help="distances of the points of a Mann box [m]")
    about = "intensity of a box that is made (default: 0.15)"
    option("--intensity", type=number(0.0, 1.0), default=0.15, metavar="I", help=about)
    about = "duration of a flight [s] (default: 120)"
    option("--duration", type=number(STEP, 1e5, "s"), default=120.0, metavar="T", help=about)
    parser.add_out()
    add_fmu(parser)
    return parser.parse_args(arguments)


@command
def main(arguments=None):
    """Fly in turbulence and in the mean wind, print what the wind and the force are, draw them."""
    given = parse(arguments)
    given.out.mkdir(parents=True, exist_ok=True)
    kinds = {kind: find_fmu(KINDS[kind].tether) for kind in KINDS} if not given.fmu else kind_of(given.fmu)
    flights, count = {}, round(given.duration / STEP)
    with TemporaryDirectory(ignore_cleanup_errors=True) as temporary:
        box = box_values(given, temporary)
        for kind, tether in kinds.items():
            now(f"flying the {kind}")
            flights[kind] = [fly(kind, tether, each, count) for each in (box, {})]
            for name, flight in zip((kind, f"{kind}, mean wind alone"), flights[kind], strict=True):
                print(summary(name, flight))
    target = given.out / "turbulence.png"
    draw(flights, target)
    print(target)


def kind_of(tether):
    """The flight that a tether FMU can do: dict of its kind to the FMU; WrongUse if it has other points than the wind."""
    variables = all_variables(tether)
    if len(variables.of("shape")) != 3 * POINTS:
        raise WrongUse(f"{tether} has another number of points in shape; build it with --shape-points {POINTS}")
    return {"parked kite" if "kite_load[1]" in variables.reference else "circle": tether}


if __name__ == "__main__":
    sys.exit(main())
