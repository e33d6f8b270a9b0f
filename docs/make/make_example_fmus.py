"""Write the pages of the example FMUs and of their variables from the sources: `python docs/make/make_example_fmus.py`."""

import sys
from pathlib import Path

from make_variables import limits, table
from tetherfmu.export import documents
from tetherfmu.export.documents import folded, meaning
from tetherfmu.libraries.examples import example
from tetherfmu.wiring.variables import INPUT, OUTPUT, PARAMETER, variables

example_fmus = example("shared.example_fmus")


def start(each):
    """Start value of a variable or of a vector of them; angles in degrees, too."""
    display = each[0].quantity.display
    return f"{each[0].start:.6g} ({display[1] * each[0].start:.3g} {display[0]})" if display else documents.start(each)


DOCS = Path(__file__).resolve().parents[1]
PAGE, TABLES = DOCS / "use" / "example_fmus.md", DOCS / "reference" / "variables_of_examples.md"
HEAD = ("name", "unit", "start", "allowed", "meaning")
ROLES = {INPUT: "in", OUTPUT: "out", PARAMETER: "parameter"}
OF_TETHERS = {each.quantity for each in variables("dynamic", 0) if each.causality == PARAMETER}
KITES = ["PointMassKite", "FlyingKite"]
WITHOUT_EQUATIONS = ("TurbulentWind",)  # whose section above the tables has them
TEXT = """# Example FMUs

<!-- Written by docs/make/make_example_fmus.py from the sources: edit those, and run it again. -->

For those who need partners for a tether. `tetherfmu build --examples` builds them and five systems of them as SSP
files. They are PythonFMU slaves (`examples/fmus/`; [equations and variables](../reference/variables_of_examples.md));
`TurbulentWind` needs numpy.

| FMU | in | out | for |
|---|---|---|---|
| `PointMassKite` | motion of the kite, wind, steering, depower | `kite_load` | `TetherDynamicFree`, which has the mass |
| `FlyingKite` | `kite_force`, wind, steering, depower | motion of the kite | tethers with a driven kite end |
| `Winch` | `ground_tension`, `tether_length`, set point | `reel_out_speed` | every tether |
| `WinchMotor` | `ground_tension`, `winch_speed`, `kite_position`, depower | `winch_force` | tethers with the drum inside |
| `FlightController` | motion of the kite, tension, length | steering, depower, `set_speed` | both kites, the winch |
| `KiteOnPath` | | motion of the kite | tethers with a driven kite end |
| `TurbulentWind` | position of the kite, `shape` | `wind_velocity`, `kite_wind`, `wind_at` | tethers and kites |

Connect variables with the same name. Set everything else (wind, profile, air density) to the same value in every FMU. The
ground station is the origin. Prefer `PointMassKite`: `FlyingKite` receives the force one communication step late, which
limits the step to some milliseconds ([Coupling](coupling.md)). Set `input_continuation` to `linear` (1) if all FMUs step
from the same communication point, to `interpolated` (3) if your tool steps one FMU after the other.

## A kite power system

`python examples/power_system/pumping_cycle.py` couples `TetherDynamicFree`, `PointMassKite`, `FlightController` and
`Winch`:

![Force, reel-out speed, power and length over three traction phases](../figures/pumping_series.svg)

![Path of the kite in space, coloured by force](../figures/pumping_path.svg)

Two cycles (`--cycles 2`) in a wind of 8 m/s at 10 m, by default 20 ms and 10 segments:

| options | mean power [W] | mean force [N] | peak force [N] |
|---|---|---|---|
| `--master jacobi` | 4038 | 1808 | 3530 |
| `--master gauss_seidel` | 4037 | 1808 | 3535 |
| `--master jacobi --step 0.001` | 4032 | 1805 | 3526 |
| `--segments 30` | 4036 | 1807 | 3529 |
| `--segments 1` | 4165 | 1817 | 3692 |

The kite load is delayed, which limits the step ([Coupling](coupling.md#the-ways)): with the Jacobi exchange to 30 ms at
8 m/s (35 ms diverge), and to 20 ms at 10 to 14 m/s (30 ms diverge). The example works in 6 to 14 m/s; from 11 m/s on
the motor is sometimes too weak. The work over a cycle balances within 1 % (`tests/physics/test_pumping_energy.py`).

## The winch inside the tether

`python examples/power_system/winch_inside.py` compares the `Winch` FMU with a drum inside the tether (`winch_control` =
force) and `WinchMotor`. Mean power over a cycle in 8 m/s [W]:

| exchange | winch | 20 ms | 100 ms | 200 ms |
|---|---|---|---|---|
| `pumping_cycle.py`, either master | FMU | 4037 | diverges after 0.5 s | diverges after 0.6 s |
| tether and kite iterate | FMU | 4038 | 4035 | 3549 |
| tether and kite iterate | inside the tether | 4036 | 4027 | 4008 |
| `winch_inside.ssp` in libcosim | inside the tether | 4036 | diverges | diverges |
| its `OspSystemStructure.xml`: tether and kite always 20 ms | inside the tether | 4036 | 4035 | 4037 |

![Reel-out speed over a cycle in three steps: the winch FMU swings in 200 ms](../figures/winch_inside.svg)

The delayed kite load makes steps of 100 ms diverge, unless tether and kite iterate. The delayed tension saturates the
motor of the `Winch` FMU at 200 ms; a drum inside the tether avoids this delay. Set `shortest_length` and
`longest_length` of the tether to 0: `FlightController` has the limits.

## Turbulent wind

`TurbulentWind` carries a turbulence box past kite and tether at the mean wind U e (height z, reference height h):

    v(x, t) = U (z/h)^alpha e + fluctuations of the box

| `file` ends in | written by | what it is |
|---|---|---|
| `.bts` | TurbSim | contains its mean wind, which replaces `mean_speed` and `wind_reference_height` |
| `u.bin`, `u.turb` | Mann generators, HAWC2, hipersim | 32-bit numbers, v and w in files beside it; set its grid |
| `.npz` | `numpy.savez` (not `savez_compressed`) | `velocity` (along, across, up, 3) [m/s] and `spacing` (3,) [m] |

Set the String parameter `file` before the initialization, or build the FMU with it (`build("TurbulentWind", folder,
[("file", path)])` of `examples/shared/example_fmus.py`). A path that begins with `resources/` is inside the FMU. The
default is the mean wind alone.

- **Wiring.** Connect `kite_position`, and `shape` and `wind_at` of a tether built with `--wind-points 21` (set
  `wind_points` to 2). Without `shape` the points are on the straight line from the origin to the kite. `wind_velocity`
  is the mean along the tether, for tethers with `wind_profile` = uniform. `kite_wind` is for kites with a uniform
  profile.
- **Axes.** x of the box is downwind, y to the left when looking downwind; `wind_direction` is where the wind blows *to*.
  `box_origin` is the middle of its front at the start. The lowest row is at the height of the TurbSim file, otherwise 0,
  plus `box_origin[3]`.
- **Order of planes.** In Mann and numpy files the last plane is the front, in TurbSim files the first. A reversed order
  plays the turbulence backwards; spectra do not reveal it. PyConTurb 2.7.4 writes the points of a `.bts` plane upwards
  first, TurbSim and this reader across first.
- **Outside the box.** `outside` = periodic (1) repeats the box in all directions, but refuses the step beyond the end of
  a TurbSim file that is not periodic (`UsableTime` = "ALL" makes it so). repeated (3) repeats any file, with a warning.
  refused (2) refuses every step outside the box, also below TurbSim's grid.

`python examples/wind/turbulence.py` simulates a parked kite and a kite on a circle, in a box that it makes (15 % of 8 m/s
at 10 m; `--box FILE` reads yours):

![Wind at the kite and along the tether, and tension at the ground, over 120 s](../figures/turbulence.svg)

| flight | wind at the kite | along the tether | tension at the ground | peak |
|---|---|---|---|---|
| parked kite | 12.7 ± 0.9 m/s | 11.0 ± 0.3 m/s | 1065 ± 660 N | 2858 N |
| parked kite, mean wind alone | 12.8 ± 0.0 m/s | 11.0 ± 0.0 m/s | 1001 ± 1 N | 1006 N |
| circle | 11.7 ± 1.2 m/s | 10.1 ± 0.6 m/s | 2003 ± 118 N | 2209 N |
| circle, mean wind alone | 11.6 ± 0.6 m/s | 10.0 ± 0.5 m/s | 2005 ± 120 N | 2186 N |

Means and standard deviations are from 20 s on.

## A model of your own

Copy a class of `examples/fmus`, with its inputs, outputs and parameters and the methods `first` and `next`. Add its name to
`SLAVES` in `examples/shared/example_fmus.py`, or call `build` there.

## Systems as SSP files

`kite_power_system.ssp` and `winch_inside.ssp` are the systems above; `circular_flight.ssp` is `KiteOnPath` and
`TetherDynamic`. The tether has 10 segments and a `relative_tolerance` of 1e-4 in `SystemStructure.ssd`, 3 and 1e-3 in
`SystemStructure_coarse.ssd`, 30 and 1e-6 in `SystemStructure_fine.ssd`.

- libcosim (`CosimExecution.from_ssp_file`, on the extracted file) and Ecos (`EcosSimulation(ssp_path=...)`) agree with the
  example's Jacobi master to ten digits.
- fmu-manipulation-toolbox makes one FMU (`fmucontainer -container kite_power_system.ssp:0.02`), without the kite's first
  steering, which moves the path by centimetres.
- Do not use FMPy's `simulate_ssp`: it sets all connected inputs to 0 in the first step. Kites refuse it, circles start with
  a false tension of over 4e5 N.
- `extra/com.open-simulation-platform` is for `CosimExecution.from_osp_config_file`: each FMU may have its own step.
"""
VARIABLES = """# Variables of the example FMUs

<!-- Written by docs/make/make_example_fmus.py from the sources: edit those, and run it again. -->

For everyone who connects the [example FMUs](../use/example_fmus.md): their equations, variables and parameters.

## Several FMUs

Both kites have the [parameters of air and wind](variables.md#parameters) of the tethers, `FlyingKite` also `gravity`. These
variables have the same meaning in several FMUs:

{shared}"""


