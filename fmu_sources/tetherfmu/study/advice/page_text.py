"""Words of the page docs/how_much_tether.md, and its tables of the keys of a scene file."""

from dataclasses import fields

from tetherfmu.runtime.parameters import Environment, Tether
from tetherfmu.runtime.quantities import quantities
from tetherfmu.study.scenes.files import OUTPUTS, Scene, Wanted, Wind
from tetherfmu.study.scenes.flights import KINDS
from tetherfmu.study.scenes.units import spellings

from .scene_report import table

OPENING = """\
# How much tether does my scene need?

Written by `python -m tetherfmu.study page`; every number is measured. Describe your scene in a file (below, "Scene files";
eight of them are in `examples/scenes/`), then ask:

```text
pip install "tetherfmu[study]"
python -m tetherfmu.study advise examples/scenes/circle.toml
python -m tetherfmu.study advise examples/scenes/circle.toml --fast
python -m tetherfmu.study tradeoff examples/scenes/circle.toml
```

`advise` says which FMU, how many segments, which tolerance and which communication step to use, why, and what error to
expect. It flies the scene with a finer model, tries the configurations in the order of their least cost, and takes the
cheapest whose error against the finer model, plus the finer model's own error, is allowed. `--fast` forecasts the errors
from dimensionless numbers and the thresholds below. `tradeoff` measures every configuration and writes a CSV file, a figure
and a report (Markdown and HTML) to `study/NAME`; stop it when you like, the same command goes on. `--dask ADDRESS` spreads
it over a cluster (`pip install "tetherfmu[cluster]"`). `python build_fmus.py --scene examples/scenes/circle.toml` builds the
advised FMU: the scene's values as start values, without the inputs that are 0 in it and the outputs that it does not ask
for.
"""

CLOSING = """\

## Errors

Each run is compared with the reference at common times, every 0.1 s. It starts as a quasi-steady shape, and the first three
wave times (at most a quarter of the scene) are left out. F is a force of the run, R of the reference, rms goes over time.

| output | error |
|---|---|
| `kite_force`, `ground_force` | rms(norm F - norm R) / rms norm R |
| `kite_direction`, `ground_direction` | rms(norm R, times the distance of unit vectors) / rms norm R; 1 % is 0.6 degrees |
| `peak_force` | difference of the largest forces on the kite, over all communication points / that of the reference |
| `power` | rms(F v - R v) / rms(R v) at the kite, or of `ground_tension` times `reel_out_speed`, the larger one |
| `shape` | rms distance of 21 points at equal unstretched length / mean unstretched length |

The reference is the dynamic tether, refined until the changes by half of the segments and by the double step with ten times
the tolerance are together below a tenth of the smallest error told: each change is larger than the error that is left. It
is also given what an importer does not know, the mean reel-out speed of each step and the wind of its middle.

Cost is kernel time per simulated second with all outputs in every communication step: counted work (steps, iterations) times
unit costs measured once (`python -m tetherfmu.study costs`), so that the load of the machine does not decide. FMPy: the same
plus what FMPy adds to a step; `tradeoff` measures it in FMPy itself.

## What the numbers say

- The force of a tether that is pulled taut by a prescribed kite depends on its length to millimetres. So the straight line,
  which knows no sag, is good for weight and drag of a few percent of the tension only, and the reel-out speed, which is
  held over a communication step, makes an error of first order in the step: with a winch at 8 m/s a stiff tether wants
  steps of a millisecond.
- The quasi-steady tether is wrong by about 0.2 times wave time times rate of the force. More segments do not help it; few
  can make it better by luck, when their error has the other sign. The advisor takes such luck, as does the table of the
  cheapest.
- About 11 segments are enough for 0.3 %, 6 for 1 %, 4 for 3 %, unless the tether is slack and whirls.
- The tolerance hardly matters at communication steps up to 20 ms: the solver takes one step in each.
"""


def rows_of(record, section, leave_out=()):
    """Rows of a table of keys: every quantity with its units, default and range."""
    rows = []
    defaults = {item.name: item.default for item in fields(record)}
    for name, declared in quantities(record):
        if name not in leave_out:
            units = spellings(declared.unit).replace("no unit", "-")
            default = f"{defaults[name]:.4g}"
            rows.append(
                (f"`{section}.{name}`" if section else f"`{name}`", units, default, declared.range(), declared.meaning)
            )
    return rows


def scene_file_tables():
    """Lines: the keys of a scene file, from the declarations."""
    columns = ("key", "units", "default", "allowed", "meaning")
    common = rows_of(Scene, "") + rows_of(Tether, "tether", ("segments",)) + rows_of(Environment, "environment")
    velocity = ("`wind.velocity`", "m/s, km/h, kn", "[0, 0, 0]", "each from -200 to 200 m/s", "mean wind, x, y, z")
    outputs = ("`wanted.outputs`", "-", '["kite_force"]', "some of " + ", ".join(OUTPUTS), "what the allowed error is for")
    common += [velocity, *rows_of(Wind, "wind"), outputs, *rows_of(Wanted, "wanted")]
    lines = ["## Scene files", "", TEXT, "", *table(columns, common), ""]
    for kind, flight in KINDS.items():
        lines += [f'`flight.kind = "{kind}"`: {flight.__doc__}', "", *table(columns, rows_of(flight, "flight")), ""]
    return [*lines, SERIES]


TEXT = """\
TOML. Numbers are in SI units, or texts with a unit such as `"4 mm"`. `duration`, `flight.kind`, `tether.initial_length` and
`wanted.allowed_error` must be there. What is wrong is told in one line with file, key, value and what is allowed, and the
exit status is 2. With `wanted.communication_step` that step is kept, otherwise it is advised."""

SERIES = """\
`flight.kind = "series"`, `flight.file = "flight.csv"`: any time series of yours, a CSV file with a head line and the columns
`time`, `kite_position[1..3]` and if you have them `kite_velocity[1..3]`, `ground_position[1..3]`, `ground_velocity[1..3]`,
`reel_out_speed`, `wind_velocity[1..3]`. Positions are joined by splines with continuous acceleration, or by cubic Hermite
curves where velocities are given."""
