"""Write docs/use/example_fmus.md from the sources of the example FMUs: `python docs/make/make_example_fmus.py`."""

import sys
from pathlib import Path

from make_variables import table
from tetherfmu.export import documents
from tetherfmu.export.documents import allowed, folded, meaning, unit
from tetherfmu.libraries.examples import example
from tetherfmu.runtime.variables import INPUT, OUTPUT, PARAMETER

example_fmus = example("shared.example_fmus")


def start(each):
    """Start value of a variable or of a vector of them; angles in degrees, too."""
    display = each[0].quantity.display
    return f"{each[0].start:.6g} ({display[1] * each[0].start:.3g} {display[0]})" if display else documents.start(each)


PAGE = Path(__file__).resolve().parents[1] / "use" / "example_fmus.md"
COLUMNS = {INPUT: (unit, start, meaning), OUTPUT: (unit, meaning), PARAMETER: (unit, start, allowed, meaning)}
TITLES = {INPUT: "Inputs", OUTPUT: "Outputs", PARAMETER: "Parameters"}
TEXT = """# Example FMUs

<!-- Written by docs/make/make_example_fmus.py from the sources: edit those, and run it again. -->

Partners for a tether: kites, a winch, a flight controller, a prescribed flight, turbulent wind. They are PythonFMU slaves of
70 to 150 lines (`examples/fmus/`), to fly at once and to put your own model into. They need what a tether FMU of PythonFMU
needs, and no kernels; `TurbulentWind` alone needs numpy as well.

```text
tetherfmu build --examples
```

builds them beside the tethers, and five systems of them as SSP files.

| FMU | in | out | for |
|---|---|---|---|
| `PointMassKite` | motion of the kite, wind, steering, depower | `kite_load` | `TetherDynamicFree`, which has the mass |
| `FlyingKite` | `kite_force`, wind, steering, depower | motion of the kite | tethers with a driven kite end |
| `Winch` | `ground_tension`, `tether_length`, set point | `reel_out_speed` | every tether |
| `WinchMotor` | `ground_tension`, `winch_speed`, `kite_position`, depower | `winch_force` | tethers with the drum inside |
| `FlightController` | motion of the kite, tension, length | steering, depower, `set_speed` | both kites, the winch |
| `KiteOnPath` | | motion of the kite | tethers with a driven kite end |
| `TurbulentWind` | position of the kite, `shape` | `wind_velocity`, `kite_wind`, `wind_at` | tethers and kites |

Wiring: variables of the same name belong together. What no FMU gives is set by name in each FMU that has it: the wind,
its profile, the air density. The ground station is the origin.

Both kites have the same aerodynamics. The one without mass is the better partner: the coupling of kite and tether is stiff,
and `TetherDynamicFree` solves it inside. `FlyingKite` gets the force one communication step late, which limits the
step to some milliseconds, unless it steps after the tether or the importer repeats steps ([Coupling](coupling.md)): its
state can be saved and restored bit for bit, as that of every example FMU.

## Exchange

Inputs belong to the start of a communication step, outputs to its end, as in the tethers. `input_continuation` says how
the inputs change within the step: `linear` (1), extrapolated from their last two values, is for importers in which all FMUs
step from the same communication point; `held` (2) keeps them constant; `interpolated` (3) is for importers that step one
FMU after the other and pass on outputs of the end of the step.

A step is refused (`fmi2Discard`) with a message if an input is not finite or out of its range, or if the step is not
positive; the state then does not change. The winch brakes, with a message, where the tether reaches its shortest or longest
length. It refuses the step if its torque is not enough to stop there.

## A kite power system

`python examples/power_system/pumping_cycle.py` flies `TetherDynamicFree`, `PointMassKite`, `FlightController` and `Winch`
through FMPy:

![Force, reel-out speed, power and length over three traction phases](../figures/pumping_series.png)

![Path of the kite in space, coloured by force](../figures/pumping_path.png)

Two cycles in a wind of 8 m/s at 10 m (`--cycles 2`; AMD EPYC, 2 cores, Linux, Python 3.11, 2026-11-22):

| exchange | step | segments | mean power | mean force | peak force |
|---|---|---|---|---|---|
| `--master jacobi` | 20 ms | 10 | 4038 W | 1808 N | 3531 N |
| `--master gauss_seidel` | 20 ms | 10 | 4039 W | 1808 N | 3536 N |
| `--master jacobi --step 0.005` | 5 ms | 10 | 4036 W | 1806 N | 3528 N |
| `--master jacobi --step 0.001` | 1 ms | 10 | 4034 W | 1806 N | 3527 N |
| `--segments 30` | 20 ms | 30 | 4038 W | 1808 N | 3530 N |
| `--segments 1` | 20 ms | 1 | 4167 W | 1818 N | 3694 N |

The load on the kite is delayed, so there is a longest step, which falls as the apparent wind grows
([Coupling](coupling.md#the-ways)). With the Jacobi exchange steps of 30 ms hold at 8 m/s and steps of 35 ms diverge; at
10, 12 and 14 m/s 30 ms diverge and 20 ms hold. The example recognizes divergence and names a shorter step; Gauss-Seidel
held with 60 ms at 8 m/s. It flies in 6 to 14 m/s: in 5 m/s the kite comes down while it is reeled in, and from 11 m/s on
it says for how long the motor of the winch is too weak.

In steps of 20 ms with 10 segments a second of flight took 12 to 17 ms in five runs, with other load on the
machine (60 to 86 times real time, as the example prints it).
Over a cycle the work at both ends, drag, damping and stored energy balance within 1 % of what the drum gains
(`tests/physics/test_pumping_energy.py`). The coefficients are those of the sources below; the flight is plausible, but not a
measured one.

## The winch inside the tether

`python examples/power_system/winch_inside.py` flies the same system twice: with the `Winch` FMU, and with the drum
inside the tether, `winch_control` = force. Then `winch_mass` is the inertia of the drum over the square of its radius,
301 kg, `winch_damping` and `winch_friction` are its friction, and the only thing left outside is the motor, the FMU
`WinchMotor`: from the speed of the drum and the tension at the end of a step it computes the `winch_force` of the next one,
which brings the drum to the pairs of tension and speed that the flight controller wants. Mean power over a cycle in 8 m/s
[W]:

| exchange | winch | 20 ms | 100 ms | 200 ms |
|---|---|---|---|---|
| `pumping_cycle.py`, either master | FMU | 4039 | diverges after 0.5 s | diverges after 0.6 s |
| tether and kite iterate | FMU | 4040 | 4031 | 3593 |
| tether and kite iterate | inside the tether | 4037 | 4023 | 4009 |
| `winch_inside.ssp` in libcosim | inside the tether | 4036 | diverges | diverges |
| its `OspSystemStructure.xml`: tether and kite always 20 ms | inside the tether | 4036 | 4035 | 4037 |

![Reel-out speed over a cycle in three steps: the winch FMU swings in 200 ms](../figures/winch_inside.png)

Two signals are delayed in this system. What makes `pumping_cycle.py` diverge in steps of 100 ms is the load on the kite,
wherever the winch is; so tether and kite repeat each step here until the load on the kite agrees within 1 N
(`agreement.py`), 2 steps of the tether for each of 100 ms. Then the winch is left: the FMU gets the tension after the
step and gives its speed to the next one. That holds for 100 ms; in 200 ms its motor pulls with all it can, to and fro,
as soon as it reels in. Inside the tether nothing swings, because the drum feels the tension at every instant.

The motor makes the drum feel a third of its mass, so it follows the controller within half a second while it reels in;
the FMU follows it at once. Over a cycle of 150 m that makes a difference of up to 1 % (6 to 12 m/s, 20 and 100 ms), over
one of 25 m 3 %. The stops of a drum inside the tether, `shortest_length` and `longest_length`, have the names of
parameters of `FlightController` that mean something else: set those of the tether to 0.

## Turbulent wind

`TurbulentWind` reads a box of turbulence and lets the mean wind carry it past the kite and the tether. A file of any size
opens at once: it is mapped into memory, and a step reads what it needs.

| `file` ends in | written by | what it is |
|---|---|---|
| `.bts` | TurbSim | contains its mean wind, which replaces `mean_speed` and `wind_reference_height` |
| `u.bin`, `u.turb` | Mann generators, HAWC2, hipersim | 32-bit numbers, v and w in files beside it; its grid is set |
| `.npz` | `numpy.savez` (not `savez_compressed`) | `velocity` (along, across, up, 3) [m/s] and `spacing` (3,) [m] |

The grid of a Mann box is not in its files: set `points_along`, `spacing_along` and those across and upwards.

`file` is a String parameter: set it before the initialization, or build the FMU with it
(`build("TurbulentWind", folder, [("file", path)])` of `examples/shared/example_fmus.py`). Without a file the FMU gives the
mean wind with its profile. A file that is missing, cut off or of another kind is refused at the initialization, a number in
it that is no wind when it is read; each in one sentence. A saved state holds the name of the file, not its content; the file
must not change during a run.

Axes: x of the box is downwind, y to the left when looking downwind, z up; `wind_direction` is where the wind blows *to*,
from the x axis. `box_origin` is where the front of the box, the plane that arrives first, has its middle at the start.
Planes are in the order of space in the files of Mann generators and of numpy, so the last one is the front, and in the order
of time in those of TurbSim. Programs differ here: planes in the wrong order turn time back, which the spectra do not show.
PyConTurb 2.7.4 writes the points of a `.bts` plane upwards first, TurbSim and this reader have them across first. The height
of the lowest row is that in a TurbSim file, otherwise 0, plus `box_origin[3]`.

Outside of the box: `outside` = periodic (1) repeats it in all three directions; the seams are smooth only if it was made
periodic (of a TurbSim file, in time: `UsableTime` = "ALL"). The fluctuations are repeated; the mean wind continues as
U(z/h)^`wind_exponent`. refused (2) refuses a step after which a point would be outside, the start included: the grid of
TurbSim begins above the ground, so a tether that reaches down to it needs the first choice. The tower points of TurbSim are
not read.

Wiring: `shape` and `kite_position` from the tether or the kite (without `shape` keep `wind_points` = line (1): 21 points on
the straight line from the origin to the kite). `wind_velocity` is the mean along the tether, for a tether with
`wind_profile` = uniform; `kite_wind` goes to `wind_velocity` of a kite with a uniform profile. The wind at the points
themselves, `wind_at`, goes to a tether that is built with `tetherfmu build --wind-points 21`: these inputs replace
`wind_velocity` and the profile. A tether with a single wind has that of the mean: gusts that are shorter than the tether
cancel on it, in its shape and its waves as well as in its drag, to which the wind near a fast kite contributes more than
the mean says. The turbulence is frozen: it does not change while it passes. numpy takes about 30 µs for
21 points (`tests/benchmarks/wind_points.py`).

`python examples/wind/turbulence.py` flies a parked kite (`TetherDynamicFree`, `PointMassKite`) and a kite on a circle
(`KiteOnPath`, `TetherDynamic`) through FMPy, in a box that it makes (isotropic, 15 % of 8 m/s at 10 m; `--box FILE` takes
one of yours):

![Wind at the kite and along the tether, and tension at the ground, over 120 s](../figures/turbulence.png)

| flight | wind at the kite | along the tether | tension at the ground | peak |
|---|---|---|---|---|
| parked kite | 12.7 ± 0.9 m/s | 11.0 ± 0.3 m/s | 1065 ± 660 N | 2858 N |
| parked kite, mean wind alone | 12.8 ± 0.0 m/s | 11.0 ± 0.0 m/s | 1001 ± 1 N | 1006 N |
| circle | 11.7 ± 1.2 m/s | 10.1 ± 0.6 m/s | 2003 ± 118 N | 2209 N |
| circle, mean wind alone | 11.6 ± 0.6 m/s | 10.0 ± 0.5 m/s | 2005 ± 120 N | 2186 N |

Means and standard deviations from 20 s on. The parked kite feels the gusts, and flies up and down in them; the kite on the
circle has a prescribed path, so only the drag of the tether itself changes. Sampling 22 points takes 30 to 55 µs in numpy,
a step of the FMU with FMPy 0.1 ms (AMD EPYC, 2 cores with other load, Linux, Python 3.11, 2026-11-23).

## A model of your own

Copy a file of `examples/fmus`: a class that declares inputs, outputs and records of parameters, and has two methods,
`first` and `next`, from numbers to numbers. `model_slave.py` does the rest: range checks, refusals, states, the model
description. Add its name to `SLAVES` in `examples/shared/example_fmus.py`, or call `build` there. A kite that need not be an
FMU is ten lines of Python in `examples/first_flight/fly_your_kite.py`.

## Systems as SSP files

`kite_power_system.ssp` is the system above, `winch_inside.ssp` the same with
[the winch inside the tether](#the-winch-inside-the-tether), its motor in the place of the winch;
`circular_flight.ssp` is `KiteOnPath` and `TetherDynamic`: the circle of
`examples/first_flight/circular_flight.py`. The FMUs in them carry their start values, because not every importer sets
enumerations or reads parameter sets. Three system structures of the power system differ in the parameter set of the tether:

| system structure | segments | relative_tolerance |
|---|---|---|
| `SystemStructure_coarse.ssd` | 3 | 1e-3 |
| `SystemStructure.ssd` | 10 | 1e-4 |
| `SystemStructure_fine.ssd` | 30 | 1e-6 |

libcosim (`CosimExecution.from_ssp_file` of libcosimpy, on the extracted file) flies them as the Jacobi master of the
example does, to ten digits; so does Ecos (`EcosSimulation(ssp_path=...)` of ecospy). fmu-manipulation-toolbox makes one
FMU of a system (`fmucontainer -container kite_power_system.ssp:0.02`); its signals are local variables. It starts the kite
without its first steering, which moves the path by centimetres. `simulate_ssp` of FMPy sets all connected inputs to 0 in
the first step. A kite refuses to be at the ground station; `circular_flight.ssp` and `turbulent_circle.ssp`, where only the
tether gets these inputs, run on from a tension of 1e6 and 4e5 N (libcosim: 104 N in the circle). Use one of the others.

Each file also has its system for the Open Simulation Platform, in `extra/com.open-simulation-platform`
(`CosimExecution.from_osp_config_file` of libcosimpy, on that folder of the extracted file). There each FMU may have steps
of its own: in `winch_inside.ssp` controller and motor have 100 ms, tether and kite 20 ms. So the winch may be delayed; the
load on the kite, which must not be, is exchanged often."""


def section(name):
    """Equations, sources and tables of an FMU."""
    module = sys.modules[example_fmus.slave(name).__module__]
    parts = [f"## {name}", f"```text\n{module.__doc__.partition(': ')[2].strip()}\n```"]
    for causality, columns in COLUMNS.items():
        listed = folded([variable for variable in example_fmus.table_of(name) if variable.causality == causality])
        if listed:
            rows = [(f"`{vector}`", *(column(each) for column in columns)) for vector, each in listed]
            parts += [f"{TITLES[causality]}:", table(("name", *(column.__name__ for column in columns)), rows)]
    return "\n\n".join(parts)


def aerodynamics():
    """What both kites share."""
    text = sys.modules[example_fmus.slave("PointMassKite").__module__.replace("point_mass_kite", "aerodynamics")].__doc__
    return f"## Aerodynamics of both kites\n\n```text\n{text.strip()}\n```"


def page():
    """Text of docs/use/example_fmus.md."""
    return "\n\n".join([TEXT.strip(), aerodynamics(), *map(section, example_fmus.SLAVES)]) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