def declared():
    """Variables and vectors: maps (role, name, unit, start, allowed, meaning) to the FMUs that declare them so.

    Without the parameters of the tethers, which mean the same here.
    """
    found = {}
    for name in example_fmus.SLAVES:
        for causality, role in ROLES.items():
            listed = [variable for variable in example_fmus.table_of(name) if variable.causality == causality]
            for vector, each in folded(listed):
                if each[0].quantity in OF_TETHERS:
                    continue
                is_parameter = causality == PARAMETER
                begins = start(each) if each[0].start is not None else ""
                allowed = limits(each[0].quantity) if is_parameter else ""
                row = role, f"`{vector}`", each[0].quantity.unit, begins, allowed, meaning(each)
                found.setdefault(row, []).append(name)
    return found


def shared():
    """Table of the variables that several FMUs declare in the same way."""
    rows = [(name, in_short(fmus), role, *rest) for (role, name, *rest), fmus in declared().items() if len(fmus) > 1]
    return table(("name", "FMU", "role", *HEAD[1:]), sorted(rows, key=lambda row: list(ROLES.values()).index(row[2])))


def in_short(fmus):
    """Names of FMUs for a cell."""
    return "all" if len(fmus) == len(example_fmus.SLAVES) else "kites" if fmus == KITES else ", ".join(fmus)


def section(name):
    """Equations, sources and variables of an FMU; those of `shared` aside."""
    module = sys.modules[example_fmus.slave(name).__module__]
    equations = "" if name in WITHOUT_EQUATIONS else f"```text\n{module.__doc__.partition(': ')[2].strip()}\n```\n\n"
    own = [row for row, fmus in declared().items() if fmus == [name]]
    in_order = sorted(own, key=lambda row: list(ROLES.values()).index(row[0]))
    rows = [(vector, role, *rest) for role, vector, *rest in in_order]
    return f"## {name}\n\n{equations}{table(('name', 'role', *HEAD[1:]), rows)}"


def aerodynamics():
    """What both kites share."""
    text = sys.modules[example_fmus.slave("PointMassKite").__module__.replace("point_mass_kite", "aerodynamics")].__doc__
    return f"## Aerodynamics of both kites\n\n```text\n{text.strip()}\n```"


def pages():
    """Pairs (file, text) of both pages."""
    tables = [VARIABLES.format(shared=shared()), aerodynamics(), *map(section, example_fmus.SLAVES)]
    return (PAGE, TEXT), (TABLES, "\n\n".join(tables) + "\n")


if __name__ == "__main__":
    for file, text in pages():
        file.write_text(text, encoding="utf-8")
